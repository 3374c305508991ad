"""Requests of stations to the vehicle, and its answer. Services create them, the vehicle executes them."""

from dataclasses import dataclass

from companion.core.geo import LatLon
from companion.core.intent import Hold


@dataclass(frozen=True, slots=True)
class Outcome:
    """Whether a request was accepted; if not, the reason for the operator."""

    accepted: bool
    reason: str = ""


ACCEPTED = Outcome(True)


@dataclass(frozen=True, slots=True)
class Arm:
    """Arm the motors. force skips the arming checks."""

    force: bool = False


@dataclass(frozen=True, slots=True)
class Disarm:
    """Stop the motors at once."""

    reason: str = "by command"


@dataclass(frozen=True, slots=True)
class ChangeMode:
    """Enter a mode by its ArduPilot Rover number.

    is_initial: the first known position of the mode switch, not a change by the operator.
    """

    number: int
    is_initial: bool = False


@dataclass(frozen=True, slots=True)
class StartMission:
    """Enter AUTO and sail the mission from an item; None resumes at the current one."""

    first_seq: int | None = None


@dataclass(frozen=True, slots=True)
class SetCurrentItem:
    """Make a mission item the current one; None: the present one. reset: restart the jump counters."""

    seq: int | None
    reset: bool = False


@dataclass(frozen=True, slots=True)
class GoTo:
    """Sail to a position in GUIDED. change_mode: enter GUIDED if necessary, otherwise refuse outside it."""

    position: LatLon
    speed_m_s: float | None = None
    change_mode: bool = False


@dataclass(frozen=True, slots=True)
class SetPoint:
    """Hold this in GUIDED until it times out. Outside GUIDED it is refused without a message."""

    hold: Hold


@dataclass(frozen=True, slots=True)
class ChangeSpeed:
    """Sail at this speed over ground until the mode or mission changes it."""

    speed_m_s: float


@dataclass(frozen=True, slots=True)
class SetHome:
    """Set home; None: the present position."""

    position: LatLon | None = None


@dataclass(frozen=True, slots=True)
class ManualControl:
    """Manual input from a station. Both −1..1; steering is positive to starboard.

    None leaves an axis to the RC transmitter.
    """

    throttle: float | None
    steering: float | None


@dataclass(frozen=True, slots=True)
class OtherVehicle:
    """Reported position and motion over ground of another vehicle."""

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
