"""What the vehicle does when a failsafe fires."""

import math
from typing import TYPE_CHECKING, Final

from companion.core.health import lacks_heading
from companion.core.modes import Mode
from companion.core.status_text import Severity
from companion.failsafe.actions import ON_THE_SPOT, RETREATS, WAYS_HOME, Action
from companion.failsafe.escalation import Move
from companion.failsafe.monitor import Alarm
from companion.failsafe.power import shortfall
from companion.failsafe.table import Condition, Row

if TYPE_CHECKING:
    from companion.vehicle.vehicle import Vehicle

NO_HEADING: Final = "no heading"
_RANGE_S: Final = 1.0  # how often the charge is held against the way home
# Clearing the propellers and trying the motors, twice over, and getting under way again
_DRIFT_S: Final = 60.0
_TRY_S: Final = 10.0  # trying the motors, and turning into what the water does
TRY_AGAIN_S: Final = 15.0  # and what a boat with one motor then takes to get out of the way
_ASTRAY_RAD: Final = (0.0, -0.3, 0.3)  # the set is not known better
_LIMP_SHARE: Final = 0.5  # of cruise speed: what a propeller with weed, or a cool head, still manages


class FailsafeActions:
    """The vehicle's own; asked while the failsafes are due."""

    __slots__ = ("_range_due_s", "_vehicle")

    def __init__(self, vehicle: "Vehicle") -> None:
        self._vehicle = vehicle
        self._range_due_s = 0.0

    def watch(self, now_s: float) -> None:
        """Let the failsafes look, and do what they ask."""
        vehicle = self._vehicle
        signs, nav = vehicle.failsafes.signs, vehicle.nav
        signs.now_s, signs.config, signs.mode, signs.armed = (
            now_s,
            vehicle.config,
            vehicle.mode,
            vehicle.armed,
        )
        signs.nav, signs.fix, signs.battery = nav, vehicle.fix, vehicle.battery
        signs.is_guided = vehicle.is_guided
        if now_s >= self._range_due_s:
            self._range_due_s = now_s + _RANGE_S
            home, frame = vehicle.home, vehicle.frame
            signs.home = None if home is None or frame is None else frame.to_local(home)
            signs.home_distance_m = math.inf if nav is None else vehicle.home_distance_m(nav.point)
            signs.shortfall = shortfall(signs)
        signs.fence.update(vehicle.fence, nav, vehicle.config.motors, now_s)
        for alarm in vehicle.failsafes.update(vehicle.drills.is_running):
            self._act_on(alarm, now_s)
        if signs.motors.needs_trial and self._may_try_motors():
            vehicle.notify(Severity.NOTICE, "Steering does not turn the boat: trying the motors")
            vehicle.probe.begin(now_s)

    def _act_on(self, alarm: Alarm, now_s: float) -> None:
        vehicle = self._vehicle
        action, row = alarm.action, alarm.ladder.row
        if alarm.move is Move.ENDS:
            if alarm.text:
                vehicle.notify(Severity.NOTICE, f"Failsafe over: {alarm.text}")
            return
        does_nothing = not vehicle.armed or vehicle.mode is Mode.HOLD or action is Action.NONE
        if alarm.move is Move.CLIMBS and does_nothing and action is not Action.DISARM:
            return
        still = ", still" if alarm.move is Move.CLIMBS else ""
        severity = Severity.WARNING if action is Action.NONE else Severity.CRITICAL
        vehicle.notify(severity, f"Failsafe: {alarm.text}{still}")
        if action is Action.GET_OFF:
            if vehicle.armed and vehicle.mode is not Mode.HOLD:
                vehicle.drills.stop()
                vehicle.drills.refloat.begin(now_s)
            return
        if vehicle.drills.refloat.is_running and action in ON_THE_SPOT:
            return  # first it has to float
        if action is Action.CLEAR_PROPELLERS and vehicle.probe.motors.has_reversed:
            action = Action.TRY_MOTORS  # what was turned round may be right again
        if action is Action.DISARM:
            vehicle.disarm("by failsafe")
        elif does_nothing:
            return
        elif action is Action.CLEAR_PROPELLERS:
            if vehicle.probe.motors.has_failed and not self.may_drift(_DRIFT_S):
                return  # sailing with one motor is all that keeps it off
            vehicle.notify(Severity.WARNING, "Clearing the propellers")
            vehicle.drills.clearing.begin(now_s)
        elif action is Action.TRY_MOTORS and not self.may_drift(_TRY_S) and self._presume(now_s):
            return
        elif action is Action.TRY_MOTORS:
            vehicle.notify(Severity.WARNING, "Trying the motors")
            vehicle.drills.clearing.stop()
            vehicle.probe.begin(now_s)
        elif action is Action.HOLD or not self._is_spared(row):
            self._retreat(action)
            if row.limps:
                vehicle.speed_m_s = _LIMP_SHARE * vehicle.config.speed.cruise_m_s

    def _may_try_motors(self) -> bool:
        """Whether a trial may take the place of the mode for some seconds."""
        vehicle = self._vehicle
        is_driving = vehicle.armed and not vehicle.mode.is_by_hand and vehicle.mode is not Mode.HOLD
        is_wanted = Action(vehicle.config.failsafe.motor_action) is Action.TRY_MOTORS
        return is_driving and is_wanted and not vehicle.drills.is_running and self.may_drift(_TRY_S)

    def _is_spared(self, row: Row) -> bool:
        """Whether what the boat does already is what it would be told to do."""
        vehicle = self._vehicle
        if row.condition is Condition.FENCE_BREACHED and vehicle.mode is Mode.LOITER:
            return vehicle.conduct.stays_inside(vehicle.frame)
        return row.spares_way_home and vehicle.mode in WAYS_HOME

    def may_drift(self, seconds: float) -> bool:
        """Whether the water carries the boat over no line in so long."""
        nav = self._vehicle.nav
        if nav is None:
            return True
        drift_m = seconds * math.hypot(nav.current_north_m_s, nav.current_east_m_s)
        course, fence = math.atan2(nav.current_east_m_s, nav.current_north_m_s), self._vehicle.fence
        return all(fence.room_m(nav.point, course + off, drift_m) >= drift_m for off in _ASTRAY_RAD)

    def _presume(self, now_s: float) -> bool:
        """Without room to try the motors, the one that is accused is taken to be dead; False if none is."""
        vehicle, motors = self._vehicle, self._vehicle.failsafes.signs.motors
        lost = motors.has_lost
        if not lost:
            return False
        vehicle.drills.stop()
        vehicle.probe.presume(lost == "left", now_s)
        vehicle.failsafes.signs.failed_motor = vehicle.probe.fault()
        vehicle.notify(Severity.WARNING, "No room to try the motors: going on with one")
        return True

    def _retreat(self, action: Action) -> None:
        """The first mode of an action that can be entered; without a position, LOITER by dead reckoning."""
        vehicle = self._vehicle
        vehicle.drills.clearing.stop()
        vehicle.probe.stop()
        if action is Action.HOLD:
            vehicle.drills.stop()
        for mode in RETREATS[action]:
            fault = vehicle.estimate_fault() if mode is Mode.LOITER else ""
            if fault and self._can_reckon():
                vehicle.force_mode(mode, "failsafe, by dead reckoning")
                return
            if fault == NO_HEADING:
                vehicle.force_mode(mode, "failsafe, feeling for its heading")
                return
            if vehicle.change_mode(mode, "failsafe").accepted:
                return
        vehicle.change_mode(Mode.HOLD, "failsafe")

    def _can_reckon(self) -> bool:
        nav, timeout_s = self._vehicle.nav, self._vehicle.config.motors.estimate_timeout_s
        return nav is not None and self._vehicle.frame is not None and not lacks_heading(nav, timeout_s)
