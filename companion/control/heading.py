"""The heading loop: a PID from heading error to a share of full differential thrust."""

from companion.config import Heading
from companion.control.pid import Pid
from companion.state import PidOutput
from companion.units import clamp, wrap_pi


class HeadingControl:
    """Turns the bow toward a heading, by the shorter way round."""

    __slots__ = ("_pid",)

    def __init__(self) -> None:
        self._pid = Pid()

    def reset(self) -> None:
        """Forget the integral."""
        self._pid.reset()

    def update(
        self,
        demand_rad: float,
        heading_rad: float,
        yaw_rate_rad_s: float,
        setting: Heading,
        dt_s: float,
        demand_rate_rad_s: float = 0.0,
        feed_forward: float = 0.0,
    ) -> PidOutput:
        """Steering share, −max_steering..max_steering, positive to starboard.

        Angles are from north, clockwise; yaw_rate_rad_s is the measured rate, clockwise positive.
        demand_rate_rad_s: how fast the demand itself turns, which the derivative then does not brake.
        feed_forward: the steering that such a turn takes.
        """
        limit = setting.max_steering
        base = clamp(feed_forward, -limit, limit)
        return self._pid.update(
            setting.kp,
            setting.ki,
            setting.kd,
            wrap_pi(demand_rad - heading_rad),
            demand_rate_rad_s - yaw_rate_rad_s,
            dt_s,
            -limit - base,
            limit - base,
            base,
        )
