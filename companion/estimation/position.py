"""Position and residual velocity: a Kalman filter of three states per axis.

Between fixes the position is propagated by thrust, compass and current (`current.py`). The model error e is a
first-order Gauss-Markov process with a time constant of seconds. The receiver error is white noise plus a
drift w with a time constant of a minute. A position measures p + w, a Doppler velocity measures e:

    ṗ = carried + e        ė = −e/T_e + noise        ẇ = −w/T_w + noise

(Y. Bar-Shalom, X. R. Li, T. Kirubarajan, *Estimation with Applications to Tracking and Navigation*, 2001:
section 8.2, coloured process noise; section 8.3, autocorrelated measurement noise by augmenting the state.)
North and east have the same noise and share one covariance; p, e and w are north + i east. The process noise
is adapted to the velocity innovations (section 11.4). The state is at the time of the latest fix.
"""

import math
from typing import Final

UNMODELLED_S: Final = 3.0  # T_e
_GATE: Final = 25.0  # squared innovation over variance: 5 σ
_STRAY_GATE: Final = 9.0  # for the accumulated drift: 3 σ
_ADAPT: Final = 0.05  # of the process noise's logarithm, per fix
_LEAST, _FIRST, _MOST = 0.01, 0.05, 0.5  # limits and initial value of the deviation of e, of cruise speed


class PositionFilter:
    """position_m, unmodelled_m_s (e) and wander_m (w) at time_s."""

    def __init__(self, cruise_m_s: float, wander_s: float, wander_share: float) -> None:
        """cruise_m_s scales the process noise; wander_s is T_w.

        wander_share: the share of the receiver's deviation that drifts; the rest is white.
        """
        self._wander_s, self._wander_share = wander_s, wander_share
        scale = 2.0 * cruise_m_s * cruise_m_s / UNMODELLED_S
        self._least_q, self._q, self._most_q = scale * _LEAST**2, scale * _FIRST**2, scale * _MOST**2
        self.time_s = -math.inf
        self.position_m = self.unmodelled_m_s = self.wander_m = 0j
        self._pp = self._pe = self._pw = self._ee = self._ew = self._ww = 0.0

    @property
    def noise_m2_s3(self) -> float:
        """Process noise of the model error."""
        return self._q

    def start(self, time_s: float, at: complex, sigma_m: float, sigma_m_s: float) -> None:
        """Start here. sigma_m: deviation of the fix per axis; sigma_m_s: of the model error."""
        self.time_s = time_s
        self.position_m, self.unmodelled_m_s, self.wander_m = at, 0j, 0j
        wander = (self._wander_share * sigma_m) ** 2
        self._pp, self._pw, self._ww = sigma_m * sigma_m, -wander, wander
        self._ee, self._pe, self._ew = sigma_m_s * sigma_m_s, 0.0, 0.0

    def predict(self, time_s: float, carried_m: complex, sigma_m: float, process_noise_m2_s3: float) -> None:
        """Advance to time_s over the modelled displacement carried_m.

        sigma_m: of the receiver. process_noise_m2_s3: in addition to the learned noise, as in a turn.
        """
        dt = time_s - self.time_s
        self.time_s = time_s
        f = math.exp(-dt / UNMODELLED_S)
        g = UNMODELLED_S * (1.0 - f)
        k = math.exp(-dt / self._wander_s)
        self.position_m += carried_m + g * self.unmodelled_m_s
        self.unmodelled_m_s *= f
        self.wander_m *= k
        pe, ee, ew = self._pe, self._ee, self._ew
        q = (self._q + process_noise_m2_s3) * g
        self._pp += g * (2.0 * pe + g * ee) + q * g * g / 3.0
        self._pe = f * (pe + g * ee) + 0.5 * q * g
        self._pw = k * (self._pw + g * ew)
        self._ee = f * f * ee + q
        self._ew = f * k * ew
        self._ww = k * k * self._ww + (self._wander_share * sigma_m) ** 2 * (1.0 - k * k)

    def inflate(self, variance_m2: float) -> None:
        """Add to the position variance."""
        self._pp += variance_m2

    def update_velocity(self, innovation_m_s: complex, variance: float, is_trusted: bool) -> bool:
        """Update with a velocity innovation. Returns False if it was rejected.

        is_trusted: the receiver is known to be right; a large innovation is then a model error.
        """
        total = self._ee + variance
        error_ratio = _norm_squared(innovation_m_s) / total
        if error_ratio > 2.0 * _GATE:
            if not is_trusted:
                return False
            self._ee += _norm_squared(innovation_m_s)
            total = self._ee + variance
        self.adapt(0.5 * error_ratio)
        kp, ke, kw = self._pe / total, self._ee / total, self._ew / total
        self._blend(kp, ke, kw, innovation_m_s)
        pe, ee, ew = self._pe, self._ee, self._ew
        self._pp -= kp * pe
        self._pe -= kp * ee
        self._pw -= kp * ew
        self._ee -= ke * ee
        self._ew -= ke * ew
        self._ww -= kw * ew
        return True

    def fits(self, at: complex, sigma_m: float, drift_m2: float) -> bool:
        """Whether a position is within the gate. drift_m2: see `inflate`."""
        innovation = at - self.position_m - self.wander_m
        return _norm_squared(innovation) <= 2.0 * _GATE * self._variance(sigma_m) + _STRAY_GATE * drift_m2

    def update_position(self, at: complex, sigma_m: float) -> None:
        """Update with a position."""
        total = self._variance(sigma_m)
        innovation = at - self.position_m - self.wander_m
        cp, ce, cw = self._pp + self._pw, self._pe + self._ew, self._pw + self._ww
        kp, ke, kw = cp / total, ce / total, cw / total
        self._blend(kp, ke, kw, innovation)
        self._pp -= kp * cp
        self._pe -= kp * ce
        self._pw -= kp * cw
        self._ee -= ke * ce
        self._ew -= ke * cw
        self._ww -= kw * cw

    def adapt(self, error_ratio: float) -> None:
        """Adapt the process noise. error_ratio: normalised squared innovation, 1 on average."""
        wanted = self._q * (1.0 + _ADAPT * (min(error_ratio, 4.0) - 1.0))
        self._q = min(max(wanted, self._least_q), self._most_q)

    @property
    def variance_m2(self) -> float:
        """Variance of the position, per axis."""
        return self._pp

    @property
    def unmodelled_variance(self) -> float:
        """Variance of unmodelled_m_s, per axis."""
        return self._ee

    def _variance(self, sigma_m: float) -> float:
        white = (1.0 - self._wander_share * self._wander_share) * sigma_m * sigma_m
        return self._pp + 2.0 * self._pw + self._ww + white

    def _blend(self, kp: float, ke: float, kw: float, innovation: complex) -> None:
        self.position_m += kp * innovation
        self.unmodelled_m_s += ke * innovation
        self.wander_m += kw * innovation


def _norm_squared(vector: complex) -> float:
    return vector.real * vector.real + vector.imag * vector.imag
