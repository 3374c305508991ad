"""The composition root over fake parts: whatever happens, the motors are off at the end."""

import socket
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from boat_rig import Rig

from companion.app.composition import check_config, run_boat
from companion.app.status_file import BoatStatus, read_status
from companion.boat import Boat
from companion.config.boat_config import BoatConfig, decode_config, with_value
from companion.core.errors import ConfigError, LinkError, StorageError
from companion.hal.interfaces import Hardware

PARTS = {"motors": {"driver": "l298n"}, "gnss": {"driver": "nmea"}, "compass": {"driver": "nmea"}}


def config(*links: str, **sections: object) -> BoatConfig:
    tree: dict[str, object] = {"links": list(links), "parts": PARTS, **sections}
    return decode_config(tree, "test")


class Parts:
    """Simulated hardware whose motors remember what was done to them."""

    def __init__(self) -> None:
        self.hardware: Hardware | None = None
        self.events: list[str] = []

    def open(self, config: BoatConfig, now: Callable[[], float]) -> Hardware:
        parts = Rig().hardware
        self.hardware = Hardware(self, parts.gnss, parts.compass)
        return self.hardware

    def write(self, left: float, right: float) -> None:
        self.events.append("write")

    def stop(self) -> None:
        self.events.append("stop")

    def close(self) -> None:
        self.events.append("close")


def after(ticks: int) -> Callable[[], bool]:
    """A stop question that says yes after so many times of asking."""
    asked = iter(range(ticks))
    return lambda: next(asked, None) is None


def changed(links: tuple[str, ...], **values: object) -> BoatConfig:
    """A boat that could sail, with other values by key (dots as __)."""
    tree = config(*links)
    for name, value in values.items():
        tree = with_value(tree, name.replace("__", "."), value)
    return tree


UDP = ("udpin::14550",)


@pytest.mark.parametrize(
    ("tree", "words"),
    [
        (changed(()), "links: .*at least one"),
        (changed(("carrier pigeon",)), "carrier pigeon"),
        (changed(("udpin::99999",)), "99999"),
        (changed(UDP, parts__motors__driver="none"), r"parts\.motors\.driver"),
        (changed(UDP, parts__gnss__driver="none"), r"parts\.gnss\.driver"),
        (changed(UDP, parts__compass__driver="none"), r"parts\.compass\.driver"),
        (
            changed(UDP, parts__gnss__driver="gpsd", parts__compass__driver="gnss"),
            r"parts\.compass\.driver: 'gnss' needs",
        ),
        (changed(UDP, rc__arm_channel=3), r"rc\.arm_channel = 3: .*throttle"),
        (
            changed(("serial:/dev/serial0:57600",)),
            r"links\[0\]: /dev/serial0 belongs to parts.gnss.port",
        ),
        (
            changed(
                UDP,
                parts__battery__driver="ina226",
                parts__compass__driver="bno055",
                parts__battery__address=0x28,
            ),
            r"parts.battery.address: 0x28 on I²C belongs to parts.compass.address",
        ),
    ],
)
def test_a_configuration_that_cannot_sail_is_refused_by_its_key(tree: BoatConfig, words: str) -> None:
    with pytest.raises(ConfigError, match=words):
        check_config(tree)
    parts = Parts()
    with pytest.raises(ConfigError, match=words):
        run_boat(tree, lambda: False, open_parts=parts.open)
    assert parts.hardware is None  # no hardware is touched for a configuration that is wrong


def test_a_boat_that_is_told_where_it_is_needs_neither_receiver_nor_compass() -> None:
    told = changed(UDP, parts__gnss__driver="none", parts__compass__driver="none", external__position=2)
    check_config(with_value(told, "external.heading", 2))
    with pytest.raises(ConfigError, match=r"parts\.compass\.driver"):
        check_config(told)


def test_the_motors_are_let_go_when_a_tick_raises(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(boat: Boat, now_s: float) -> None:
        raise ZeroDivisionError

    monkeypatch.setattr(Boat, "step", fail)
    parts = Parts()
    with pytest.raises(ZeroDivisionError):
        run_boat(config("udpin:127.0.0.1:0"), lambda: False, open_parts=parts.open)
    assert parts.events[0] == "close"


@pytest.fixture
def taken_url() -> Iterator[str]:
    """A port that another program has."""
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        yield f"tcpin:127.0.0.1:{taken.getsockname()[1]}"


def test_a_person_is_told_that_no_link_can_be_opened(taken_url: str) -> None:
    parts = Parts()
    with pytest.raises(LinkError, match=taken_url) as caught:
        run_boat(config(taken_url), lambda: False, open_parts=parts.open)
    assert caught.value.exit_code == 3
    assert parts.events == ["close"]


def test_a_service_waits_for_its_links(
    taken_url: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("NOTIFY_SOCKET", str(tmp_path / "manager"))
    parts = Parts()
    run_boat(config(taken_url), after(3), open_parts=parts.open)
    assert "write" in parts.events


def test_a_link_that_cannot_be_opened_keeps_no_other_from_working(taken_url: str, tmp_path: Path) -> None:
    path = tmp_path / "status.json"
    found: list[BoatStatus] = []

    def should_stop() -> bool:
        if path.exists():
            found.append(read_status(path))
        return bool(found)

    tree = config("udpin:127.0.0.1:0", taken_url, storage={"status_file": str(path)})
    run_boat(tree, should_stop, open_parts=Parts().open)
    why = f"cannot listen on {taken_url.removeprefix('tcpin:')}: Address already in use"
    assert found[0].missing == {taken_url: why}


def test_a_second_program_of_a_boat_is_refused_before_it_touches_a_pin(tmp_path: Path) -> None:
    tree = config("udpin:127.0.0.1:0", storage={"folder": str(tmp_path / "state")})
    second = Parts()

    def start_again() -> bool:
        with pytest.raises(StorageError, match="another program runs this boat"):
            run_boat(tree, after(3), open_parts=second.open)
        return True

    run_boat(tree, start_again, open_parts=Parts().open)
    assert second.hardware is None
    run_boat(tree, after(3), open_parts=second.open)


def test_a_card_that_cannot_be_written_keeps_no_boat_from_starting(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    for folder in ("logs", "files"):
        (tmp_path / folder).write_bytes(b"")  # stands for a card that has become read-only
    parts = Parts()
    run_boat(config("udpin:127.0.0.1:0", storage={"folder": str(tmp_path)}), after(3), open_parts=parts.open)
    assert "write" in parts.events
    assert f"No log: {tmp_path}/logs: cannot be used for logs" in caplog.text
