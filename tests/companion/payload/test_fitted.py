"""Whether an action is possible on the boat's payload, and what is wrong with one that is not."""

import pytest

from companion.config.boat_config import decode_config
from companion.mavlink.dialect import dialect
from companion.payload.actions import (
    ActionFault,
    MoveGripper,
    MoveWinch,
    PayloadAction,
    RepeatRelay,
    RunCommand,
    SetRelay,
    SetServo,
    StartCapture,
    WinchMotion,
)
from companion.payload.fitted import FittedPayload

CONFIG = decode_config(
    {
        "payload": [
            {"kind": "servo", "number": 9, "name": "bait"},
            {"kind": "servo", "number": 11},
            {"kind": "horn", "number": 0, "pin": 17, "max_on_s": 2.0},
            {"kind": "gripper", "number": 2},
            {"kind": "winch", "number": 1, "line_m": 5.0, "speed_m_s": 0.5},
            {"kind": "winch", "number": 2, "out_pin": 22, "in_pin": 27, "speed_m_s": 0.5},
            {"kind": "winch", "number": 3, "line_m": 20.0, "speed_m_s": 0.2},
        ],
        "camera": {"capture": ["/bin/true"]},
    },
    "test",
)
FITTED = FittedPayload(CONFIG.payload, CONFIG.camera)
RATE, LENGTH = WinchMotion.RATE, WinchMotion.LENGTH


@pytest.mark.parametrize(
    "action",
    [
        SetServo(9, 1100),
        SetServo(11, 1900),
        RepeatRelay(0, 3, 4.0),
        MoveGripper(0, closes=True),
        MoveWinch(1, LENGTH, -5.0),
        MoveWinch(1, RATE, 0.0, 0.1),
        MoveWinch(2, RATE, 0.0, -0.503),
        MoveWinch(2, RATE, 0.0, 0.0),
        MoveWinch(2, LENGTH, 10.0, 0.5),
        MoveWinch(0, LENGTH, 5.0),
        MoveWinch(0, RATE, 0.0, 0.0),
        MoveWinch(0, WinchMotion.RETRACT, 99.0, 99.0),
        StartCapture(),
    ],
)
def test_an_action_within_its_limits_is_possible(action: PayloadAction) -> None:
    assert FITTED.fault(action) is None


@pytest.mark.parametrize(
    ("action", "fault"),
    [
        (SetServo(9, 1099), ActionFault(2, "servo 9 (bait): 1099 us, expected 1100 to 1900")),
        (SetServo(11, 1901), ActionFault(2, "servo 11: 1901 us, expected 1100 to 1900")),
        (SetServo(10, 1500), ActionFault(1, "no servo 10, expected 9 (bait) or 11", is_absent=True)),
        (RepeatRelay(0, 3, 4.1), ActionFault(3, "horn 0: period 4.1 s, expected at most 4")),
        (MoveWinch(4, RATE), ActionFault(1, "no winch 4, expected 1, 2 or 3", is_absent=True)),
        (MoveWinch(1, LENGTH, -5.01), ActionFault(3, "winch 1: -5.01 m, expected at most 5")),
        (MoveWinch(1, RATE, 0.0, -0.51), ActionFault(4, "winch 1: -0.51 m/s, expected at most 0.5")),
        (MoveWinch(2, RATE, 0.0, 0.508), ActionFault(4, "winch 2: 0.508 m/s, expected 0 or 0.5")),
        (MoveWinch(2, LENGTH, 5.0, 0.2), ActionFault(4, "winch 2: 0.2 m/s, expected 0 or 0.5")),
        (MoveWinch(0, LENGTH, 10.0), ActionFault(3, "winch 1: 10 m, expected at most 5")),
        (MoveWinch(0, RATE, 0.0, 0.2), ActionFault(4, "winch 2: 0.2 m/s, expected 0 or 0.5")),
        (MoveWinch(0, RATE, 0.0, 0.5), ActionFault(4, "winch 3: 0.5 m/s, expected at most 0.2")),
        (RunCommand(1), ActionFault(0, "this boat has no command", is_absent=True)),
    ],
)
def test_an_impossible_action_says_which_parameter_and_what_was_expected(
    action: PayloadAction, fault: ActionFault
) -> None:
    assert FITTED.fault(action) == fault


def test_a_relay_of_a_command_stands_for_the_command() -> None:
    settings = decode_config(
        {"payload": [{"kind": "command", "number": 7, "run": ["/bin/true"], "relay": 4}]}, "test"
    ).payload
    fitted = FittedPayload(settings)
    assert fitted.lacks("relay") is None
    assert fitted.lacks("servo") is not None
    assert fitted.resolve(SetRelay(4, True)) == RunCommand(7)
    assert fitted.resolve(SetRelay(4, False)) == ActionFault(
        2, "command 7: relay 4 off, expected on, which starts it"
    )
    assert fitted.resolve(SetRelay(5, True)) == ActionFault(
        1, "no relay 5, expected that of a command", is_absent=True
    )
    assert fitted.resolve(RunCommand(7)) == RunCommand(7)


def test_the_motions_of_a_winch_have_mavlinks_numbers_and_what_is_not_said_is_nothing() -> None:
    by_name = {one.name: number for number, one in dialect.enums["WINCH_ACTIONS"].items()}
    assert {one.name: one.value for one in WinchMotion} == {
        "RELAX": by_name["WINCH_RELAXED"],
        "LENGTH": by_name["WINCH_RELATIVE_LENGTH_CONTROL"],
        "RATE": by_name["WINCH_RATE_CONTROL"],
        "LOCK": by_name["WINCH_LOCK"],
        "HOLD": by_name["WINCH_HOLD"],
        "RETRACT": by_name["WINCH_RETRACT"],
    }
    assert MoveWinch(1, RATE) == MoveWinch(1, RATE, length_m=0.0, rate_m_s=0.0)
    assert StartCapture() == StartCapture(count=1, interval_s=0.0)
    assert not ActionFault(1, "").is_absent
    assert not FittedPayload().is_skipped
    assert (FITTED.has_capture, FittedPayload().has_capture) == (True, False)
    assert FITTED.lacks("camera") is None
    assert FittedPayload().lacks("camera") == ActionFault(
        0, "this boat has no camera with a capture command", is_absent=True
    )
