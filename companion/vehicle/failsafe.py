"""Failsafes in their simplest form: the operator falls silent, or the pack runs low.

A failsafe fires once, when its condition begins; after it the operator is free to choose another mode.
"""

import math
from dataclasses import dataclass
from enum import IntEnum

from companion.config import Failsafe
from companion.sensors.readings import BatteryReading
from companion.vehicle.modes import Mode


class Action(IntEnum):
    """ArduPilot Rover's FS_ACTION numbers."""

    NONE = 0
    RTL = 1
    HOLD = 2
    SMART_RTL_OR_RTL = 3
    SMART_RTL_OR_HOLD = 4
    DISARM = 5
    LOITER_OR_HOLD = 6


RETREATS: dict[Action, tuple[Mode, ...]] = {
    Action.RTL: (Mode.RTL,),
    Action.HOLD: (),
    Action.SMART_RTL_OR_RTL: (Mode.SMART_RTL, Mode.RTL),
    Action.SMART_RTL_OR_HOLD: (Mode.SMART_RTL,),
    Action.LOITER_OR_HOLD: (Mode.LOITER,),
}
"""The modes of an action: the first that can be entered, else HOLD."""


@dataclass(frozen=True, slots=True)
class Alarm:
    """A failsafe that has just fired."""

    action: Action
    text: str


class OperatorWatch:
    """Counts the seconds since the operator was last heard. Never fires before one has been heard at all."""

    def __init__(self) -> None:
        self.last_heard_s = math.nan
        self.is_lost = False

    def heard(self, now_s: float) -> None:
        """A heartbeat of the operator has come."""
        self.last_heard_s = now_s

    def update(self, setting: Failsafe, now_s: float) -> Alarm | None:
        """The alarm when the silence has just grown too long."""
        lost = setting.gcs_enabled and now_s - self.last_heard_s > setting.gcs_timeout_s
        began, self.is_lost = lost and not self.is_lost, lost
        if not began:
            return None
        return Alarm(Action(setting.action), f"Operator lost for {setting.gcs_timeout_s:g} s")


class BatteryWatch:
    """Fires when the voltage has stayed below the limit for long enough; a sag under load is forgiven."""

    def __init__(self) -> None:
        self.is_low = False
        self._low_since_s = math.nan

    def update(self, setting: Failsafe, battery: BatteryReading | None, now_s: float) -> Alarm | None:
        """The alarm when the pack has just been found low. Low stays low until the boat is restarted."""
        if self.is_low or battery is None or setting.battery_low_v <= 0.0:
            return None
        if battery.voltage_v >= setting.battery_low_v:
            self._low_since_s = math.nan
            return None
        if math.isnan(self._low_since_s):
            self._low_since_s = now_s
        if now_s - self._low_since_s < setting.battery_low_s:
            return None
        self.is_low = True
        return Alarm(Action(setting.battery_action), f"Battery low: {battery.voltage_v:.1f} V")
