"""Heading and yaw rate from a compass and a gyro, or from either alone.

With a gyro: a complementary filter with bias estimation. The gyro propagates the heading; the compass
corrects it with time constant DRAW_S and estimates the gyro bias (R. Mahony, T. Hamel, J.-M. Pflimlin,
*Nonlinear Complementary Filters on the Special Orthogonal Group*, IEEE Trans. Automatic Control 53(5), 2008,
the filter with bias, in the plane). Readings are averaged over short blocks. A compass is rejected if it
disagrees with the gyro, repeats its value while the gyro turns, or jumps faster than a hull can turn.

Without a gyro: a fading-memory (critically damped) g-h filter, gains g = 1 − θ² and h = (1 − θ)² with θ =
exp(−dt/τ) (E. Brookner, *Tracking and Kalman Filtering Made Easy*, 1998, chapter 1).

Without a compass: the gyro alone; other sources, such as the course over ground, call `correct`.
"""

import math
from typing import Final

from companion.core.units import wrap_pi
from companion.estimation.sensor_timeout import SensorTimeoutMonitor

DRAW_S: Final = 2.0
BIAS_S: Final = 15.0
MAX_BIAS_RAD_S: Final = 0.2
COMPASS_TIME_S: Final = 0.15
RESTART_S: Final = 2.0  # after a longer gap the filter restarts at the reading
_TOGETHER_S: Final = 0.1
_STUCK_S: Final = 1.0
# limit of the change between two compass readings: constant part, and per second
_LEAP_RAD, _LEAP_RAD_S = 0.2, 3.0
_JERK_RAD_S, _JERK_RAD_S2 = 0.15, 3.0  # the same for the gyro
_ODD: Final = 0.5  # share of outliers in the last second that rejects the compass
_EVEN: Final = 0.1  # share below which it is accepted again
_STUCK_RAD: Final = 0.1  # turned by the gyro while the compass repeats its value,
_STUCK_RAD_S: Final = 0.03  # plus this per second for an unknown gyro bias
_SIGMA_RAD: Final = 0.02  # with a compass
_AGREES_RAD: Final = 0.2  # a rejected compass is accepted again once it agrees this well,
_STEADY_RAD: Final = 0.1  # or, while the boat is idle, follows the gyro this well,
_AGREES_S: Final = 20.0  # for this long
_GYRO_WALK_RAD_S: Final = 0.002  # growth of the heading uncertainty on the gyro alone,
_BLIND_WALK_RAD_S: Final = 0.2  # and on the yaw model alone
_GIVE_IN_RAD_S: Final = 0.005  # how fast the gate opens for a compass that keeps disagreeing,
_GIVE_IN_IDLE_RAD_S: Final = 0.1  # and while the boat is idle


class HeadingFilter:
    """Heading in rad (−π..π) and rate in rad/s, both clockwise, at the time of the latest reading.

    time_s: of that reading. compass_s: of the latest accepted compass reading. sigma_rad: standard deviation.
    is_off: the compass disagrees with the gyro. resets: how often such a compass was accepted in the end.
    is_idle: the boat is not under way; set by the owner. corrected_rad: sum of all compass corrections.
    starts: how often the heading was restarted.
    """

    def __init__(self, gate_rad: float) -> None:
        """gate_rad: largest accepted difference of compass and gyro."""
        self.gate_rad = gate_rad
        self.time_s = self.compass_s = -math.inf
        self.heading_rad = self.yaw_rate_rad_s = self.bias_rad_s = 0.0
        self.sigma_rad = _SIGMA_RAD
        self.has_gyro = False
        self.is_off = False
        self.is_idle = True
        self.resets = self.starts = 0
        self.corrected_rad = 0.0
        self._is_compass_rejected = False  # by the consistency monitor
        self._agreed_rad = self._agrees_s = 0.0
        self._compass = SensorTimeoutMonitor(_LEAP_RAD, _LEAP_RAD_S, _STUCK_S)
        self._gyro = SensorTimeoutMonitor(_JERK_RAD_S, _JERK_RAD_S2, 0.5 * _STUCK_S)
        self._outlier_share = 0.0
        self._turned_rad = 0.0  # by the gyro, since the last new compass value
        self._rate_rad_s = 0.0
        self._sum_rad = 0.0
        self._count = self._blocks = 0
        self._block_s = -math.inf
        self._off_since_s = math.inf

    def update(
        self, time_s: float, heading_rad: float, yaw_rate_rad_s: float | None, extra_turn_rad: float = 0.0
    ) -> None:
        """Process a reading later than the last.

        heading_rad: NaN for a gyro reading only. yaw_rate_rad_s: None without a gyro. extra_turn_rad: turn
        during a long gap beyond the mean of the rates before and after it.
        """
        dt = time_s - self.time_s
        self.time_s = time_s
        if yaw_rate_rad_s is not None:
            self._gyro.update(yaw_rate_rad_s, time_s)
            if not self._gyro.is_good and not math.isnan(heading_rad):
                yaw_rate_rad_s = None
        if dt > RESTART_S and not math.isnan(heading_rad):
            self.start(time_s, heading_rad, yaw_rate_rad_s)
        elif yaw_rate_rad_s is None:
            self._update_without_gyro(time_s, dt, heading_rad, extra_turn_rad)
        else:
            self._update_with_gyro(time_s, dt, heading_rad, yaw_rate_rad_s, extra_turn_rad)

    def start(self, time_s: float, heading_rad: float, yaw_rate_rad_s: float | None) -> None:
        """Start or restart at a reading."""
        self.time_s = time_s
        self.heading_rad = wrap_pi(heading_rad)
        self.starts += 1
        self._is_compass_rejected = False
        self.has_gyro = yaw_rate_rad_s is not None
        self._rate_rad_s = yaw_rate_rad_s or 0.0
        self.yaw_rate_rad_s = self._rate_rad_s - self.bias_rad_s if self.has_gyro else 0.0
        self._compass.update(heading_rad, time_s)
        self._turned_rad = self._sum_rad = self._outlier_share = 0.0
        self._count = self._blocks = 0
        self._accept_compass(time_s)

    def _accept_compass(self, time_s: float) -> None:
        self.compass_s = self._block_s = time_s
        self.sigma_rad = _SIGMA_RAD
        self._off_since_s = math.inf
        self.is_off = False

    def _update_without_gyro(
        self, time_s: float, dt: float, heading_rad: float, extra_turn_rad: float
    ) -> None:
        self.has_gyro = False
        predicted = self.heading_rad + self.yaw_rate_rad_s * dt + extra_turn_rad
        residual = wrap_pi(heading_rad - predicted)
        fade = math.exp(-dt / COMPASS_TIME_S)
        self.heading_rad = wrap_pi(predicted + (1.0 - fade * fade) * residual)
        self.yaw_rate_rad_s += (1.0 - fade) * (1.0 - fade) / dt * residual
        self._compass.update(heading_rad, time_s)
        if self._compass.is_good:
            self._outlier_share = 0.0
            self._accept_compass(time_s)

    def _update_with_gyro(
        self, time_s: float, dt: float, heading_rad: float, yaw_rate_rad_s: float, extra_turn_rad: float
    ) -> None:
        self.has_gyro = True
        turned = (0.5 * (self._rate_rad_s + yaw_rate_rad_s) - self.bias_rad_s) * dt + extra_turn_rad
        self._rate_rad_s = yaw_rate_rad_s
        self.yaw_rate_rad_s = yaw_rate_rad_s - self.bias_rad_s
        self.heading_rad = wrap_pi(self.heading_rad + turned)
        self.sigma_rad += _GYRO_WALK_RAD_S * dt
        if math.isnan(heading_rad):
            return
        compass = self._compass
        if compass.update(heading_rad, time_s):
            self._turned_rad += turned
            if abs(self._turned_rad) > _STUCK_RAD + _STUCK_RAD_S * compass.run_s:
                compass.mark_faulty()
        else:
            self._turned_rad = 0.0
        if not compass.is_good:
            self._sum_rad, self._count = 0.0, 0
            return
        self._sum_rad += wrap_pi(heading_rad - self.heading_rad)
        self._count += 1
        if time_s - self._block_s >= _TOGETHER_S:
            self._update_block(time_s)

    def _update_block(self, time_s: float) -> None:
        """Correct the heading by the mean compass residual since the last block."""
        residual, span = self._sum_rad / self._count, min(time_s - self._block_s, RESTART_S)
        self._sum_rad, self._count = 0.0, 0
        self._block_s = time_s
        if self._is_compass_rejected and not self._is_trusted_again(residual, span):
            return
        is_outlier = self._blocks > 0 and not abs(residual) <= self._open_gate_rad(time_s)
        self._outlier_share += min(span, 1.0) * ((1.0 if is_outlier else 0.0) - self._outlier_share)
        if is_outlier and self._off_since_s == math.inf:
            self._off_since_s = time_s
        if is_outlier or (self.is_off and self._outlier_share > _EVEN):
            self.is_off = self.is_off or self._outlier_share > _ODD
            return
        if self.is_off and abs(residual) > self.gate_rad:
            self._jump(residual)
            residual = 0.0
        self._blocks += 1
        share = 1.0 - math.exp(-span / DRAW_S)
        if self._blocks * share < 1.0:  # equal weights at the start
            self._correct(residual / (self._blocks + 1))
        else:
            self._correct(share * residual)
            bias = self.bias_rad_s - share * residual / BIAS_S
            self.bias_rad_s = min(max(bias, -MAX_BIAS_RAD_S), MAX_BIAS_RAD_S)
        self._accept_compass(time_s)

    def _jump(self, residual_rad: float) -> None:
        """Accept the compass after all: set the heading to it."""
        self.resets += 1
        self.starts += 1
        self.heading_rad = wrap_pi(self.heading_rad + residual_rad)

    def _correct(self, by_rad: float) -> None:
        self.heading_rad = wrap_pi(self.heading_rad + by_rad)
        self.corrected_rad += by_rad

    def reject_offset(self, gap_rad: float, bias_rad_s: float) -> None:
        """Reject the compass: correct the heading by gap_rad and set the gyro bias."""
        self._is_compass_rejected = self.is_off = True
        self.heading_rad = wrap_pi(self.heading_rad + gap_rad)
        self.bias_rad_s = bias_rad_s
        self._outlier_share = 1.0
        self._agreed_rad = self._agrees_s = 0.0

    def _is_trusted_again(self, residual_rad: float, span_s: float) -> bool:
        """Whether a rejected compass has agreed for long enough."""
        if abs(wrap_pi(residual_rad - self._agreed_rad)) > _STEADY_RAD:
            self._agreed_rad, self._agrees_s = residual_rad, 0.0
        if self.is_idle or abs(residual_rad) < _AGREES_RAD:
            self._agrees_s += span_s
        else:
            self._agrees_s = 0.0
        self._is_compass_rejected = self._agrees_s < _AGREES_S
        if not self._is_compass_rejected and abs(residual_rad) > self.gate_rad:
            self._jump(residual_rad)
        return not self._is_compass_rejected

    def _open_gate_rad(self, time_s: float) -> float:
        """The gate; it opens while the compass disagrees, as the gyro becomes less reliable."""
        waited_s = time_s - self._off_since_s
        if waited_s <= 0.0:
            return self.gate_rad
        return self.gate_rad + waited_s * (_GIVE_IN_IDLE_RAD_S if self.is_idle else _GIVE_IN_RAD_S)

    def correct(self, residual_rad: float, time_constant_s: float, dt_s: float, sigma_rad: float) -> None:
        """Correct the heading by an independent residual with standard deviation sigma_rad."""
        share = 1.0 - math.exp(-dt_s / time_constant_s)
        self.heading_rad = wrap_pi(self.heading_rad + share * residual_rad)
        self.sigma_rad = max(self.sigma_rad * (1.0 - share), sigma_rad)

    def add_process_noise(self, dt_s: float) -> None:
        """Grow the uncertainty over dt_s without a reading."""
        self.has_gyro = False
        self.sigma_rad += _BLIND_WALK_RAD_S * dt_s
