"""Values that travel through the boat, from estimation to motors. All frozen, all SI.

They are made anew every tick, so they are msgspec structs: frozen dataclasses would cost ten times as much
to make.
"""

from msgspec import Struct

from companion.geo import Point


class NavState(Struct, frozen=True, gc=False):
    """The boat's best knowledge of its own motion, in the local frame.

    heading_rad: where the bow points, 0 = north, clockwise positive, in [−π, π).
    north_m_s, east_m_s: over ground. position_age_s and heading_age_s: how old the last accepted
    measurement is; infinite before the first.
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

    @property
    def point(self) -> Point:
        """Where the boat is."""
        return Point(self.north_m, self.east_m)


class Demand(Struct, frozen=True, gc=False):
    """What guidance asks of the control loops.

    cross_track_m: how far the boat is to the right of its line, for telemetry and metrics only.
    distance_m: to the end of the leg or the station.
    """

    heading_rad: float
    speed_m_s: float
    cross_track_m: float = 0.0
    distance_m: float = 0.0


class PidOutput(Struct, frozen=True, gc=False):
    """One evaluation of a PID: its terms, their limited sum, and whether the limit was met."""

    p: float
    i: float
    d: float
    total: float
    saturated: bool


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
