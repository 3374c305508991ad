"""Heading and yaw rate from a compass, with or without a gyro.

With a gyro this is the complementary filter: the gyro carries the heading, the compass draws it in with the
time constant GYRO_TIME_S, so compass noise stays out and gyro drift too. Without one it is a fading-memory
(critically damped) g-h filter, gains g = 1 − θ² and h = (1 − θ)² with θ = exp(−dt/τ) (E. Brookner,
*Tracking and Kalman Filtering Made Easy*, 1998, chapter 1).
"""

import math

from companion.units import wrap_pi

GYRO_TIME_S = 0.5
COMPASS_TIME_S = 0.15
RESTART_S = 2.0  # after such a gap the filter begins anew at the reading
MAX_PREDICTION_S = 0.5


class HeadingFilter:
    """Heading in rad (−π..π) and rate in rad/s, both clockwise, at the time of the latest reading."""

    __slots__ = ("heading_rad", "time_s", "yaw_rate_rad_s")

    def __init__(self) -> None:
        self.time_s = -math.inf
        self.heading_rad = 0.0
        self.yaw_rate_rad_s = 0.0

    def update(self, time_s: float, heading_rad: float, yaw_rate_rad_s: float | None) -> None:
        """Take a reading, later than the one before. yaw_rate_rad_s: None without a gyro."""
        dt = time_s - self.time_s
        self.time_s = time_s
        if dt > RESTART_S:
            self.heading_rad = wrap_pi(heading_rad)
            self.yaw_rate_rad_s = yaw_rate_rad_s or 0.0
            return
        if yaw_rate_rad_s is None:
            predicted = self.heading_rad + self.yaw_rate_rad_s * dt
            residual = wrap_pi(heading_rad - predicted)
            fade = math.exp(-dt / COMPASS_TIME_S)
            self.heading_rad = wrap_pi(predicted + (1.0 - fade * fade) * residual)
            self.yaw_rate_rad_s += (1.0 - fade) * (1.0 - fade) / dt * residual
        else:
            predicted = self.heading_rad + 0.5 * (self.yaw_rate_rad_s + yaw_rate_rad_s) * dt
            residual = wrap_pi(heading_rad - predicted)
            self.heading_rad = wrap_pi(predicted + (1.0 - math.exp(-dt / GYRO_TIME_S)) * residual)
            self.yaw_rate_rad_s = yaw_rate_rad_s

    def heading_at_rad(self, now_s: float) -> float:
        """The heading carried on to now_s at the last rate, but no further than MAX_PREDICTION_S."""
        return wrap_pi(self.heading_rad + self.yaw_rate_rad_s * min(now_s - self.time_s, MAX_PREDICTION_S))
