"""A PID controller as pure arithmetic: Gc(s) = Kp (1 + 1/(Ti s) + Td s), the paper's Eq. 4,
in the parallel form: Ki = Kp / Ti and Kd = Kp Td.

Three things differ from the textbook. The derivative comes from a *measured* rate that the caller hands in,
never from a difference of errors: a wrapped angle's difference kicks at ±π. The integral is kept in output
units, so a gain changed under way moves nothing at once. And it winds up no further than the authority that
P and D leave to it (conditional anti-windup); what it has learned already is not taken away again.
"""

import math

from companion.core.state import PidOutput
from companion.core.units import clamp


class Pid:
    """The only state is the integral, in units of the output."""

    def __init__(self) -> None:
        self.integral = 0.0

    def reset(self) -> None:
        """Forget the integral."""
        self.integral = 0.0

    def update(
        self,
        kp: float,
        ki: float,
        kd: float,
        error: float,
        error_rate: float,
        dt_s: float,
        low: float,
        high: float,
        feed_forward: float = 0.0,
    ) -> PidOutput:
        """Advance by dt_s and evaluate.

        error is demand minus measurement, error_rate its time derivative with the demand held still (the
        measured rate with its sign changed). The sum of the terms is limited to [low, high], which must
        contain 0; the total is that and feed_forward.
        An error that is not finite makes the total NaN and leaves no trace in the integral.
        """
        p = kp * error
        d = kd * error_rate
        integral = self.integral if ki else 0.0
        step = ki * error * dt_s
        if step > 0.0:
            integral = max(integral, min(integral + step, max(high - p - d, 0.0), high))
        elif step < 0.0:
            integral = min(integral, max(integral + step, min(low - p - d, 0.0), low))
        wanted = p + integral + d
        if not math.isfinite(wanted):
            return PidOutput(p, self.integral, d, math.nan, True, feed_forward)
        self.integral = integral
        total = clamp(wanted, low, high)
        return PidOutput(p, integral, d, feed_forward + total, total != wanted, feed_forward)
