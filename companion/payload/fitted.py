"""What payload the boat has, and whether an action is possible on it."""

import math
from collections.abc import Iterable, Sequence
from typing import TypeVar

from companion.config.payload import (
    CameraSetting,
    CommandPayload,
    GripperPayload,
    LightPayload,
    PayloadSetting,
    RelayPayload,
    ServoPayload,
    WinchPayload,
)
from companion.payload.actions import (
    ActionFault,
    CaptureByDistance,
    MoveGripper,
    MoveWinch,
    PayloadAction,
    RepeatRelay,
    RepeatServo,
    RunCommand,
    SetLights,
    SetRelay,
    SetServo,
    StartCapture,
    StopCapture,
    WinchMotion,
)

_ALL = 0  # number of all grippers or winches
_RATE_SLACK = 0.01  # share of a winch's only speed
_Setting = TypeVar("_Setting", bound=PayloadSetting)
CAMERA = "camera"
_KINDS: dict[str, type[PayloadSetting]] = {
    "servo": ServoPayload,
    "relay": RelayPayload,
    "light": LightPayload,
    "gripper": GripperPayload,
    "winch": WinchPayload,
    "command": CommandPayload,
}


class FittedPayload:
    """The configured payload. is_skipped: whether mission items for an absent one are skipped."""

    def __init__(
        self,
        settings: Sequence[PayloadSetting] = (),
        camera: CameraSetting | None = None,
        *,
        is_skipped: bool = False,
    ) -> None:
        self.settings = tuple(settings)
        self.has_capture = camera is not None and bool(camera.capture)
        self.is_skipped = is_skipped

    def resolve(self, action: PayloadAction) -> PayloadAction | ActionFault:
        """The action to carry out, or why it is impossible. A relay may stand for an owner's command."""
        if isinstance(action, SetRelay):
            for one in self.of_kind(CommandPayload):
                if one.relay == action.number:
                    return RunCommand(one.number) if action.is_on else ActionFault(2, _only_on(one))
        return self.fault(action) or action

    def fault(self, action: PayloadAction) -> ActionFault | None:
        """Why the action is impossible, None if it is not."""
        match action:
            case SetServo(channel, width_us) | RepeatServo(channel, width_us):
                servo = self._find(ServoPayload, "servo", channel)
                return servo if isinstance(servo, ActionFault) else _width_fault(servo, width_us)
            case SetRelay(number):
                relay = self._find(RelayPayload, "relay", number)
                return relay if isinstance(relay, ActionFault) else None
            case RepeatRelay(number, _, period_s):
                relay = self._find(RelayPayload, "relay", number)
                return relay if isinstance(relay, ActionFault) else _period_fault(relay, period_s)
            case MoveGripper(number):
                gripper = self._find(GripperPayload, "gripper", number) if number != _ALL else None
                return gripper if isinstance(gripper, ActionFault) else self.lacks("gripper")
            case MoveWinch(number):
                if number != _ALL:
                    winch = self._find(WinchPayload, "winch", number)
                    return winch if isinstance(winch, ActionFault) else _winch_fault(winch, action)
                faults = (_winch_fault(one, action) for one in self.of_kind(WinchPayload))
                return self.lacks("winch") or next(filter(None, faults), None)
            case RunCommand(number):
                command = self._find(CommandPayload, "command", number)
                return command if isinstance(command, ActionFault) else None
            case SetLights() | StartCapture() | StopCapture() | CaptureByDistance():
                return None

    def lacks(self, noun: str) -> ActionFault | None:
        """A fault if there is no payload of a kind, by its noun in messages."""
        kind = _KINDS.get(noun)
        is_fitted = self.has_capture if kind is None else bool(self.of_kind(kind))
        if is_fitted or (
            noun == "relay" and any(one.relay is not None for one in self.of_kind(CommandPayload))
        ):
            return None
        what = "camera with a capture command" if noun == CAMERA else noun
        return ActionFault(0, f"this boat has no {what}", is_absent=True)

    def of_kind(self, kind: type[_Setting]) -> tuple[_Setting, ...]:
        """The settings of a kind."""
        return tuple(one for one in self.settings if isinstance(one, kind))

    def _find(self, kind: type[_Setting], noun: str, number: int) -> _Setting | ActionFault:
        if lack := self.lacks(noun):
            return lack
        fitted = self.of_kind(kind)
        for one in fitted:
            if one.number == number:
                return one
        expected = _list_of(fitted) if fitted else "that of a command"
        return ActionFault(1, f"no {noun} {number}, expected {expected}", is_absent=True)


def _list_of(fitted: Iterable[PayloadSetting]) -> str:
    named = [f"{one.number} ({one.name})" if one.name else f"{one.number}" for one in fitted]
    return named[0] if len(named) == 1 else f"{', '.join(named[:-1])} or {named[-1]}"


def _only_on(command: CommandPayload) -> str:
    return f"{command.title}: relay {command.relay} off, expected on, which starts it"


def _width_fault(servo: ServoPayload, width_us: int) -> ActionFault | None:
    low_us, high_us = servo.signal.min_us, servo.signal.max_us
    if low_us <= width_us <= high_us:
        return None
    return ActionFault(2, f"{servo.title}: {width_us} us, expected {low_us} to {high_us}")


def _period_fault(relay: RelayPayload, period_s: float) -> ActionFault | None:
    if not relay.max_on_s or 0.5 * period_s <= relay.max_on_s:
        return None
    return ActionFault(3, f"{relay.title}: period {period_s:g} s, expected at most {2.0 * relay.max_on_s:g}")


def _winch_fault(winch: WinchPayload, action: MoveWinch) -> ActionFault | None:
    if action.motion is WinchMotion.LENGTH and not abs(action.length_m) <= winch.line_m:
        return ActionFault(3, f"{winch.title}: {action.length_m:g} m, expected at most {winch.line_m:g}")
    if action.motion not in (WinchMotion.LENGTH, WinchMotion.RATE):
        return None
    speed_m_s, rate_m_s = winch.speed_m_s, abs(action.rate_m_s)
    if winch.out_pin is None and not rate_m_s <= speed_m_s:
        return ActionFault(4, f"{winch.title}: {action.rate_m_s:g} m/s, expected at most {speed_m_s:g}")
    is_only_speed = math.isclose(rate_m_s, speed_m_s, rel_tol=_RATE_SLACK)
    if winch.out_pin is not None and rate_m_s and not is_only_speed:
        return ActionFault(4, f"{winch.title}: {action.rate_m_s:g} m/s, expected 0 or {speed_m_s:g}")
    return None
