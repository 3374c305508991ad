"""The helm: closes the heading and speed loops, or lets the operator's hand through."""

from companion.config.boat_config import BoatConfig
from companion.control.allocation import Effort, allocate, by_hand
from companion.control.heading import gain_schedule, heading_effort, learned_gains
from companion.control.pid import Pid
from companion.control.single_thruster import SingleThrusterController
from companion.control.speed import speed_effort
from companion.core.intent import Drive, Stop
from companion.core.state import HEALTHY_MOTORS, Demand, MotorStates, NavState, PidOutput, Thrust

# What restraint leaves of the gains: the heading loop at 0.63 of its bandwidth, so that what the wave filter
# lets through, and what is late, drives the motors less. Zigzags of seeds 1302 and 1305
_RESTRAINED = 0.4
_SPEED_RESTRAINED = 0.3
_NO_THRUST = Thrust(0.0, 0.0)


class Helm:
    """Turns what guidance asks into thrust.

    heading_pid and speed_pid are the last evaluations, for telemetry; None while the loop is open. Loops that
    are not closed forget what they have learned, so none starts with an integral from another situation.
    """

    def __init__(self) -> None:
        self._heading = Pid()
        self._speed = Pid()
        self._single = SingleThrusterController()
        self.heading_pid: PidOutput | None = None
        self.speed_pid: PidOutput | None = None

    def reset(self) -> None:
        """Open both loops and forget their integrals. The owner calls this while the motors are stopped."""
        self._heading.reset()
        self._speed.reset()
        self.heading_pid = self.speed_pid = None

    def update(
        self,
        demand: Demand | Drive | Stop,
        nav: NavState | None,
        config: BoatConfig,
        dt_s: float,
        motors: MotorStates = HEALTHY_MOTORS,
    ) -> Thrust:
        """Thrust per side for this tick. A Demand without a NavState gives none. Drive runs a failed motor
        too: the operator and the motor check try it.
        """
        if isinstance(demand, Demand) and nav is not None and not motors.has_failed:
            return self._close_loops(demand, nav, config, dt_s)
        if self.heading_pid is not None:
            self.reset()
        if isinstance(demand, Demand) and nav is not None:
            surge, yaw = self._single.update(demand, nav, motors, config.speed.max_throttle, dt_s)
            return allocate(Effort(surge, yaw), config, motors)
        return by_hand(demand.throttle, demand.steering, config) if isinstance(demand, Drive) else _NO_THRUST

    def _close_loops(self, demand: Demand, nav: NavState, config: BoatConfig, dt_s: float) -> Thrust:
        turn, restraint = demand.yaw_rate_rad_s, nav.restraint
        current_along = nav.current_along_m_s(nav.heading_rad)
        schedule = gain_schedule(
            nav.surge_m_s - current_along, config.speed.cruise_m_s, config.heading.slow_gain
        )
        stiffness, damping = learned_gains(nav.yaw_accel_rad_s2, nav.yaw_damping_per_s, config.handling)
        heading = heading_effort(
            self._heading,
            demand.heading_rad,
            nav.heading_rad,
            nav.yaw_rate_rad_s,
            config.heading,
            dt_s,
            turn,
            turn / config.handling.turn_rate_rad_s if turn else 0.0,
            stiffness * schedule * (1.0 + (_RESTRAINED - 1.0) * restraint),
            damping,
        )
        # Two motors that steer leave the rest to the speed loop; a rudder leaves all.
        steering = abs(heading.total) if config.drive.has_pair else 0.0
        least = -1.0 if demand.brakes else steering
        speed = speed_effort(
            self._speed,
            demand.speed_m_s,
            nav.surge_m_s,
            config.speed,
            dt_s,
            1.0 - steering,
            current_along,
            least,
            1.0 + (_SPEED_RESTRAINED - 1.0) * restraint,
        )
        self.heading_pid, self.speed_pid = heading, speed
        return allocate(Effort(speed.total, heading.total, nav.surge_m_s - current_along), config)
