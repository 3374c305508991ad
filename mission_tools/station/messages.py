"""What the server and the page say to each other, as JSON over the WebSocket.

SI units; angles in degrees, as the page draws them. A field that was never heard is None.
"""

from typing import Any, Literal

import msgspec
from msgspec import Struct, field

from mission_tools.station.words import LocalizedText


class Place(Struct, frozen=True, kw_only=True):
    """A place in degrees (WGS 84)."""

    lat: float
    lon: float


class Battery(Struct, frozen=True, kw_only=True):
    """left_s: until it is empty at the present load."""

    voltage_v: float | None = None
    current_a: float | None = None
    percent: int | None = None
    left_s: float | None = None


class Fix(Struct, frozen=True, kw_only=True):
    """type: none, 2D, 3D, DGPS, RTK float, RTK fixed. error_m: the receiver's own estimate, 1 sigma."""

    type: str
    satellites: int | None = None
    error_m: float | None = None


class _Localized(Struct, frozen=True, kw_only=True):
    """text: for people, in English. key, values: of a `LocalizedText`, for a page in another language."""

    text: str = ""
    key: str = ""
    values: dict[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if isinstance(self.text, LocalizedText):
            for name, value in self.text.to_page().items():
                msgspec.structs.force_setattr(self, name, value)


class Verdict(_Localized, frozen=True, kw_only=True):
    """What is known of a sensor's health."""

    ok: bool


class Home(Struct, frozen=True, kw_only=True):
    """time_s: to get there at cruise; None while it is not known."""

    place: Place
    distance_m: float | None = None
    time_s: float | None = None


class ItemList(Struct, frozen=True, kw_only=True):
    """A mission, fence or rally list on board. version: counts up when it changes; fetched by HTTP."""

    count: int
    version: int


class MissionState(Struct, frozen=True, kw_only=True):
    """current: the item that the boat sails to; state: not started, active, paused, complete."""

    current: int
    state: str


class WaterCurrent(Struct, frozen=True, kw_only=True):
    """Of the water, as estimated on board. towards_deg: where it flows."""

    speed_m_s: float
    towards_deg: float


class Sonar(Struct, frozen=True, kw_only=True):
    """The latest ping. bearing_deg: from the bow, starboard positive; range_m: None without an echo."""

    bearing_deg: float
    range_m: float | None
    beam_deg: float


class Obstacles(Struct, frozen=True, kw_only=True):
    """OBSTACLE_DISTANCE: ranges at start_deg + n step_deg from the bow, None where nothing is known."""

    start_deg: float
    step_deg: float
    ranges_m: list[float | None]


class Vessel(Struct, frozen=True, kw_only=True):
    """AIS_VESSEL. heading_deg: else the course under way. length_m: of the hull about its place."""

    name: str
    place: Place
    course_deg: float | None = None
    heading_deg: float | None = None
    speed_m_s: float | None = None
    length_m: int | None = None


class LinkLoss(Struct, frozen=True, kw_only=True):
    """A link of the boat. heard: the stations on it; loss: share of the frames lost, 0 to 1."""

    name: str
    heard: list[str]
    loss: float


class Reason(Struct, frozen=True, kw_only=True):
    """Why the boat does not arm, or which failsafe acts. text: as on the wire; why, next: for people.

    key: of the words `reason.KEY.why` and `reason.KEY.next`.
    """

    severity: int
    text: str
    key: str = ""
    why: str = ""
    next: str = ""


class TextLine(Struct, frozen=True, kw_only=True):
    """A STATUSTEXT. at_s: Unix time; number: counts up, so that the page knows what is new."""

    number: int
    at_s: float
    severity: int
    text: str


class Sensor(Struct, frozen=True, kw_only=True):
    """A part of the boat. verdict: fine, warning, failed or skipped (not fitted, or nothing heard).

    text, cure: in English; text_key, cure_key: of the words. age_s: since it measured something new; values:
    numbers by name with their unit, as far as told.
    """

    name: str
    verdict: str
    text: str
    cure: str = ""
    text_key: str = ""
    cure_key: str = ""
    age_s: float | None = None
    values: dict[str, Any] = field(default_factory=dict)


class Calibration(_Localized, frozen=True, kw_only=True):
    """The latest calibration of a boat, by this station.

    kind: compass, gyro, motor_field, thrusters, stop, heading. state: asked, running, silent (running, as far
    as known), waiting (for the result to be kept), done, failed, cancelled, unknown. text: of the boat,
    mostly. lines: what it changed. error_mg: left over of the earth's field; offset_mg: of the compass.
    """

    kind: str
    state: str
    percent: int | None = None
    lines: list[str] = field(default_factory=list)
    error_mg: float | None = None
    offset_mg: list[float] | None = None


class LogFile(Struct, frozen=True, kw_only=True):
    """A log on the boat. at_s: Unix time of its end; None if it is not known."""

    name: str
    bytes: int
    at_s: float | None = None


class Snapshot(Struct, frozen=True, kw_only=True):
    """A boat as the page shows it. heard_s: Unix time of the latest heartbeat."""

    boat: int
    heard_s: float | None = None
    mode: str | None = None
    modes: list[str] = field(default_factory=list)
    armed: bool | None = None
    starts: int = 0  # of the boat's program, seen since this station began
    state: str | None = None  # standby, active, critical, emergency, off
    battery: Battery | None = None
    fix: Fix | None = None
    compass: Verdict | None = None
    speed_m_s: float | None = None  # over ground
    cruise_m_s: float | None = None  # the speed that the boat takes by itself
    heading_deg: float | None = None
    course_deg: float | None = None
    place: Place | None = None
    home: Home | None = None
    mission: ItemList | None = None
    progress: MissionState | None = None
    fence: ItemList | None = None
    rally: ItemList | None = None
    current: WaterCurrent | None = None
    sonar: Sonar | None = None
    obstacles: Obstacles | None = None
    vessels: dict[str, Vessel] = field(default_factory=dict)  # by their AIS number
    links: list[LinkLoss] = field(default_factory=list)
    temperature_c: float | None = None
    disk_free_mb: float | None = None
    calibration: Calibration | None = None
    load: float | None = None  # of the boat's tick, 0 to 1
    reasons: list[Reason] = field(default_factory=list)
    lines: list[TextLine] = field(default_factory=list)  # the latest 30


Role = Literal["viewer", "skipper"]  # skipper: has told the PIN


class BoatName(Struct, frozen=True, kw_only=True):
    """A boat of the fleet in short. age_s: since it was heard, as of now."""

    id: int
    heard_s: float | None = None
    age_s: float | None = None
    mode: str | None = None
    armed: bool | None = None
    state: str | None = None
    percent: int | None = None
    left_s: float | None = None
    place: Place | None = None
    heading_deg: float | None = None


class Hello(Struct, frozen=True, kw_only=True, tag_field="type", tag="hello"):
    """The first message on a socket, and again when the role or the boats change."""

    role: Role
    boats: list[BoatName]


class State(Struct, frozen=True, kw_only=True, tag_field="type", tag="state"):
    """patch: RFC 7396 merge patch of the snapshot; the first one is whole."""

    boat: int
    patch: dict[str, Any]


class Answer(_Localized, frozen=True, kw_only=True, tag_field="type", tag="answer"):
    """To a request, once. text: for people, what the boat answered."""

    id: str
    ok: bool
    result: Any = None


class PageRequest(Struct, frozen=True, kw_only=True, tag_field="type", tag="do"):
    """From the page. id: made by the page, unique; a second one with the same id is answered, not done again.

    what: a name in the table of `requests.py`; arguments: its own, as `with` in JSON.
    """

    id: str
    boat: int
    what: str
    arguments: dict[str, Any] = field(default_factory=dict, name="with")


ToPage = Hello | State | Answer
