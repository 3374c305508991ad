"""What the page asks of a plan, and what it gets of a report. Degrees as [longitude, latitude], SI units."""

from collections.abc import Mapping, Sequence
from typing import Annotated, Any, Final, Literal, NamedTuple

import msgspec
from msgspec import Meta, Struct

from companion.mavlink.items import MissionItem
from mission_tools.station.messages import Place
from mission_tools.station.words import say

MOST_GOALS: Final = 100  # a person taps them; the best order of more takes minutes
MOST_CORNERS: Final = 500

Longitude = Annotated[float, Meta(ge=-180.0, le=180.0)]
Latitude = Annotated[float, Meta(ge=-90.0, le=90.0)]
LonLat = tuple[Longitude, Latitude]
Metres = Annotated[float, Meta(gt=0.0, le=1000.0)]


Task = Literal["route", "survey", "import"]


class PlanRequestError(Exception):
    """A request that cannot be planned. expected: what would do."""

    def __init__(self, text: str, expected: str) -> None:
        super().__init__(text)
        self.expected = expected


class PlanRequest(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What is to be planned.

    start: None is the boat's place. area: of a survey; empty is the whole water. clearance_m: kept from
    shores and fence. speed_m_s: over ground. wind_m_s, wind_from_deg: the mean wind, and where it comes from.
    footprint_m: the width that the sensor covers; overlap: the share of it that two tracks have in common;
    angle_deg: the course of the tracks. None is left to the planner.
    """

    task: Literal["route", "survey"]
    start: Place | None = None
    goals: Annotated[list[LonLat], Meta(max_length=MOST_GOALS)] = []
    area: Annotated[list[LonLat], Meta(max_length=MOST_CORNERS)] = []
    any_order: bool = False
    is_return: bool = msgspec.field(default=False, name="return")
    clearance_m: Annotated[float, Meta(ge=0.0, le=1000.0)] | None = None
    speed_m_s: Annotated[float, Meta(gt=0.0, le=50.0)] | None = None
    wind_m_s: Annotated[float, Meta(ge=0.0, le=40.0)] | None = None
    wind_from_deg: Annotated[float, Meta(ge=-360.0, le=360.0)] | None = None
    footprint_m: Metres | None = None
    overlap: Annotated[float, Meta(ge=0.0, le=0.9)] | None = None
    angle_deg: Annotated[float, Meta(ge=-360.0, le=360.0)] | None = None


def parse_wish(body: bytes) -> PlanRequest:
    """A request from JSON; PlanRequestError names the field and what is expected there."""
    try:
        wanted = msgspec.json.decode(body, type=PlanRequest)
    except msgspec.ValidationError as error:
        raise PlanRequestError(say("planner.unfit", why=str(error)), say("planner.fields")) from None
    except (msgspec.DecodeError, RecursionError, UnicodeError):
        raise PlanRequestError(say("planner.no_json"), say("planner.fields")) from None
    if wanted.start is not None and not (abs(wanted.start.lat) <= 90.0 and abs(wanted.start.lon) <= 180.0):
        raise PlanRequestError(say("planner.no_start"), say("planner.degrees"))
    if wanted.task == "route" and not wanted.goals:
        raise PlanRequestError(say("planner.no_goal"), say("planner.goals", most=MOST_GOALS))
    if wanted.task == "survey" and wanted.footprint_m is None:
        raise PlanRequestError(say("planner.no_footprint"), say("planner.footprint"))
    if wanted.area and len(wanted.area) < 3:
        raise PlanRequestError(
            say("planner.no_area", n=len(wanted.area)), say("planner.area", most=MOST_CORNERS)
        )
    return wanted


class MadePlan(Struct, frozen=True, kw_only=True):
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
    return MissionItem(frame, command, 0, autocontinue, param1, param2, param3, param4, int(x), int(y), z)


def line(report: Mapping[str, Any]) -> list[tuple[float, float]]:
    """Longitude and latitude of home, where it is known, and of each waypoint."""
    home = report["home"]
    places = [home, *report["waypoints"]] if home and any(home) else report["waypoints"]
    return [(round(lon, 7), round(lat, 7)) for lat, lon in places]


def time_s(report: Mapping[str, Any], route: Mapping[str, Any], speed_m_s: float | None) -> float | None:
    """By the budget, else at a speed; None where neither is known."""
    if report["budget"]:
        return float(report["budget"]["time_s"])
    if not speed_m_s:
        return None
    return float(route["length_m"] / speed_m_s + route.get("hold_s", 0.0))


def charge_percent(report: Mapping[str, Any]) -> float | None:
    """Of a full battery, out and home; None where the boat's file does not say what it draws."""
    budget = report["budget"]
    if not budget or budget["charge_mah"] is None or not budget["capacity_mah"]:
        return None
    home_mah = budget["home_mah"]
    return None if home_mah is None else 100.0 * (budget["charge_mah"] + home_mah) / budget["capacity_mah"]


def distance(length_m: float) -> str:
    """A distance for people: metres, or kilometres from 1 km."""
    return f"{length_m:.0f} m" if length_m < 10_000.0 else f"{length_m / 1000.0:.1f} km"
