"""A mission as the vehicle sails it: one step per item, in the order of the MAVLink sequence.

Sequence 0 is home by ArduPilot's convention and is never sailed. Services translate MAVLink items into these.

Three kinds, as in ArduPilot: what is sailed (`Sailed`) follows one upon the other; what is done (`Done`)
happens as the next leg begins; a `Condition` makes what is done after it wait, while that leg is sailed.
"""

from dataclasses import dataclass

from companion.core.geo import LatLon
from companion.vehicle.mission.places import Place


@dataclass(frozen=True, slots=True)
class Home:
    """Sequence 0: where the planner thought home was."""


@dataclass(frozen=True, slots=True)
class Waypoint:
    """Sail to a position; stay there hold_s seconds, infinite for ever."""

    position: Place
    hold_s: float = 0.0
    radius_m: float = 0.0  # 0: the boat's own waypoint radius


@dataclass(frozen=True, slots=True)
class GoRound:
    """Sail round a place, then go on. radius_m: 0 the boat's own."""

    position: Place
    turns: float
    radius_m: float = 0.0
    clockwise: bool = True


@dataclass(frozen=True, slots=True)
class Wait:
    """Keep station for a time, where the boat is."""

    hold_s: float


@dataclass(frozen=True, slots=True)
class Turn:
    """Turn on the spot to a heading; is_relative: by it, to starboard."""

    heading_rad: float
    is_relative: bool = False


@dataclass(frozen=True, slots=True)
class HandOver:
    """Do what another program asks for, as in GUIDED, until a limit ends it; is_on False ends it at once."""

    is_on: bool


@dataclass(frozen=True, slots=True)
class ReturnHome:
    """Leave the mission for RTL."""


@dataclass(frozen=True, slots=True)
class SetSpeed:
    """Sail at this speed over ground from now on; 0 goes back to cruise speed."""

    speed_m_s: float


@dataclass(frozen=True, slots=True)
class MoveHome:
    """Make a place home, None: where the boat is."""

    position: LatLon | None


@dataclass(frozen=True, slots=True)
class LimitHandOver:
    """When the next `HandOver` ends: after a time, or so far from where it began. 0 is no limit."""

    timeout_s: float
    distance_m: float


@dataclass(frozen=True, slots=True)
class Skip:
    """Nothing: an item that means nothing on this boat."""


@dataclass(frozen=True, slots=True)
class AfterDelay:
    """What is done next waits so long."""

    delay_s: float


@dataclass(frozen=True, slots=True)
class WithinDistance:
    """What is done next waits until the end of the leg is this near."""

    distance_m: float


@dataclass(frozen=True, slots=True)
class Jump:
    """Go on at sequence `target`, `times` times in all; −1 for ever."""

    target: int
    times: int


Sailed = Waypoint | GoRound | Wait | Turn | HandOver | ReturnHome
Done = SetSpeed | MoveHome | LimitHandOver | Skip
Condition = AfterDelay | WithinDistance
Step = Home | Sailed | Done | Condition | Jump
Mission = tuple[Step, ...]
