"""A mission as the vehicle sails it: one step per item, in the order of the MAVLink sequence.

Sequence 0 is home by ArduPilot's convention and is never sailed. Services translate MAVLink items into these.
"""

from dataclasses import dataclass

from companion.geo import LatLon


@dataclass(frozen=True, slots=True)
class Home:
    """Sequence 0: where the planner thought home was."""


@dataclass(frozen=True, slots=True)
class Waypoint:
    """Sail to a position; stay there hold_s seconds, infinite for ever."""

    position: LatLon
    hold_s: float = 0.0
    radius_m: float = 0.0  # 0: the boat's own waypoint radius


@dataclass(frozen=True, slots=True)
class Wait:
    """Keep station for a time, where the boat is."""

    hold_s: float


@dataclass(frozen=True, slots=True)
class SetSpeed:
    """Sail the following legs at this speed over ground; 0 goes back to cruise speed."""

    speed_m_s: float


@dataclass(frozen=True, slots=True)
class Jump:
    """Go on at sequence `target`, `times` times in all; −1 for ever."""

    target: int
    times: int


@dataclass(frozen=True, slots=True)
class ReturnHome:
    """Leave the mission for RTL."""


Step = Home | Waypoint | Wait | SetSpeed | Jump | ReturnHome
Mission = tuple[Step, ...]
