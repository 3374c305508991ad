"""The gate: the last word before the motors.

Everything must say go: armed, a fresh command, finite numbers, and a fresh estimate where the command was
computed from one. Anything else is zero at once, with the reason. What passes is limited in slew, goes
through zero on its way from ahead to astern, and is dropped inside the dead band.

A stop centres the rudder as well: the boat then coasts straight on instead of circling, and starts straight
ahead when the motors run again.
"""

import math

from companion.config.tuning import MotorLimits
from companion.core.state import MotorCommand, NavState, Thrust, lacks_heading, lacks_position
from companion.core.units import clamp


class Gate:
    """Remembers only where the slew limiter stands."""

    def __init__(self) -> None:
        self._left = 0.0
        self._right = 0.0
        self._rudder = 0.0

    def check(
        self,
        thrust: Thrust,
        *,
        armed: bool,
        command_age_s: float,
        nav: NavState | None,
        needs_estimate: bool,
        setting: MotorLimits,
        dt_s: float,
        needs_position: bool = True,
        estimate_age_s: float = 0.0,
        rudder_slew_per_s: float = 0.0,
        output_fault: str = "",
    ) -> MotorCommand:
        """What motors and rudder may do for the next dt_s.

        command_age_s: how long ago the command was decided; a negative age is as bad as a stale one, for a
        clock that runs wrong would otherwise keep the motors running. needs_estimate: whether the command
        was computed from nav (False while the operator drives by hand). needs_position: not while a boat that
        has lost its position keeps its bow into the water. estimate_age_s: how long ago nav was computed.
        output_fault: why motors or rudder cannot be driven.
        """
        estimate = nav if needs_estimate else _FINE
        age_s = estimate_age_s if needs_estimate else 0.0
        reason = _objection(thrust, armed, command_age_s, estimate, setting, needs_position, age_s)
        reason = reason or output_fault
        if reason:
            self._left = self._right = self._rudder = 0.0
            return MotorCommand(0.0, 0.0, reason)
        step = max(0.0, setting.slew_per_s * dt_s)  # 0 for NaN, too
        deadband = setting.deadband
        self._left = left = _approach(self._left, thrust.left, step, deadband)
        self._right = right = _approach(self._right, thrust.right, step, deadband)
        step = max(0.0, rudder_slew_per_s * dt_s)
        self._rudder = clamp(clamp(thrust.rudder, -1.0, 1.0), self._rudder - step, self._rudder + step)
        left, right = left if abs(left) >= deadband else 0.0, right if abs(right) >= deadband else 0.0
        return MotorCommand(left, right, "", self._rudder)


_FINE = NavState(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


def _objection(
    thrust: Thrust,
    armed: bool,
    command_age_s: float,
    nav: NavState | None,
    setting: MotorLimits,
    needs_position: bool,
    estimate_age_s: float,
) -> str:
    """Why the motors must not turn; empty when they may. Comparisons are written so that NaN objects."""
    if not armed:
        return "disarmed"
    if not 0.0 <= command_age_s <= setting.command_timeout_s:
        return "command is stale"
    if not math.isfinite(thrust.left + thrust.right + thrust.rudder):
        return "thrust is not a number"
    if nav is None:
        return "no estimate"
    if not 0.0 <= estimate_age_s <= setting.command_timeout_s:
        return "estimate is stale"
    limit_s = setting.estimate_timeout_s
    if needs_position and lacks_position(nav, limit_s):
        return "position is stale"
    if lacks_heading(nav, limit_s):
        return "heading is stale"
    motion = nav.north_m + nav.east_m + nav.heading_rad + nav.yaw_rate_rad_s + nav.surge_m_s + nav.sway_m_s
    if not math.isfinite(motion):
        return "estimate is not a number"
    return ""


def _approach(now: float, wanted: float, step: float, deadband: float) -> float:
    """One slew step from now toward wanted, stopping at zero where the sign changes."""
    wanted = clamp(wanted, -1.0, 1.0)
    if abs(wanted) < deadband:
        wanted = 0.0
    if now * wanted < 0.0:
        wanted = 0.0
    return clamp(wanted, now - step, now + step)
