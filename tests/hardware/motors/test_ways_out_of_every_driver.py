"""Every driver of motors in the whole boat: off within a tick at every way out, and never a forbidden pin.

`tests/e2e/test_ways_out.py` and `test_esc_program.py` have signals and kills, of the real program.
"""

from collections.abc import Iterator
from pathlib import Path

import pytest
from driven_boat import DRIVERS, TIMEOUT_S, DrivenBoat

from companion.boat import TICK_S

WITHIN_S = 0.02


@pytest.fixture(params=DRIVERS)
def boat(
    request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> Iterator[DrivenBoat]:
    boat = DrivenBoat(request.param, monkeypatch, tmp_path)
    boat.drive()
    yield boat
    boat.watched.close()
    boat.twin.step()
    assert not boat.twin.is_driving
    boat.twin.check()


def off_after_s(boat: DrivenBoat, limit_s: float, *, hangs: bool = False) -> float:
    """How long the motors still get current; fails if they start again."""
    began_s = boat.now()
    while boat.twin.is_driving:
        boat.step(hangs=hangs)
        assert boat.now() - began_s <= limit_s + 1e-9
    took_s = boat.now() - began_s
    for _ in range(round(0.6 / TICK_S)):
        boat.step(hangs=hangs)
        assert not boat.twin.is_driving, "they have started again"
    return took_s


def test_a_disarmed_boat_is_off_within_a_tick(boat: DrivenBoat) -> None:
    boat.rig.ask(400, 0.0)
    off_after_s(boat, WITHIN_S)


def test_a_fault_in_the_tick_is_off_within_it(boat: DrivenBoat, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail() -> None:
        raise ZeroDivisionError

    monkeypatch.setattr(boat.rig.boat.vehicle, "decide", fail)
    off_after_s(boat, WITHIN_S)


def test_a_loop_that_hangs_is_off_after_the_timeout_and_a_look(boat: DrivenBoat) -> None:
    took_s = off_after_s(boat, 1.25 * TIMEOUT_S + TICK_S, hangs=True)
    assert took_s > 0.5 * TIMEOUT_S
    assert boat.watched.trips == 1


def test_full_ahead_to_full_astern_again_and_again_is_safe(boat: DrivenBoat) -> None:
    """The record is checked at the end of each test."""
    for forward in (1000, -1000, 1000, -700):
        boat.push(forward)
