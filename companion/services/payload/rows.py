"""Payload commands as a table: MAV_CMD to action, the same for mission items and for commands by hand.

Parameters have ArduPilot's meaning. DO_SEND_SCRIPT_MESSAGE starts a command of the owner's: it is ArduPilot's
item for a message to a script on board, with a number of the script's choice, and the vehicle sails on.
"""

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

from companion.mavlink.dialect import dialect
from companion.payload import actions
from companion.payload.actions import ActionFault, PayloadAction, WinchMotion
from companion.payload.fitted import CAMERA, FittedPayload

LEAST_PERIOD_S = 0.1  # half of it is two and a half pulses of a servo, which come every 20 ms
MOST_REPEATS = 10_000
_SLACK_S = 1e-6  # of a period that came in single precision
_LONGEST_S = 86_400.0
_FARTHEST_M = 100_000.0
_MOST = 0xFFFF  # of a number, of which the boat has the lesser part
_RELEASE, _GRAB = 0, 1  # GRIPPER_ACTIONS
_E7 = 10_000_000  # an item in a global frame has its fifth parameter scaled

Parameters = Sequence[float]
"""The seven of a command."""

Read = Callable[[Parameters], PayloadAction | ActionFault]


class PayloadRow(NamedTuple):
    """payload: the kind that the command is for."""

    payload: str
    read: Read


def read_action(command: int, parameters: Parameters, fitted: FittedPayload) -> PayloadAction | ActionFault:
    """The action of a command in the table, or why it is impossible on this boat."""
    row = ROWS[command]
    if lack := fitted.lacks(row.payload):
        return lack
    action = row.read(parameters)
    return action if isinstance(action, ActionFault) else fitted.resolve(action)


def _wrong(parameter: int, value: float, expected: str) -> ActionFault:
    return ActionFault(parameter, f"parameter {parameter} is {value:g}, expected {expected}")


def _whole(value: float, low: int = 0, high: int = _MOST) -> int | None:
    """An integer in a range; None for anything else."""
    return int(value) if low <= value <= high and value == int(value) else None


def _set_servo(p: Parameters) -> PayloadAction | ActionFault:
    channel, width_us = _whole(p[0]), _whole(p[1])
    if channel is None:
        return _wrong(1, p[0], "a servo channel")
    return _wrong(2, p[1], "a pulse width in us") if width_us is None else actions.SetServo(channel, width_us)


def _repetition(count: float, period_s: float, first: int) -> ActionFault | None:
    """Check number and period of a repetition. first: the parameter of the number."""
    if _whole(count, 1, MOST_REPEATS) is None:
        return _wrong(first, count, f"a number of times, 1 to {MOST_REPEATS}")
    if not LEAST_PERIOD_S - _SLACK_S <= period_s <= _LONGEST_S:
        return _wrong(first + 1, period_s, f"a period of at least {LEAST_PERIOD_S:g} s")
    return None


def _repeat_servo(p: Parameters) -> PayloadAction | ActionFault:
    servo = _set_servo(p)
    if not isinstance(servo, actions.SetServo):
        return servo
    return _repetition(p[2], p[3], 3) or actions.RepeatServo(servo.number, servo.width_us, int(p[2]), p[3])


def _set_relay(p: Parameters) -> PayloadAction | ActionFault:
    number, is_on = _whole(p[0]), _whole(p[1], 0, 1)
    if number is None:
        return _wrong(1, p[0], "a relay, from 0")
    return _wrong(2, p[1], "0 or 1") if is_on is None else actions.SetRelay(number, bool(is_on))


def _repeat_relay(p: Parameters) -> PayloadAction | ActionFault:
    number = _whole(p[0])
    if number is None:
        return _wrong(1, p[0], "a relay, from 0")
    return _repetition(p[1], p[2], 2) or actions.RepeatRelay(number, int(p[1]), p[2])


def _gripper(p: Parameters) -> PayloadAction | ActionFault:
    number, action = _whole(p[0]), _whole(p[1], _RELEASE, _GRAB)
    if number is None:
        return _wrong(1, p[0], "a gripper, or 0 for all")
    return (
        _wrong(2, p[1], "0 release or 1 grab")
        if action is None
        else actions.MoveGripper(number, action == _GRAB)
    )


def _winch(p: Parameters) -> PayloadAction | ActionFault:
    number, motion = _whole(p[0]), _whole(p[1])
    if number is None:
        return _wrong(1, p[0], "a winch, or 0 for all")
    if motion not in tuple(WinchMotion):
        known = ", ".join(f"{one.value} {one.name.lower()}" for one in WinchMotion)
        return _wrong(2, p[1], f"one of {known}")
    if motion == WinchMotion.LENGTH and not math.isfinite(p[2]):
        return _wrong(3, p[2], "a length of line in m")
    if motion == WinchMotion.RATE and not math.isfinite(p[3]):
        return _wrong(4, p[3], "a rate in m/s")
    if motion == WinchMotion.LENGTH:
        return actions.MoveWinch(number, WinchMotion.LENGTH, p[2], 0.0 if math.isnan(p[3]) else abs(p[3]))
    return actions.MoveWinch(number, WinchMotion(motion), 0.0, p[3] if motion == WinchMotion.RATE else 0.0)


def _lights(p: Parameters) -> PayloadAction | ActionFault:
    is_on = _whole(p[0], 0, 1)
    return _wrong(1, p[0], "0 or 1") if is_on is None else actions.SetLights(bool(is_on))


def _command(p: Parameters) -> PayloadAction | ActionFault:
    number = _whole(p[0])
    return _wrong(1, p[0], "a command's number") if number is None else actions.RunCommand(number)


def _shoot(p: Parameters) -> PayloadAction | ActionFault:
    """DO_DIGICAM_CONTROL: only "shoot" has an effect."""
    return actions.StartCapture() if p[4] in (1.0, _E7) else _wrong(5, p[4], "1, to take an image")


def _start_capture(p: Parameters) -> PayloadAction | ActionFault:
    interval_s = 0.0 if math.isnan(p[1]) else p[1]
    count = _whole(p[2])
    if not 0.0 <= interval_s <= _LONGEST_S:
        return _wrong(2, p[1], "an interval in s")
    if count is None:
        return _wrong(3, p[2], "a number of images, or 0 until stopped")
    if count != 1 and interval_s <= 0.0:
        return _wrong(2, p[1], "an interval in s between two images")
    return actions.StartCapture(count, interval_s)


def _by_distance(p: Parameters) -> PayloadAction | ActionFault:
    if not 0.0 <= p[0] <= _FARTHEST_M:
        return _wrong(1, p[0], "a distance in m, or 0 to stop")
    return actions.CaptureByDistance(p[0], p[2] == 1.0)


ROWS: dict[int, PayloadRow] = {
    dialect.MAV_CMD_DO_SET_SERVO: PayloadRow("servo", _set_servo),
    dialect.MAV_CMD_DO_REPEAT_SERVO: PayloadRow("servo", _repeat_servo),
    dialect.MAV_CMD_DO_SET_RELAY: PayloadRow("relay", _set_relay),
    dialect.MAV_CMD_DO_REPEAT_RELAY: PayloadRow("relay", _repeat_relay),
    dialect.MAV_CMD_DO_GRIPPER: PayloadRow("gripper", _gripper),
    dialect.MAV_CMD_DO_WINCH: PayloadRow("winch", _winch),
    dialect.MAV_CMD_ILLUMINATOR_ON_OFF: PayloadRow("light", _lights),
    dialect.MAV_CMD_DO_SEND_SCRIPT_MESSAGE: PayloadRow("command", _command),
    dialect.MAV_CMD_DO_DIGICAM_CONTROL: PayloadRow(CAMERA, _shoot),
    dialect.MAV_CMD_IMAGE_START_CAPTURE: PayloadRow(CAMERA, _start_capture),
    dialect.MAV_CMD_IMAGE_STOP_CAPTURE: PayloadRow(CAMERA, lambda _: actions.StopCapture()),
    dialect.MAV_CMD_DO_SET_CAM_TRIGG_DIST: PayloadRow(CAMERA, _by_distance),
}
