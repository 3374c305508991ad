"""Who may fall silent: the operator, the planner that steers, the hand at the helm, the transmitter."""

import math
from typing import TYPE_CHECKING

from companion.core.modes import Mode

if TYPE_CHECKING:
    from companion.failsafe.inputs import FailsafeInputs


_GOES_ON = 2  # FS_THR_ENABLE: a mission goes on without a transmitter


class Operator:
    """When the operator was last heard; never missed before he has been heard at all."""

    __slots__ = ("last_heard_s",)

    def __init__(self) -> None:
        self.last_heard_s = math.nan

    def heard(self, now_s: float) -> None:
        """A heartbeat of the operator has come."""
        self.last_heard_s = now_s


class Planner:
    """When a planner was last heard, and whether the boat is where it is because a planner steers."""

    __slots__ = ("is_steering", "last_heard_s")

    def __init__(self) -> None:
        self.last_heard_s = math.nan
        self.is_steering = False

    def heard(self, now_s: float) -> None:
        """A planner announces itself."""
        self.last_heard_s = now_s

    def steers(self, now_s: float) -> None:
        """A planner has said where to sail, and the boat obeys."""
        self.last_heard_s = now_s
        self.is_steering = True

    def release(self) -> None:
        """Somebody else has the boat now."""
        self.is_steering = False


def operator_lost(signs: "FailsafeInputs") -> str:
    """The operator's heartbeats have stopped."""
    setting = signs.config.failsafe
    if not setting.gcs_enabled or not signs.now_s - signs.operator.last_heard_s > setting.gcs_timeout_s:
        return ""
    return f"Operator lost for {setting.gcs_timeout_s:g} s"


def planner_lost(signs: "FailsafeInputs") -> str:
    """The program that steered in GUIDED, or in a hand-over of the mission, has fallen silent."""
    limit_s, planner = signs.config.failsafe.planner_timeout_s, signs.planner
    if not planner.is_steering or limit_s <= 0.0 or not signs.now_s - planner.last_heard_s > limit_s:
        return ""
    return f"Planner lost for {limit_s:g} s"


def helm_lost(signs: "FailsafeInputs") -> str:
    """Sticks that steered the boat have gone stale."""
    config = signs.config
    if not config.failsafe.rc_enabled or not signs.sticks.is_lost(config, signs.now_s):
        return ""
    return "" if signs.sticks.rc.is_heard else "RC lost: nobody holds the sticks"


def rc_lost(signs: "FailsafeInputs") -> str:
    """The transmitter is gone, and no station steers in its place."""
    radio, config, now_s = signs.sticks.rc, signs.config, signs.now_s
    enabled = config.failsafe.rc_enabled
    if not radio.is_heard or not enabled or (enabled == _GOES_ON and signs.mode is Mode.AUTO):
        return ""
    fault = radio.fault(config.rc, now_s)
    return f"RC lost: {fault}" if fault and not signs.sticks.has_station(config, now_s) else ""
