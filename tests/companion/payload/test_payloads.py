"""The units of the payload, tick by tick, over outputs that record their changes."""

import math

import pytest
from twins.lines import known

from companion.config.boat_config import decode_config
from companion.core.status_text import Severity
from companion.payload.actions import (
    MoveGripper,
    MoveWinch,
    RepeatRelay,
    RepeatServo,
    RunCommand,
    SetLights,
    SetRelay,
    SetServo,
    UnitAction,
    WinchMotion,
)
from companion.payload.payloads import Payloads, Written
from sitl.world.payload import RUN_S, SimPayload

TICK_S = 0.02
SIGNAL = {"min_us": 1000, "trim_us": 1450, "max_us": 2000}
TABLES: list[dict[str, object]] = [
    {"kind": "relay", "number": 0, "pin": 17, "start": "on", "on_disarm": "off"},
    {"kind": "relay", "number": 3, "pin": 27, "on_link_loss": "on"},
    {"kind": "light", "number": 4, "pin": 22},
    {"kind": "light", "number": 5, "pin": 23},
    {"kind": "horn", "number": 6, "pin": 24, "max_on_s": 1.0},
    {"kind": "servo", "number": 9, "signal": SIGNAL, "start": 1500, "on_disarm": "off", "on_link_loss": 1100},
    {"kind": "servo", "number": 10, "signal": SIGNAL},
    {"kind": "gripper", "number": 1, "open_us": 1800, "closed_us": 1200, "start": "closed"},
    {"kind": "gripper", "number": 2, "pin": 25, "on_link_loss": "closed"},
    {"kind": "winch", "number": 1, "line_m": 5.0, "speed_m_s": 0.5},
    {"kind": "winch", "number": 2, "line_m": 5.0, "speed_m_s": 0.5, "count_pin": 5, "pulse_m": 0.1},
    {"kind": "command", "number": 7, "run": ["/bin/true"]},
]
PUMP, THREE, LIGHT, STERN, HORN, BAIT, TEN, CLAW, MAGNET, WINCH, SECOND, SAMPLE = range(12)


class Rig:
    def __init__(self) -> None:
        config = decode_config({"payload": TABLES}, "test")
        self.sim = SimPayload(config)
        self.units = Payloads(config.payload, self.sim.parts)
        self.now_s = 100.0
        self.is_armed = self.is_lost = False
        self.texts: list[str] = []
        self.severities: list[int] = []
        self.written: list[Written] = []

    def run(self, seconds: float = TICK_S) -> None:
        for _ in range(round(seconds / TICK_S)):
            self.now_s += TICK_S
            self.sim.step(self.now_s)
            self.units.tick(self.now_s, is_armed=self.is_armed, is_operator_lost=self.is_lost)
            for severity, text in self.units.take_status_texts():
                self.texts.append(text)
                self.severities.append(severity)
            self.written += self.units.take_written()

    def do(self, action: UnitAction) -> str:
        return self.units.perform(action, self.now_s)

    def values(self, index: int) -> list[float]:
        return [one.value for one in self.sim.outputs[index].history]


@pytest.fixture
def rig() -> Rig:
    """After its first tick, with what that has written forgotten."""
    rig = Rig()
    rig.run()
    for output in rig.sim.outputs.values():
        output.history.clear()
    rig.written.clear()
    return rig


@pytest.mark.parametrize(
    ("action", "changes", "text"),
    [
        (SetServo(10, 1700), {TEN: [1700.0]}, "Servo 10: 1700 us"),
        (SetRelay(3, True), {THREE: [1.0]}, "Relay 3: on"),
        (SetRelay(0, False), {PUMP: [0.0]}, "Relay 0: off"),
        (MoveGripper(1, closes=False), {CLAW: [1800.0]}, "Gripper 1: open"),
        (MoveGripper(2, closes=True), {MAGNET: [1.0]}, "Gripper 2: closed"),
        (MoveGripper(2, closes=False), {MAGNET: [0.0]}, "Gripper 2: open"),
        (MoveGripper(0, closes=False), {CLAW: [1800.0], MAGNET: [0.0]}, "Gripper 2: open"),
        (SetLights(True), {LIGHT: [1.0], STERN: [1.0]}, "Light 4: on"),
        (MoveWinch(2, WinchMotion.RATE, 0.0, -0.25), {SECOND: [-0.5]}, "Winch 2: -0.25 m/s"),
        (MoveWinch(0, WinchMotion.LENGTH, -1.5), {WINCH: [-1.0], SECOND: [-1.0]}, "Winch 1: in 1.5 m"),
        (MoveWinch(1, WinchMotion.LENGTH, 2.0), {WINCH: [1.0]}, "Winch 1: out 2 m"),
        (MoveWinch(1, WinchMotion.RETRACT), {WINCH: [-1.0]}, "Winch 1: retract"),
    ],
)
def test_an_action_moves_what_it_addresses_and_nothing_else(
    rig: Rig, action: UnitAction, changes: dict[int, list[float]], text: str
) -> None:
    assert rig.do(action) == ""
    assert {index: values for index in rig.sim.outputs if (values := rig.values(index))} == changes
    rig.run()
    assert text in rig.texts
    assert set(rig.severities) == {Severity.INFO}
    assert {one.value for one in rig.written} == {value for values in changes.values() for value in values}


def test_a_servo_is_repeated_between_a_width_and_its_trim(rig: Rig) -> None:
    rig.do(RepeatServo(10, 1900, 2, 1.0))
    rig.run(5.0)
    assert rig.values(TEN) == [1900.0, 1450.0, 1900.0, 1450.0]
    assert rig.texts == ["Servo 10: 1900 us, 2 times, every 1 s"]


def test_disarming_and_losing_the_operator_enter_their_states_once(rig: Rig) -> None:
    rig.do(SetServo(10, 1700))
    rig.do(MoveWinch(0, WinchMotion.LENGTH, 5.0))
    rig.run()
    assert rig.values(PUMP) == []  # not armed yet is not disarming
    rig.is_armed = True
    rig.run()
    rig.is_armed = False
    rig.run()
    assert (rig.values(PUMP), rig.values(BAIT), rig.values(TEN)) == ([0.0], [0.0], [1700.0])
    assert (rig.values(WINCH), rig.values(SECOND)) == ([1.0, 0.0], [1.0, 0.0])
    rig.do(SetRelay(0, True))
    rig.run(0.1)
    assert rig.values(PUMP) == [0.0, 1.0]
    rig.do(MoveWinch(1, WinchMotion.LENGTH, 5.0))
    rig.is_lost = True
    rig.run()
    assert (rig.values(THREE), rig.values(BAIT), rig.values(MAGNET)) == ([1.0], [0.0, 1100.0], [1.0])
    assert rig.values(WINCH) == [1.0, 0.0, 1.0, 0.0]
    rig.do(SetRelay(3, False))
    rig.run(0.1)
    assert rig.values(THREE) == [1.0, 0.0]


def test_a_horn_that_has_been_cut_off_does_not_go_on_with_its_repetitions(rig: Rig) -> None:
    rig.do(RepeatRelay(6, 3, 4.0))
    rig.run(10.0)
    assert rig.values(HORN) == [1.0, 0.0]


def test_a_command_runs_one_at_a_time_and_reports(rig: Rig) -> None:
    program = rig.sim.programs[SAMPLE]
    program.outcome = "exit code 1"
    assert rig.do(RunCommand(7)) == ""
    assert rig.do(RunCommand(7)) == "command 7: still running"
    rig.run(RUN_S + TICK_S)
    program.outcome = ""
    assert rig.do(RunCommand(7)) == ""
    rig.run(RUN_S + TICK_S)
    assert rig.texts == [
        "Command 7: started",
        "Command 7: exit code 1",
        "Command 7: started",
        "Command 7: done",
    ]
    assert rig.severities == [Severity.INFO, Severity.WARNING, Severity.INFO, Severity.INFO]
    assert len(program.starts) == 2


def test_a_fault_is_told_once_and_so_is_its_end(rig: Rig) -> None:
    rig.sim.outputs[TEN].fault = "no answer"
    rig.do(SetServo(10, 1700))
    rig.run(3.0)
    rig.sim.outputs[TEN].fault = "still no answer"
    rig.run(3.0)
    rig.sim.outputs[TEN].fault = ""
    rig.run(1.1)
    assert rig.texts == ["Servo 10: 1700 us", "Servo 10: no answer", "Servo 10: answers again"]
    assert rig.severities == [Severity.INFO, Severity.ERROR, Severity.NOTICE]
    assert rig.values(TEN) == [1700.0]


def test_telemetry_knows_widths_relays_and_the_first_winch(rig: Rig) -> None:
    rig.do(SetRelay(5, True))
    assert dict(rig.units.servo_us()) == {9: 1500, 10: 0}
    assert rig.units.relays() == (0b100001, 0b1111001)
    winch = known(rig.units.winch)
    assert winch.setting.number == 1
    assert math.isnan(winch.out_m)
    assert dict(Rig().units.servo_us()) == {9: 0, 10: 0}, "no pulses before the first tick"
    assert Payloads().winch is None
    assert Payloads().relays() == (0, 0)


def test_a_winch_that_stalls_is_told_once(rig: Rig) -> None:
    rig.do(MoveWinch(1, WinchMotion.RATE, 0.0, -0.25))
    rig.do(MoveWinch(2, WinchMotion.LENGTH, 4.0))
    rig.run(1.0)
    assert known(rig.units.winch).speed_m_s == -0.25
    rig.sim.counters[SECOND].is_stuck = True
    rig.run(5.0)
    (told,) = [text for text in rig.texts if "no pulse" in text]
    assert told.startswith("Winch 2: no pulse for ")
    assert rig.severities[rig.texts.index(told)] == Severity.WARNING
