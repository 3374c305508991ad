"""Values passed through the boat from estimation to motors. All frozen, all SI.

They are created every tick and therefore msgspec structs: dataclasses cost ten times as much to create.
"""

import math
from enum import Enum, IntFlag
from typing import Final

from msgspec import Struct
from msgspec.structs import replace

from companion.core.geo import Point
from companion.core.units import wrap_pi


class EstimateFault(IntFlag):
    """Faults of the estimate; 0: none."""

    GNSS_LOST = 1  # no fix, or no data
    GNSS_FROZEN = 2  # constant position while the boat moves
    GNSS_JUMPING = 4  # fixes outside the gate
    COMPASS_LOST = 8  # no data
    COMPASS_OFF = 16  # disagrees with the course made good
    POSITION_LOST = 32  # dead reckoning has lasted too long
    HEADING_LOST = 64  # no source of heading
    GNSS_LATE = 128  # fixes have an unreported latency, which is compensated
    COMPASS_LATE = 256  # the same for compass and gyro, or infrequent readings: the yaw model bridges them
    GYRO_LOST = 512  # no rate, a constant one, or erratic ones, while headings are measured
    GYRO_OFF = 1024  # a larger bias than its data sheet allows, which is compensated
    COMPASS_FROZEN = 2048  # constant heading while the boat turns
    GNSS_INTERMITTENT = 4096  # silent time and again, as by a loose contact
    COMPASS_INTERMITTENT = 8192  # the same for the heading sensor
    GNSS_NOISY = 16384  # fixes scatter far more than its class does, as when it is jammed


class NavState(Struct, frozen=True, gc=False):
    """The navigation state in the local frame.

    heading_rad: 0 = north, clockwise positive, in [−π, π). north_m_s, east_m_s, surge_m_s, sway_m_s: over
    ground. position_age_s and heading_age_s: age of the last accepted measurement, infinite before the first;
    during dead reckoning the position's age is limited to the receiver's time-out. current_north_m_s,
    current_east_m_s: current over ground, leeway included. position_sigma_m: standard deviation, per axis.
    faults: bits of EstimateFault, as a plain integer for speed. gyro_rad_s: the gyro's latest rate less its
    bias, not smoothed; None without a gyro. yaw_rate_rad_s: the same rate, smoothed by the yaw model.
    wave_rad, wave_rad_s: what waves add to heading and yaw rate. restraint: from 0 to 1 in
    waves or with late readings, where the loops slow down.
    """

    time_s: float
    north_m: float
    east_m: float
    heading_rad: float
    yaw_rate_rad_s: float
    north_m_s: float
    east_m_s: float
    surge_m_s: float
    sway_m_s: float
    position_age_s: float
    heading_age_s: float
    current_north_m_s: float = 0.0
    current_east_m_s: float = 0.0
    position_sigma_m: float = 0.0
    faults: int = 0
    gyro_rad_s: float | None = None
    wave_rad: float = 0.0
    wave_rad_s: float = 0.0
    restraint: float = 0.0
    yaw_accel_rad_s2: float = 0.0
    yaw_damping_per_s: float = 0.0

    @property
    def without_waves(self) -> "NavState":
        """The state that the loops close on: they do not answer waves."""
        if self.wave_rad == 0.0:
            return self
        return replace(
            self,
            heading_rad=wrap_pi(self.heading_rad - self.wave_rad),
            yaw_rate_rad_s=self.yaw_rate_rad_s - self.wave_rad_s,
            wave_rad=0.0,
            wave_rad_s=0.0,
        )

    @property
    def measured_yaw_rate_rad_s(self) -> float:
        """The gyro's rate, independent of the yaw model; without a gyro, the estimate."""
        return self.yaw_rate_rad_s if self.gyro_rad_s is None else self.gyro_rad_s

    @property
    def point(self) -> Point:
        return Point(self.north_m, self.east_m)

    @property
    def water_speed_m_s(self) -> float:
        """Speed ahead through the water."""
        return self.surge_m_s - self.current_along_m_s(self.heading_rad)

    def current_along_m_s(self, course_rad: float) -> float:
        """Component of the current along a course, negative against it."""
        return self.current_north_m_s * math.cos(course_rad) + self.current_east_m_s * math.sin(course_rad)


class Demand(Struct, frozen=True, gc=False):
    """Set-points of the control loops.

    cross_track_m: distance to the right of the line, for telemetry and metrics only. distance_m: to the end
    of the leg or the station. yaw_rate_rad_s: rate of heading_rad, clockwise positive, as feed-forward.
    brakes: False: the boat slows down by less throttle only, no propeller turns astern.
    """

    heading_rad: float
    speed_m_s: float
    cross_track_m: float = 0.0
    distance_m: float = 0.0
    yaw_rate_rad_s: float = 0.0
    brakes: bool = True


class PidOutput(Struct, frozen=True, gc=False):
    """One evaluation of a PID: terms, feed-forward (ff), their limited sum, and whether it was limited."""

    p: float
    i: float
    d: float
    total: float
    saturated: bool
    ff: float = 0.0


class Thrust(Struct, frozen=True, gc=False):
    """Shares of full drive per side and of full rudder, −1..1, before the gate. A positive rudder turns the
    bow to starboard under way ahead. A boat with one motor has equal sides.
    """

    left: float
    right: float
    rudder: float = 0.0


class MotorCommand(Struct, frozen=True, gc=False):
    """Output of the gate to motors and rudder, as in Thrust."""

    left: float
    right: float
    reason: str = ""  # why the gate stopped the motors; empty while they run
    rudder: float = 0.0


STOPPED = MotorCommand(0.0, 0.0)


class MotorState(Enum):
    """How a motor answers its command."""

    HEALTHY = "healthy"
    FAILED = "failed"  # gives no thrust
    REVERSED = "reversed"  # turns the wrong way


class MotorStates(Struct, frozen=True, gc=False):
    """The state of both motors."""

    left: MotorState = MotorState.HEALTHY
    right: MotorState = MotorState.HEALTHY

    @property
    def has_failed(self) -> bool:
        """Whether a motor gives no thrust."""
        return self.left is MotorState.FAILED or self.right is MotorState.FAILED

    @property
    def has_reversed(self) -> bool:
        """Whether a motor turns the wrong way."""
        return self.left is MotorState.REVERSED or self.right is MotorState.REVERSED


HEALTHY_MOTORS = MotorStates()


FAULT_TEXTS: Final[tuple[tuple[EstimateFault, str], ...]] = (
    (EstimateFault.POSITION_LOST, "Position lost"),
    (EstimateFault.HEADING_LOST, "Heading lost"),
    (EstimateFault.GNSS_INTERMITTENT, "GPS intermittent: dead reckoning"),
    (EstimateFault.GNSS_LOST, "GPS lost: dead reckoning"),
    (EstimateFault.GNSS_FROZEN, "GPS frozen: dead reckoning"),
    (EstimateFault.GNSS_NOISY, "GPS noisy (jammed?): given less weight"),
    (EstimateFault.GNSS_JUMPING, "GPS jumping: rejected"),
    (EstimateFault.COMPASS_INTERMITTENT, "Compass intermittent: using yaw model"),
    (EstimateFault.COMPASS_LOST, "Compass lost: using gyro and course"),
    (EstimateFault.COMPASS_FROZEN, "Compass frozen: using gyro and course"),
    (EstimateFault.COMPASS_OFF, "Compass off: using gyro and course"),
    (EstimateFault.GNSS_LATE, "GPS late: compensated"),
    (EstimateFault.COMPASS_LATE, "Compass late: using yaw model"),
    (EstimateFault.GYRO_LOST, "Gyro lost: using yaw model"),
    (EstimateFault.GYRO_OFF, "Gyro off: bias compensated"),
)
"""Worst first; each fits one STATUSTEXT with room for a prefix."""

# Plain numbers: an IntFlag's arithmetic costs microseconds
GNSS_FAULTS: Final = int(
    EstimateFault.GNSS_LOST
    | EstimateFault.GNSS_FROZEN
    | EstimateFault.GNSS_JUMPING
    | EstimateFault.GNSS_LATE
    | EstimateFault.GNSS_INTERMITTENT
    | EstimateFault.GNSS_NOISY
)
COMPASS_FAULTS: Final = int(
    EstimateFault.COMPASS_LOST
    | EstimateFault.COMPASS_FROZEN
    | EstimateFault.COMPASS_OFF
    | EstimateFault.COMPASS_LATE
    | EstimateFault.COMPASS_INTERMITTENT
)
_POSITION_LOST: Final = int(EstimateFault.POSITION_LOST)
_HEADING_LOST: Final = int(EstimateFault.HEADING_LOST)


def fault_texts(faults: int) -> list[str]:
    """A line for each bit of EstimateFault, worst first; empty without a fault."""
    return [text for fault, text in FAULT_TEXTS if faults & fault] if faults else []


def lacks_position(nav: NavState, timeout_s: float) -> bool:
    """Whether the position is too old or uncertain; its age is held while the estimator reckons on."""
    return bool(nav.faults & _POSITION_LOST) or not nav.position_age_s <= timeout_s


def lacks_heading(nav: NavState, timeout_s: float) -> bool:
    """Whether there is no heading. The course over ground alone is not one: it cannot hold a boat on a
    heading.
    """
    return bool(nav.faults & _HEADING_LOST) or not nav.heading_age_s <= timeout_s
