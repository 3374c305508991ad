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
    ALL,
    ActionFault,
    CameraAction,
    MoveWinch,
    PayloadAction,
    RepeatRelay,
    RepeatServo,
    RunCommand,
    SetLights,
    SetRelay,
    SetServo,
    UnitAction,
    WinchMotion,
)

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
_TAKES_ALL = ("gripper", "light", "winch")


def addresses(action: UnitAction, setting: PayloadSetting) -> bool:
    """Whether an action is for this payload."""
    is_one = setting.number == action.number or (action.number == ALL and action.kind in _TAKES_ALL)
    return is_one and isinstance(setting, _KINDS[action.kind])


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
                    fault = f"{one.title}: relay {one.relay} off, expected on, which starts it"
                    return RunCommand(one.number) if action.is_on else ActionFault(2, fault)
        return self.fault(action) or action

    def fault(self, action: PayloadAction) -> ActionFault | None:
        """Why the action is impossible, None if it is not."""
        if isinstance(action, CameraAction | SetLights):
            return None
        if lack := self.lacks(action.kind):
            return lack
        addressed = [one for one in self.settings if addresses(action, one)]
        if not addressed:
            fitted = self.of_kind(_KINDS[action.kind])
            expected = _list_of(fitted) if fitted else "that of a command"
            return ActionFault(1, f"no {action.kind} {action.number}, expected {expected}", is_absent=True)
        return next(filter(None, (_limit_fault(one, action) for one in addressed)), None)

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
        return tuple(one for one in self.settings if isinstance(one, kind))


def _list_of(fitted: Iterable[PayloadSetting]) -> str:
    named = [f"{one.number} ({one.name})" if one.name else f"{one.number}" for one in fitted]
    return named[0] if len(named) == 1 else f"{', '.join(named[:-1])} or {named[-1]}"


def _limit_fault(setting: PayloadSetting, action: UnitAction) -> ActionFault | None:
    match setting, action:
        case ServoPayload(), SetServo(_, width_us) | RepeatServo(_, width_us):
            low_us, high_us = setting.signal.min_us, setting.signal.max_us
            if not low_us <= width_us <= high_us:
                return ActionFault(2, f"{setting.title}: {width_us} us, expected {low_us} to {high_us}")
        case RelayPayload(), RepeatRelay(_, _, period_s):
            most_s = 2.0 * setting.max_on_s or math.inf
            if period_s > most_s:
                return ActionFault(3, f"{setting.title}: period {period_s:g} s, expected at most {most_s:g}")
        case WinchPayload(), MoveWinch():
            return _winch_fault(setting, action)
    return None


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
