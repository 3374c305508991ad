"""What the page asks of a plan, and what it gets. Degrees as [longitude, latitude], SI units."""

from collections.abc import Mapping, Sequence
from typing import Annotated, Any, Final, Literal, NamedTuple

import msgspec
from msgspec import Meta, Struct

from companion.mavlink.items import MissionItem
from companion.shore.messages import Place
from companion.shore.words import say

MOST_GOALS: Final = 100  # a person taps them; the best order of more takes minutes
MOST_CORNERS: Final = 500

Longitude = Annotated[float, Meta(ge=-180.0, le=180.0)]
Latitude = Annotated[float, Meta(ge=-90.0, le=90.0)]
LonLat = tuple[Longitude, Latitude]
Metres = Annotated[float, Meta(gt=0.0, le=1000.0)]


Task = Literal["route", "survey", "import"]


class WishError(Exception):
    """A wish that cannot be planned. expected: what would do."""

    def __init__(self, text: str, expected: str) -> None:
        super().__init__(text)
        self.expected = expected


class Wish(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What is to be planned.

    start: None is the boat's place. area: of a survey; empty is the whole water. clearance_m: kept from
    shores and fence. speed_m_s: over ground. footprint_m: the width that the sensor covers; overlap: the
    share of it that two tracks have in common; angle_deg: the course of the tracks. None is left to the
    planner.
    """

    task: Literal["route", "survey"]
    start: Place | None = None
    goals: Annotated[list[LonLat], Meta(max_length=MOST_GOALS)] = []
    area: Annotated[list[LonLat], Meta(max_length=MOST_CORNERS)] = []
    any_order: bool = False
    is_return: bool = msgspec.field(default=False, name="return")
    clearance_m: Annotated[float, Meta(ge=0.0, le=1000.0)] | None = None
    speed_m_s: Annotated[float, Meta(gt=0.0, le=50.0)] | None = None
    footprint_m: Metres | None = None
    overlap: Annotated[float, Meta(ge=0.0, le=0.9)] | None = None
    angle_deg: Annotated[float, Meta(ge=-360.0, le=360.0)] | None = None


def parse_wish(body: bytes) -> Wish:
    """A wish from JSON.

    Raises:
        WishError: names the field and what is expected there.
    """
    try:
        wish = msgspec.json.decode(body, type=Wish)
    except msgspec.ValidationError as error:
        raise WishError(say("planner.unfit", why=str(error)), say("planner.fields")) from None
    except (msgspec.DecodeError, RecursionError, UnicodeError):
        raise WishError(say("planner.no_json"), say("planner.fields")) from None
    if wish.start is not None and not (abs(wish.start.lat) <= 90.0 and abs(wish.start.lon) <= 180.0):
        raise WishError(say("planner.no_start"), say("planner.degrees"))
    if wish.task == "route" and not wish.goals:
        raise WishError(say("planner.no_goal"), say("planner.goals", most=MOST_GOALS))
    if wish.task == "survey" and wish.footprint_m is None:
        raise WishError(say("planner.no_footprint"), say("planner.footprint"))
    if wish.area and len(wish.area) < 3:
        raise WishError(say("planner.no_area", n=len(wish.area)), say("planner.area", most=MOST_CORNERS))
    return wish


class Plan(Struct, frozen=True, kw_only=True):
    """A finished plan, as the page gets it.

    points: the line. time_s: None where no speed is known. charge_percent: of the battery, out and home;
    fits: whether the boat comes home with its reserve; both None where the boat's file does not say.
    clearance_m: least distance of the line to a shore; None in open water.
    """

    id: str
    name: str
    task: Task
    items: int
    points: list[tuple[float, float]]
    length_m: float
    time_s: float | None
    charge_percent: float | None
    fits: bool | None
    clearance_m: float | None
    has_areas: bool
    warnings: list[str]


class Lists(NamedTuple):
    """The items as on the wire. Home is the mission's first; fence and rally only of an imported plan."""

    mission: tuple[MissionItem, ...]
    fence: tuple[MissionItem, ...] = ()
    rally: tuple[MissionItem, ...] = ()


def lists_of(report: Mapping[str, Sequence[Sequence[Any]]], kinds: Sequence[str]) -> Lists:
    """The lists of these kinds in the planner's report.

    A row is frame, command, autocontinue, four parameters, x, y, z; null is NaN.
    """
    return Lists(**{kind: tuple(_item(*row) for row in report.get(kind, ())) for kind in kinds})


def _item(frame: int, command: int, autocontinue: int, *numbers: float | None) -> MissionItem:
    param1, param2, param3, param4, x, y, z = (float("nan") if one is None else one for one in numbers)
    return MissionItem(
        frame=frame,
        command=command,
        autocontinue=autocontinue,
        param1=param1,
        param2=param2,
        param3=param3,
        param4=param4,
        x=int(x),
        y=int(y),
        z=z,
    )
