"""Requests of stations to the vehicle, and its answer. Services create them, the vehicle executes them."""

from msgspec import Struct

from companion.core.geo import LatLon
from companion.core.intent import Hold


class Outcome(Struct, frozen=True):
    """Whether a request was accepted; if not, the reason for the operator."""

    accepted: bool
    reason: str = ""


ACCEPTED = Outcome(True)


class Arm(Struct, frozen=True):
    """Arm the motors. force skips the arming checks."""

    force: bool = False


class Disarm(Struct, frozen=True):
    """Stop the motors at once."""

    reason: str = "by command"


class ChangeMode(Struct, frozen=True):
    """Enter a mode by its ArduPilot Rover number.

    is_initial: the first known position of the mode switch, not a change by the operator.
    """

    number: int
    is_initial: bool = False


class StartMission(Struct, frozen=True):
    """Enter AUTO and sail the mission from an item; None resumes at the current one."""

    first_seq: int | None = None


class SetCurrentItem(Struct, frozen=True):
    """Make a mission item the current one; None: the present one. reset: restart the jump counters."""

    seq: int | None
    reset: bool = False


class GoTo(Struct, frozen=True):
    """Sail to a position in GUIDED. change_mode: enter GUIDED if necessary, otherwise refuse outside it."""

    position: LatLon
    speed_m_s: float | None = None
    change_mode: bool = False


class SetPoint(Struct, frozen=True):
    """Hold this in GUIDED until it times out. Outside GUIDED it is refused without a message."""

    hold: Hold


class ChangeSpeed(Struct, frozen=True):
    """Sail at this speed over ground until the mode or mission changes it."""

    speed_m_s: float


class SetHome(Struct, frozen=True):
    """Set home; None: the present position."""

    position: LatLon | None = None


class ManualControl(Struct, frozen=True):
    """Manual input from a station. Both −1..1; steering is positive to starboard.

    None leaves an axis to the RC transmitter.
    """

    throttle: float | None
    steering: float | None


class OtherVehicle(Struct, frozen=True):
    """Reported position and motion over ground of another vehicle."""

    system_id: int
    position: LatLon
    north_m_s: float
    east_m_s: float
    heading_rad: float


Request = (
    Arm | Disarm | ChangeMode | StartMission | SetCurrentItem | GoTo
    | SetPoint | ChangeSpeed | SetHome | ManualControl | OtherVehicle
)  # fmt: skip
