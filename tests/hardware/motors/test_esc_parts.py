"""Speed controllers that report join the boat through its composition, each side for itself."""

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from twins.escs import VescTwin, kiss_frame
from twins.lines import HandClock, PtyLine, eventually
from twins.pulses import PI_4, plug_in_pwm

from companion.app.composition import check_config
from companion.app.hardware import open_hardware
from companion.app.needs import check_needs
from companion.config.boat_config import BoatConfig, decode_config
from companion.core.errors import ConfigError
from companion.core.readings import EscReading
from companion.hal.interfaces import Hardware
from companion.links.retried import Pace

QUICK = Pace(0.02, 0.02, 0.5)
PI = "Raspberry Pi 4 Model B Rev 1.4"


def config_of(**motors: object) -> BoatConfig:
    tree = {
        "links": ["udpin:127.0.0.1:0"],
        "external": {"position": 2, "heading": 2},
        "parts": {"motors": motors, "battery": {"driver": "esc"}},
    }
    return decode_config(tree, "test")


@pytest.fixture
def opened() -> Iterator[Callable[[BoatConfig], Hardware]]:
    every: list[Hardware] = []

    def open_all(config: BoatConfig) -> Hardware:
        every.append(open_hardware(config, HandClock(), QUICK))
        return every[-1]

    yield open_all
    for hardware in every:
        hardware.close()


def sides(hardware: Hardware) -> set[int]:
    return {one.side for line in hardware.escs for one in line.read() or ()}


def test_a_side_that_is_missing_joins_later(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, opened: Callable[[BoatConfig], Hardware]
) -> None:
    plug_in_pwm(monkeypatch, tmp_path, PI_4)
    left, right = PtyLine(tmp_path / "left"), PtyLine(tmp_path / "right")
    right.unplug()
    hardware = opened(
        config_of(driver="esc", telemetry="kiss", left_port=left.device, right_port=right.device)
    )
    assert hardware.battery is not None
    frame = kiss_frame(30, 1500, 400, 0, 100)

    def has(wanted: set[int]) -> bool:
        left.say(frame)
        if 1 in wanted:
            right.say(frame)
        return sides(hardware) == wanted

    eventually(lambda: has({0}))
    assert hardware.battery.read() is None
    right.plug_in()
    eventually(lambda: has({0, 1}))
    battery = hardware.battery.read()
    assert battery is not None
    assert battery.current_a == pytest.approx(8.0)


def test_vescs_are_driven_and_read_over_one_port(
    tmp_path: Path, opened: Callable[[BoatConfig], Hardware]
) -> None:
    line, clock = PtyLine(tmp_path / "vesc"), HandClock()
    hardware = opened(config_of(driver="vesc", left_port=line.device, can_id=11))
    right = VescTwin(clock, 11)
    left = VescTwin(clock, 10, right)

    def answers(is_so: Callable[[], bool]) -> bool:
        if question := left.hear(line.heard()):
            line.say(question)
        return is_so()

    eventually(lambda: answers(lambda: sides(hardware) == {0, 1}))
    hardware.motors.write(0.4, -0.4)
    eventually(lambda: answers(lambda: (left.duty, right.duty) == (0.4, -0.4)))
    readings: list[EscReading] = [one for esc in hardware.escs for one in esc.read() or ()]
    assert readings[0].voltage_v == pytest.approx(15.2)
    hardware.close()
    left.hear(line.heard())
    assert (left.duty, right.duty) == (0.0, 0.0)


@pytest.mark.parametrize(
    ("motors", "message"),
    [
        ({"driver": "l298n", "telemetry": "kiss"}, "telemetry = 'kiss': expected 'none' with 'l298n'"),
        ({"driver": "esc", "telemetry": "kiss", "pole_pairs": 0}, "pole_pairs"),
    ],
)
def test_what_cannot_be_is_refused(motors: dict[str, object], message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        config_of(**motors)


def test_a_battery_by_controllers_needs_their_telemetry() -> None:
    with pytest.raises(ConfigError, match=r"battery.driver = 'esc': expected parts.motors.telemetry"):
        check_config(config_of(driver="esc"), PI)
    check_config(config_of(driver="esc", telemetry="kiss"), PI)
    check_config(config_of(driver="vesc"), PI)


@pytest.mark.parametrize(
    ("motors", "message"),
    [
        ({"driver": "esc", "telemetry": "kiss", "left_port": "/dev/ttyAMA5"}, "GPIO 12 belongs to"),
        (
            {"driver": "vesc", "right_port": "/dev/ttyAMA3"},
            "motors.right_port: /dev/ttyAMA3 belongs to",
        ),
    ],
)
def test_their_ports_are_claimed(motors: dict[str, object], message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        check_needs(config_of(**motors), PI)


def test_a_right_vesc_on_can_needs_no_port() -> None:
    check_needs(config_of(driver="vesc", right_port="/dev/ttyAMA3", can_id=11), PI)
