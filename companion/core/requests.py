"""What stations may ask of the vehicle, and its answer. Services build these; `vehicle` carries them out."""

from dataclasses import dataclass

from companion.core.geo import LatLon
from companion.core.intent import Hold


@dataclass(frozen=True, slots=True)
class Outcome:
    """Whether a request was carried out; if not, why, in words for the operator."""

    accepted: bool
    reason: str = ""


ACCEPTED = Outcome(True)


@dataclass(frozen=True, slots=True)
class Arm:
    """Let the motors turn. force skips the arming checks."""

    force: bool = False


@dataclass(frozen=True, slots=True)
class Disarm:
    """Motors off, at once."""

    reason: str = "by command"


@dataclass(frozen=True, slots=True)
class ChangeMode:
    """Enter a mode by its ArduPilot Rover number."""

    number: int


@dataclass(frozen=True, slots=True)
class StartMission:
    """Enter AUTO and sail the mission from an item on; None resumes at the current one."""

    first_seq: int | None = None


@dataclass(frozen=True, slots=True)
class SetCurrentItem:
    """Make an item of the mission the current one, None: the one that is. reset: jumps begin anew as well."""

    seq: int | None
    reset: bool = False


@dataclass(frozen=True, slots=True)
class GoTo:
    """Sail to a position in GUIDED. change_mode: enter GUIDED if need be, else refuse outside it."""

    position: LatLon
    speed_m_s: float | None = None
    change_mode: bool = False


@dataclass(frozen=True, slots=True)
class SetPoint:
    """Hold this in GUIDED, until it goes stale. Outside GUIDED it is refused, without a notice."""

    hold: Hold


@dataclass(frozen=True, slots=True)
class ChangeSpeed:
    """Sail at this speed over ground until the mode or the mission says otherwise."""

    speed_m_s: float


@dataclass(frozen=True, slots=True)
class SetHome:
    """Make a position home; None takes where the boat is."""

    position: LatLon | None = None


@dataclass(frozen=True, slots=True)
class ManualControl:
    """The operator's hand at a station. Both −1..1; steering is positive to starboard.

    None leaves a stick to the transmitter.
    """

    throttle: float | None
    steering: float | None


@dataclass(frozen=True, slots=True)
class OtherVehicle:
    """Another vehicle says where it is, and how it moves over ground."""

    system_id: int
    position: LatLon
    north_m_s: float
    east_m_s: float
    heading_rad: float


Request = (
    Arm
    | Disarm
    | ChangeMode
    | StartMission
    | SetCurrentItem
    | GoTo
    | SetPoint
    | ChangeSpeed
    | SetHome
    | ManualControl
    | OtherVehicle
)
