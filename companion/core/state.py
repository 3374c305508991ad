"""Values that travel through the boat, from estimation to motors. All frozen, all SI.

They are made anew every tick, so they are msgspec structs: frozen dataclasses would cost ten times as much
to make.
"""

import math
from enum import Enum, IntFlag

from msgspec import Struct

from companion.core.geo import Point


class EstimateFault(IntFlag):
    """What is wrong with what the estimate is made of; 0 is nothing."""

    GNSS_LOST = 1  # no fix, or silent
    GNSS_FROZEN = 2  # the same position again and again while the boat moves
    GNSS_JUMPING = 4  # fixes far from where the boat can be
    COMPASS_LOST = 8  # silent, or the same reading again and again
    COMPASS_OFF = 16  # disagrees with the course made good
    POSITION_LOST = 32  # dead reckoning has gone on for too long to sail by
    HEADING_LOST = 64  # nothing says any more where the bow points
    GNSS_LATE = 128  # fixes tell of some time ago, whatever their stamps say; it is reckoned with
    COMPASS_LATE = 256  # the same of compass and gyro, or readings come seldom: steering stands in between


class NavState(Struct, frozen=True, gc=False):
    """The boat's best knowledge of its own motion, in the local frame.

    heading_rad: where the bow points, 0 = north, clockwise positive, in [−π, π).
    north_m_s, east_m_s, surge_m_s, sway_m_s: over ground. position_age_s and heading_age_s: how old the last
    accepted measurement is, infinite before the first; while dead reckoning stands in for the receiver, the
    position grows no older than the receiver's time-out. current_north_m_s, current_east_m_s: the current's
    velocity over ground, leeway included. position_sigma_m: one standard deviation, per axis. faults:
    bits of EstimateFault, a plain integer because it is made anew every tick.
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

    @property
    def point(self) -> Point:
        """Where the boat is."""
        return Point(self.north_m, self.east_m)

    def current_along_m_s(self, course_rad: float) -> float:
        """How fast water and wind carry the boat that way, negative against it."""
        return self.current_north_m_s * math.cos(course_rad) + self.current_east_m_s * math.sin(course_rad)


class Demand(Struct, frozen=True, gc=False):
    """What guidance asks of the control loops.

    cross_track_m: how far the boat is to the right of its line, for telemetry and metrics only.
    distance_m: to the end of the leg or the station. yaw_rate_rad_s: how fast heading_rad is about to turn,
    clockwise positive, for the heading loop to go along with.
    """

    heading_rad: float
    speed_m_s: float
    cross_track_m: float = 0.0
    distance_m: float = 0.0
    yaw_rate_rad_s: float = 0.0


class PidOutput(Struct, frozen=True, gc=False):
    """One evaluation of a PID: its terms, feed-forward (ff), their limited sum, whether the limit was met."""

    p: float
    i: float
    d: float
    total: float
    saturated: bool
    ff: float = 0.0


class Thrust(Struct, frozen=True, gc=False):
    """Shares of full drive per side, −1..1, before the gate."""

    left: float
    right: float


class MotorCommand(Struct, frozen=True, gc=False):
    """What the gate lets through to the motors, −1..1 per side."""

    left: float
    right: float
    reason: str = ""  # why the gate stopped the motors; empty while they run


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
