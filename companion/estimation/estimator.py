"""Estimates position, velocity, heading and water current from all sensors.

The filter (`error_state.py`) is advanced every tick by gyro, thrust and steering. A GNSS fix
(`position_update.py`) and a compass (`heading_update.py`) correct it at the time of their measurement. A GNSS
outage therefore only increases the uncertainty: the estimate is continuous dead reckoning with corrections
(T. I. Fossen, *Handbook of Marine Craft Hydrodynamics and Motion Control*, 2nd ed. 2021, chapters 13 and 14).

Horizontal vectors are complex numbers, north + i east; multiplication by exp(iψ) rotates by ψ clockwise.

Limit: a receiver whose positions and velocities drift together, no faster than a plausible current, shows as
a current. Positions that drift away from their own velocities are detected.
"""

import math
from typing import Final

from msgspec import Struct

from companion.config.actuators import DIFFERENTIAL, DriveSetting, Handling
from companion.config.tuning import Estimation, Speed
from companion.core.geo import LocalFrame, Point
from companion.core.readings import GnssFix, HeadingReading
from companion.core.state import EstimateFault, MotorCommand, NavState
from companion.estimation.covariance import STATE_NAMES
from companion.estimation.error_state import ErrorStateFilter
from companion.estimation.fix_error import fix_error, stated_m
from companion.estimation.heading_update import HeadingUpdate
from companion.estimation.innovation import Innovation
from companion.estimation.nominal_state import STRIDE_S
from companion.estimation.position_update import PositionUpdate

MIN_FIX_TYPE: Final = 3  # a 3-D fix
MAX_SIGMA_M: Final = 1000.0  # larger values are treated as faults; the comparison also rejects NaN
MAX_SPEED_M_S: Final = 100.0
MAX_FIX_AGE_S: Final = 10.0  # on arrival; an older fix is not used
MAX_OFFSET_M: Final = 100_000.0  # from the frame's origin: the limit of its projection
FAR_S: Final = 3.0  # all fixes must lie beyond the limit for this long: a single one may be wrong
# Of the loops, for each second by which compass and gyro are late: without it a boat whose readings are 1 s
# late swings by 20° in gusts (seeds 1243, 1244)
_RESTRAINT: Final = 0.5
_HEALTH_S: Final = 0.0999  # period of the health check
_POSITION_LOST: Final = int(EstimateFault.POSITION_LOST)
_HEADING_LOST: Final = int(EstimateFault.HEADING_LOST)


class EstimatorReport(Struct, frozen=True):
    """state: as `covariance.STATE_NAMES`; covariance: of its error, by rows; hypotheses: name, chance."""

    state: tuple[float, ...]
    covariance: tuple[tuple[float, ...], ...]
    position_north: Innovation
    position_east: Innovation
    velocity_north: Innovation
    velocity_east: Innovation
    compass: Innovation
    gyro: Innovation
    hypotheses: tuple[tuple[str, float], ...] = ()


class Estimator:
    """`frame` is None before the first good fix.

    Fixes too far from its origin are not used. far_m: distance of the latest such fix, once they have lasted
    for FAR_S; 0 otherwise. `reset_origin` then moves the origin.
    """

    def __init__(
        self,
        speed: Speed | None = None,
        setting: Estimation | None = None,
        drive: DriveSetting = DIFFERENTIAL,
        handling: Handling | None = None,
    ) -> None:
        """speed: the boat's speed figures; setting: the estimator's settings; drive: motors and rudder;
        handling: figures of the hull.
        """
        self._setting = setting = setting or Estimation()
        self._health_due_s = 0.0
        self._sigma_m = self.far_m = 0.0
        self._far_since_s = self._far_heard_s = -math.inf
        self._faults = 0
        self.frame: LocalFrame | None = None
        # set before the first fix; None: the first good fix defines the frame
        self.preset_frame: LocalFrame | None = None
        self.state = ErrorStateFilter(speed or Speed(), setting, drive, handling)
        self.heading = HeadingUpdate(self.state, setting)
        self.position = PositionUpdate(self.state, self.heading, setting)

    def update(
        self,
        fix: GnssFix | None,
        heading: HeadingReading | None,
        now_s: float,
        command: MotorCommand | None = None,
    ) -> NavState | None:
        """Advance to now_s. Returns None before the first accepted measurement.

        command: the motor command since the last call; None if unknown, taken as zero. If only one of
        position and heading is known, the other is 0 with an infinite age.
        """
        state, position = self.state, self.position
        has_fix = fix is not None and position.fix_s < fix.time_s <= now_s and fix.fix_type >= MIN_FIX_TYPE
        self.heading.advance(heading, now_s, ends_block=has_fix)
        if now_s - state.time_s >= STRIDE_S:
            state.move(now_s, command)
        if fix is not None and has_fix:
            self._ingest_fix(fix, now_s)
        if state.is_pending:
            state.commit()
        position_age, heading_age = now_s - position.accepted_s, now_s - self.heading.time_s
        if position_age == math.inf and heading_age == math.inf:
            return None
        if now_s >= self._health_due_s:
            self._health_due_s = now_s + _HEALTH_S
            self._check_health(now_s)
        setting, faults = self._setting, self._faults
        if setting.gnss_timeout_s < position_age < math.inf and not faults & _POSITION_LOST:
            position_age = setting.gnss_timeout_s  # dead reckoning
        if setting.compass_timeout_s < heading_age < math.inf and not faults & _HEADING_LOST:
            heading_age = setting.compass_timeout_s  # the yaw model bridges short gaps
        yaw, u, v = state.heading_rad, state.surge_m_s, state.sway_m_s
        cos, sin = math.cos(yaw), math.sin(yaw)
        current_north, current_east = state.current_north_m_s, state.current_east_m_s
        north_m = east_m = north_m_s = east_m_s = 0.0
        if self.frame is not None:
            north_m_s, east_m_s = u * cos - v * sin + current_north, u * sin + v * cos + current_east
            ahead_s = now_s - state.time_s
            north_m, east_m = state.north_m + north_m_s * ahead_s, state.east_m + east_m_s * ahead_s
        return NavState(
            now_s,
            north_m,
            east_m,
            yaw,
            state.yaw_rate_rad_s,
            north_m_s,
            east_m_s,
            north_m_s * cos + east_m_s * sin,
            east_m_s * cos - north_m_s * sin,
            position_age,
            heading_age,
            current_north,
            current_east,
            self._sigma_m,
            faults,
            state.measured_rate_rad_s,
            state.yaw_model.wave_rad,
            state.yaw_model.wave_rad_s,
            max(state.yaw_model.waves.share, min(_RESTRAINT * self.heading.latency.delay_s, 1.0)),
            state.yaw_model.hull.accel_rad_s2,
            state.yaw_model.hull.damping_per_s,
        )

    @property
    def report(self) -> EstimatorReport | None:
        """The filter's inside; None before the first fix."""
        if self.frame is None:
            return None
        state = self.state
        position, velocity, yaw = state.position, state.velocity, state.yaw_model
        return EstimatorReport(
            tuple(getattr(state, name) for name in STATE_NAMES),
            tuple(tuple(row) for row in state.covariance.rows),
            position.north, position.east, velocity.north, velocity.east, state.compass,
            Innovation(state.turned_s, yaw.innovation_rad_s, yaw.variance, is_accepted=True),
            self.heading.bank.hypotheses(),
        )  # fmt: skip

    def _check_health(self, now_s: float) -> None:
        """Update the position uncertainty and the faults."""
        self.state.keep_covariance()
        self.heading.add_expected(now_s)
        self._faults = self.heading.faults(now_s)
        if self.frame is not None:
            self.position.add_expected(now_s)
            self._sigma_m = self.position.sigma_m
            self._faults |= self.position.faults(now_s)

    def _ingest_fix(self, fix: GnssFix, now_s: float) -> None:
        if not now_s - fix.time_s <= MAX_FIX_AGE_S:
            return
        sigma_m = stated_m(fix)
        velocity = None
        if fix.north_m_s is not None and fix.east_m_s is not None:
            velocity = complex(fix.north_m_s, fix.east_m_s)
        if not (0.0 <= sigma_m <= MAX_SIGMA_M and abs(velocity or 0j) <= MAX_SPEED_M_S):
            return
        if self.frame is None:
            chosen = self.preset_frame
            if chosen is None or not _is_near(chosen.to_local(fix.position)):
                chosen = LocalFrame(fix.position)
            self.frame = chosen
        at = self.frame.to_local(fix.position)
        if _is_near(at):
            self.far_m = 0.0
            self._far_heard_s = -math.inf
            error = fix_error(fix, self._setting, fix.time_s - self.position.fix_s)
            self.position.update(fix.time_s, complex(*at), velocity, error, fix.reset_counter)
        elif fix.time_s > self._far_heard_s:
            self._note_far_fix(fix.time_s, math.hypot(*at))

    def _note_far_fix(self, time_s: float, far_m: float) -> None:
        if time_s - self._far_heard_s > MAX_FIX_AGE_S:
            self._far_since_s = time_s
        self._far_heard_s = time_s
        self.far_m = far_m if time_s - self._far_since_s >= FAR_S else 0.0

    def reset_origin(self) -> None:
        """Drop the frame: the next good fix defines it and restarts the position. Heading and current are
        kept.
        """
        self.frame, self.far_m = None, 0.0
        self.position = PositionUpdate(self.state, self.heading, self._setting)


def _is_near(at: Point) -> bool:
    return math.hypot(at.north_m, at.east_m) <= MAX_OFFSET_M
