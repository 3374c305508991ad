"""What speed controllers report on a whole boat: told, sent and logged as ArduPilot's."""

import dataclasses
import math
from collections.abc import Sequence
from pathlib import Path

import pytest
from boat_rig import Rig, waypoint
from log_rig import LogRig, of_kind, read_log

from companion.autopilot.esc_monitor import EscMonitor
from companion.boat import Boat
from companion.config.actuators import MotorsPart
from companion.core.readings import EscReading
from companion.core.state import STOPPED, MotorCommand

PART = MotorsPart(driver="esc", telemetry="kiss")


def reading(time_s: float, side: int, rpm: float = 2042.0, celsius: float = 31.0) -> EscReading:
    return EscReading(time_s, side, 70000, rpm * math.tau / 60.0, 15.42, 8.73, celsius, 210.0, 33.5)


class FakeLine:
    """A line with the controllers of some sides."""

    def __init__(self, *sides: int) -> None:
        self.latest = {side: reading(0.0, side) for side in sides}

    def read(self) -> tuple[EscReading, ...]:
        return tuple(self.latest.values())

    def close(self) -> None:
        """Nothing to let go."""


def told(
    monitor: EscMonitor, now_s: float, command: MotorCommand = STOPPED, part: MotorsPart = PART
) -> Sequence[str]:
    return [one.text for one in monitor.update(part, command, now_s, 2)]


def test_a_silent_side_is_told_once_and_the_other_is_read() -> None:
    left, right = FakeLine(0), FakeLine(1)
    monitor, texts = EscMonitor([left, right]), list[str]()
    for tenth in range(60):
        now_s = 0.1 * tenth
        left.latest[0] = reading(now_s, 0)
        if tenth < 10 or tenth > 50:
            right.latest[1] = reading(now_s, 1)
        texts += told(monitor, now_s)
        if tenth == 40:
            assert monitor.readings == (left.latest[0], None)
    assert texts == ["Right ESC is silent", "Right ESC measures again"]


def test_heat_and_faults_are_told_once() -> None:
    line, texts = FakeLine(0, 1), list[str]()
    monitor = EscMonitor([line])
    for tenth, celsius in enumerate([80.0, 86.0, 84.0, 86.0, 81.0, 79.0, 79.0]):
        fault = "overcurrent" if 2 <= tenth < 4 else ""
        for side in (0, 1):
            of_side = reading(0.1 * tenth, side, celsius=celsius if side else 30.0)
            line.latest[side] = dataclasses_replace(of_side, fault=fault if not side else "")
        texts += told(monitor, 0.1 * tenth)
    assert texts == [
        "Right ESC is hot: 86 C", "Left ESC reports overcurrent", "Left ESC works again",
        "Right ESC is cool again",
    ]  # fmt: skip


def dataclasses_replace(one: EscReading, fault: str) -> EscReading:
    return EscReading(
        one.time_s, one.side, one.count, one.shaft_rad_s, one.voltage_v, one.current_a, one.temperature_c,
        one.consumed_mah, one.motor_c, fault,
    )  # fmt: skip


def test_no_limit_is_no_alarm() -> None:
    line = FakeLine(0, 1)
    line.latest = {side: reading(0.0, side, celsius=120.0) for side in (0, 1)}
    monitor = EscMonitor([line])
    cold = MotorsPart(driver="esc", telemetry="kiss", hot_c=0.0)
    assert [text for _ in range(3) for text in told(monitor, 0.0, part=cold)] == []


@pytest.mark.parametrize(
    ("command", "rpms", "are_swapped"),
    [
        (MotorCommand(0.5, 0.0), (0.0, 900.0), True),
        (MotorCommand(0.0, 0.5), (900.0, 0.0), True),
        (MotorCommand(0.5, 0.0), (900.0, 0.0), False),
        (MotorCommand(0.5, 0.5), (0.0, 900.0), False),
        (MotorCommand(0.5, 0.0), (900.0, 400.0), False),
        (STOPPED, (0.0, 900.0), False),
    ],
)
def test_swapped_ports_are_noticed_while_one_motor_is_driven(
    command: MotorCommand, rpms: tuple[float, float], are_swapped: bool
) -> None:
    line, texts = FakeLine(0, 1), list[str]()
    monitor = EscMonitor([line])
    for tenth in range(20):
        line.latest = {side: reading(0.1 * tenth, side, rpms[side]) for side in (0, 1)}
        texts += told(monitor, 0.1 * tenth, command)
        assert tenth >= 9 or not texts
    assert texts == ["ESC telemetry: left and right are swapped"] * are_swapped


class TellingLine(FakeLine):
    """Measures ten times a second, by the boat's reads."""

    def read(self) -> tuple[EscReading, ...]:
        time_s = max((one.time_s for one in self.latest.values()), default=0.0) + 0.1
        self.latest = {side: reading(time_s, side) for side in self.latest}
        return super().read()


def test_esc_telemetry_has_ardupilots_units() -> None:
    rig = Rig(escs=(TellingLine(0),))
    rig.run(9.0)
    message = rig.peer.said("ESC_TELEMETRY_1_TO_4")[-1]
    assert (message.temperature, message.count) == ([31, 0, 0, 0], [70000 & 0xFFFF, 0, 0, 0])
    assert (message.voltage, message.current) == ([1542, 0, 0, 0], [873, 0, 0, 0])
    assert (message.totalcurrent, message.rpm) == ([210, 0, 0, 0], [2042, 0, 0, 0])


def test_a_boat_without_telemetry_sends_none() -> None:
    rig = Rig()
    rig.run(9.0)
    assert not rig.peer.said("ESC_TELEMETRY_1_TO_4")


class LoggedRig(LogRig):
    """A boat with two controllers that writes logs."""

    def _build(self) -> Boat:
        self.hardware = dataclasses.replace(self.hardware, escs=(TellingLine(0), TellingLine(1)))
        return super()._build()


def test_the_log_has_ardupilots_record(tmp_path: Path) -> None:
    rig = LoggedRig(tmp_path)
    rig.sail(waypoint(600.0, 0.0))
    rig.run(3.0)
    rig.disarm()
    (log,) = tmp_path.glob("*.bin")
    records = of_kind(read_log(log), "ESC")
    assert {record.Instance for record in records} == {0, 1}
    assert len(records) > 20
    one = records[0]
    assert (one.RPM, one.RawRPM) == (pytest.approx(2042.0), pytest.approx(2042.0))
    assert (one.Volt, one.Curr, one.CTot) == (pytest.approx(15.42), pytest.approx(8.73), 210.0)
    assert (one.Temp, one.MotTemp, one.Err) == (31.0, 33.5, 0.0)
