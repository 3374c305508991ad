"""A mission as the vehicle sails it: one step per item, in the order of the MAVLink sequence.

Sequence 0 is home by ArduPilot's convention and is never sailed. Services translate MAVLink items into these.

Three kinds, as in ArduPilot: what is sailed (`Sailed`) follows one upon the other; what is done (`Done`)
happens as the next leg begins; a `Condition` makes what is done after it wait, while that leg is sailed.
"""

from dataclasses import dataclass

from companion.core.geo import LatLon, LocalFrame, Point
from companion.payload.actions import PayloadAction


@dataclass(frozen=True, slots=True)
class Offset:
    """A place relative to the start of the leg to it: the end of the leg before, or the boat."""

    north_m: float
    east_m: float


Place = LatLon | Point | Offset


def locate(place: Place, frame: LocalFrame, start: Point) -> Point:
    """A place in the local frame, for a leg that begins at start."""
    if isinstance(place, LatLon):
        return frame.to_local(place)
    if isinstance(place, Offset):
        return Point(start.north_m + place.north_m, start.east_m + place.east_m)
    return place


@dataclass(frozen=True, slots=True)
class Home:
    """Item 0: home as the planner knew it."""


@dataclass(frozen=True, slots=True)
class Waypoint:
    """Sail to a position and stay there hold_s seconds, which may be infinite."""

    position: Place
    hold_s: float = 0.0
    radius_m: float = 0.0  # 0: the boat's own waypoint radius


@dataclass(frozen=True, slots=True)
class GoRound:
    """Sail round a place, then continue. radius_m: 0 takes CIRC_RADIUS."""

    position: Place
    turns: float
    radius_m: float = 0.0
    clockwise: bool = True


@dataclass(frozen=True, slots=True)
class Wait:
    """Keep station for a time at the boat's position."""

    hold_s: float


@dataclass(frozen=True, slots=True)
class Turn:
    """Turn on the spot to a heading; is_relative: by an angle, positive to starboard."""

    heading_rad: float
    is_relative: bool = False


@dataclass(frozen=True, slots=True)
class HandOver:
    """Let another program steer, as in GUIDED, up to a limit; is_on False ends it at once."""

    is_on: bool


@dataclass(frozen=True, slots=True)
class ReturnHome:
    """Leave the mission for RTL."""


@dataclass(frozen=True, slots=True)
class SetSpeed:
    """Sail at this speed over ground from here on; 0 returns to cruise speed."""

    speed_m_s: float


@dataclass(frozen=True, slots=True)
class MoveHome:
    """Set home; None: to the boat's position."""

    position: LatLon | None


@dataclass(frozen=True, slots=True)
class EnableFence:
    """Enable the fence, or disable it."""

    is_on: bool


@dataclass(frozen=True, slots=True)
class LimitHandOver:
    """Limits of the next `HandOver`: a time, and a distance from its start. 0 is no limit."""

    timeout_s: float
    distance_m: float


@dataclass(frozen=True, slots=True)
class Act:
    """Let a payload do something."""

    action: PayloadAction


@dataclass(frozen=True, slots=True)
class Skip:
    """An item without meaning on this boat."""


@dataclass(frozen=True, slots=True)
class AfterDelay:
    """The next command waits for a time."""

    delay_s: float


@dataclass(frozen=True, slots=True)
class WithinDistance:
    """The next command waits until the end of the leg is this near."""

    distance_m: float


@dataclass(frozen=True, slots=True)
class Jump:
    """Continue at item `target`, `times` times in all; −1: without end."""

    target: int
    times: int


Sailed = Waypoint | GoRound | Wait | Turn | HandOver | ReturnHome
Done = SetSpeed | MoveHome | EnableFence | LimitHandOver | Act | Skip
Condition = AfterDelay | WithinDistance
Step = Home | Sailed | Done | Condition | Jump
Mission = tuple[Step, ...]
