"""The arming checks: everything that must be in order before the motors may turn."""

from collections.abc import Callable
from typing import Final

from companion.config.boat_config import BoatConfig
from companion.core.modes import Mode
from companion.core.readings import BatteryReading, GnssFix
from companion.core.state import EstimateFault, NavState
from companion.rc.manual_input import ManualInput

RESTARTING: Final = "Program: restarting"
_NO_COMPASS: Final = int(EstimateFault.COMPASS_LOST | EstimateFault.COMPASS_FROZEN)


def absolute_faults(output_fault: str, *, is_restarting: bool) -> list[str]:
    """Why nobody can arm the boat, not even by force. output_fault: what motors or rudder lack."""
    faults = [f"Motors: {output_fault}"] if output_fault else []
    return [*faults, RESTARTING] if is_restarting else faults


def fence_faults(mode: Mode, *, is_outside: bool, is_lost: bool) -> list[str]:
    """What the fence has against arming. is_lost: the stored fence could not be read."""
    faults: list[str] = []
    if is_outside and not mode.rules.comes_inside:
        faults.append("Fence: the boat is outside; armed in LOITER or RTL it comes back")
    if is_lost:
        faults.append("Fence: the stored fence is lost: upload or clear it")
    return faults


def sensor_faults(
    config: BoatConfig,
    mode: Mode,
    nav: NavState | None,
    fix: GnssFix | None,
    battery: BatteryReading | None,
    *,
    has_battery_monitor: bool,
) -> list[str]:
    """What the sensors lack for arming, worst first.

    MANUAL and HOLD arm without a position. Every mode needs a compass: at rest the course tells no heading.
    """
    setting, timeout_s = config.arming, config.motors.estimate_timeout_s
    if not setting.check:
        return []
    faults: list[str] = []
    if mode.rules.needs_position:
        if fix is None or fix.fix_type < setting.min_fix_type:
            faults.append(f"GPS: no {'3-D ' if setting.min_fix_type >= 3 else ''}fix")
        elif fix.hdop > setting.max_hdop:
            faults.append(f"GPS: HDOP {fix.hdop:.1f} is above {setting.max_hdop:.1f}")
        elif nav is None or nav.position_age_s > timeout_s:
            faults.append("GPS: position is stale")
    if nav is None or nav.heading_age_s > timeout_s or nav.faults & _NO_COMPASS:
        faults.append("Compass: no heading")
    if battery is None:
        if has_battery_monitor:
            faults.append("Battery: unhealthy, the monitor is silent")
    elif battery.voltage_v < setting.battery_min_v:
        faults.append(f"Battery: {battery.voltage_v:.1f} V is below {setting.battery_min_v:.1f} V")
    return faults


def rc_fault(sticks: ManualInput, config: BoatConfig, now_s: float) -> str:
    """Why the sticks, or the transmitter's state, prevent arming; empty when they do not.

    A transmitter that was never received does not, nor does a lost one while a station steers or without its
    failsafe. A stick that would steer must be neutral in every mode, whoever holds it, as in Rover.
    """
    radio = sticks.rc
    if now_s < radio.calibrated_until_s:
        return "RC: being calibrated"
    if not config.arming.check:
        return ""
    is_needed = config.failsafe.rc_enabled and not sticks.has_station(config, now_s)
    if is_needed and (fault := radio.fault(config.rc, now_s)):
        return f"RC: {fault}"
    raised = sticks.raised_stick(config, now_s)
    return f"RC: {raised} is not neutral" if raised else ""


class PreArmReport:
    """Reports the arming faults of a disarmed boat: when they appear, and again every repeat_s."""

    FIRST_S = 5.0  # since boot: receiver and compass start up
    CHECK_S = 1.0

    def __init__(self) -> None:
        self._check_s = self.FIRST_S

    def update(self, faults: Callable[[], list[str]], now_s: float, repeat_s: float) -> list[str]:
        """What to report now. Calls `faults` at most once in CHECK_S."""
        if now_s < self._check_s:
            return []
        found = faults()
        self._check_s = now_s + (repeat_s if found else self.CHECK_S)
        return found
