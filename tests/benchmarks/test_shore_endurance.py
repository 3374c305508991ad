"""The server of the shore page stays as it is: an hour of handed-in time, and the date jumps."""

import pytest

from benchmarks.shore_endurance import EnduringClock, Figures, container_sizes, endure
from companion.shore.web.throttle import Throttle

MOST = {  # of the containers that may be long, as their modules bound them
    "Ledger._entries": 1000,
    "Track.points": 2000,
    "Throttle._addresses": 1000,
    "Throttle._known": 1000,
}
MOST_OF_OTHERS = 64  # items of a mission, texts, streams, sockets


@pytest.fixture(scope="module")
def marks() -> list[Figures]:
    return list(endure(1.0, 0.5))


def test_every_container_of_the_server_stays_short(marks: list[Figures]) -> None:
    for mark in marks:
        long = {name: size for name, size in mark.sizes.items() if size > MOST.get(name, MOST_OF_OTHERS)}
        assert long == {}


def test_the_hour_had_what_a_day_at_the_water_has(marks: list[Figures]) -> None:
    """Or the test above would prove nothing."""
    sizes = marks[-1].sizes
    assert sizes["Track.points"] > 500
    assert sizes["Ledger._entries"] > 50
    assert sizes["Texts.lines"] == 30
    assert sizes["Sessions._open"] >= 2
    assert sizes["Hub.watches"] == 3
    assert sizes["Boats._boats"] >= 3


def test_memory_stays_flat_after_the_first_half_hour(marks: list[Figures]) -> None:
    assert marks[2].resident_mb - marks[1].resident_mb < 3.0


def test_a_container_is_found_wherever_it_is() -> None:
    throttle = Throttle()
    for number in range(7):
        throttle.begin(f"10.0.0.{number}", 0.0)
    assert container_sizes({"a": [throttle]})["Throttle._addresses"] == 7


def test_the_date_jumps_and_the_other_clock_does_not() -> None:
    clock = EnduringClock()
    clock.jumped_s = -1e9
    assert clock.now_s() == 0.0
    assert clock.unix_s() == 0.8e9
