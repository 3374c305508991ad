"""Position and velocity over ground: a two-state Kalman filter per axis, run at the receiver's rate.

The model is a constant velocity disturbed by white acceleration (Bar-Shalom, Li, Kirubarajan, *Estimation
with Applications to Tracking and Navigation*, 2001, section 6.3.2, discrete white-noise acceleration).
North and east have the same noise, hence one covariance serves both. The state stands at the time of the
latest fix, so the receiver's latency is made up for by predicting from there to now.

A gate on the innovation and the split of the velocity into water and current belong here, between `update`
and `_blend`, once they exist.
"""

import math

from companion.geo import Point

MAX_PREDICTION_S = (
    2.0  # beyond that the boat is assumed to lie still: its last velocity tells nothing any more
)
VELOCITY_SIGMA_M_S = 0.1  # Doppler velocity of a common receiver


class PositionFilter:
    """Position in m and velocity in m/s, north and east."""

    __slots__ = (
        "_accel_m_s2", "_pp", "_pv", "_vv", "east_m", "east_m_s", "north_m", "north_m_s", "time_s",
    )  # fmt: skip

    def __init__(self, accel_m_s2: float) -> None:
        """accel_m_s2: one standard deviation of what the boat's manoeuvres amount to."""
        self._accel_m_s2 = accel_m_s2
        self.time_s = -math.inf
        self.north_m = self.east_m = self.north_m_s = self.east_m_s = 0.0
        self._pp = self._pv = self._vv = 0.0

    def start(self, time_s: float, at: Point, sigma_m: float) -> None:
        """Begin here, at rest, certain of neither."""
        self.time_s = time_s
        self.north_m, self.east_m = at
        self.north_m_s = self.east_m_s = 0.0
        self._pp, self._pv, self._vv = sigma_m * sigma_m, 0.0, 4.0

    def update(
        self, time_s: float, at: Point, sigma_m: float, velocity_m_s: tuple[float, float] | None
    ) -> None:
        """Take a fix, later than the one before. velocity_m_s is north and east, None if not measured."""
        if self.time_s == -math.inf or time_s - self.time_s > 10.0:
            self.start(time_s, at, sigma_m)
        else:
            self._predict(time_s - self.time_s)
            self.time_s = time_s
            variance = self._pp + sigma_m * sigma_m
            self._blend(at.north_m - self.north_m, at.east_m - self.east_m, self._pp, self._pv, variance)
        if velocity_m_s is not None:
            # A pose from a camera over a pool is a hundred times finer than a satellite's, and so is its
            # velocity.
            sigma_m_s = min(VELOCITY_SIGMA_M_S, sigma_m)
            variance = self._vv + sigma_m_s * sigma_m_s
            north, east = velocity_m_s
            self._blend(north - self.north_m_s, east - self.east_m_s, self._pv, self._vv, variance)

    def _predict(self, dt_s: float) -> None:
        self.north_m += self.north_m_s * dt_s
        self.east_m += self.east_m_s * dt_s
        q = (self._accel_m_s2 * dt_s) ** 2
        self._pp += dt_s * (2.0 * self._pv + dt_s * self._vv) + 0.25 * q * dt_s * dt_s
        self._pv += dt_s * self._vv + 0.5 * q * dt_s
        self._vv += q

    def _blend(self, north: float, east: float, cp: float, cv: float, variance: float) -> None:
        """One scalar update per axis: innovations, their covariances with the state, their variance."""
        kp, kv = cp / variance, cv / variance
        self.north_m += kp * north
        self.east_m += kp * east
        self.north_m_s += kv * north
        self.east_m_s += kv * east
        self._pp -= kp * cp
        self._pv -= kp * cv
        self._vv -= kv * cv

    def predicted_ahead_s(self, now_s: float) -> float:
        """How far ahead of the state to extrapolate for now_s, at most MAX_PREDICTION_S."""
        return min(now_s - self.time_s, MAX_PREDICTION_S)
