"""What a user asks of a route."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, fields
from typing import Literal

from companion.core.geo import LatLon
from mission_tools.errors import UsageError

_FLAGS = {
    "is_return": "--return",
    "follow_shore_at": "--follow-shore",
    "is_route_file": "--as-route",
    "is_outline": "--as-outline",
}
_UNITS = ("_m_s", "_m", "_s", "_deg")


@dataclass(frozen=True, slots=True)
class Via:
    """A place on the way. hold_s: how long the boat holds there, None: as the task says."""

    place: LatLon
    hold_s: float | None = None


@dataclass(frozen=True, slots=True)
class PlanOptions:
    """The route options of the command line; None, False or empty where not given.

    via: places on the way, in this order or (any_order) in the best one. hold_s: at each of them and at
    the goal. is_return: back to the start at the end. survey: a file with the area, or "all" for the
    whole water. fill_gaps: that file, if it holds what a survey left out. angle_deg: of tracks.
    follow_shore_at: near the shore to follow. first, last: the ends of a stretch of it. boat: its TOML,
    or an emulated boat's name. wind: mean speed and where it comes from. depart: when the voyage begins,
    on the current's clock, or a window. least: time or charge. open_water_m: how far from the shore a
    metre is dearer. lead_m: straight on before and after each track. pattern: of a search, from the place
    `at`. trigger: of the sensor, camera:M or relay:N. draught_m: water that is charted less deep is an
    obstacle. air_draught_m: so is a bridge less high. is_route_file: SOURCE is a route, not a map.
    is_outline: the lines of SOURCE, a .gpx file, enclose water. check_on: the map on which a finished
    mission is checked, or "none". split: into parts that each come home on one pack.
    """

    start_at: LatLon | None = None
    goal: LatLon | None = None
    case: str | None = None
    clearance_m: float | None = None
    cell_m: float | None = None
    heuristic: str | None = None
    smooth: bool | None = None
    speed_m_s: float | None = None
    via: tuple[Via, ...] = ()
    any_order: bool = False
    is_return: bool = False
    hold_s: float | None = None
    survey: str | None = None
    fill_gaps: str | None = None
    spacing_m: float | None = None
    footprint_m: float | None = None
    overlap: float | None = None
    angle_deg: float | Literal["current"] | None = None
    cross_m: float | None = None
    shore_passes: int | None = None
    turn_radius_m: float | None = None
    lead_m: float | None = None
    pattern: str | None = None
    at: LatLon | None = None
    trigger: str | None = None
    follow_shore_at: LatLon | None = None
    distance_m: float | None = None
    shore_to: str | None = None
    first: LatLon | None = None
    last: LatLon | None = None
    boat: str | None = None
    current: str | None = None
    depart: str | None = None
    wind: str | None = None
    least: str | None = None
    open_water_m: float | None = None
    draught_m: float | None = None
    air_draught_m: float | None = None
    is_route_file: bool = False
    is_outline: bool = False
    check_on: str | None = None
    split: bool = False

    def __post_init__(self) -> None:
        """Raises UsageError: a wind without a boat that it would push."""
        if self.wind is not None and self.boat is None:
            raise UsageError("--wind: add --boat BOAT.toml, which says how much of it stands in the wind")

    def given(self) -> list[str]:
        """The fields that were given."""
        return [field.name for field in fields(self) if getattr(self, field.name) != field.default]

    @property
    def has_costs(self) -> bool:
        """Whether the shortest route is not what is asked for."""
        return self.least is not None or self.open_water_m is not None or self.current is not None

    def check_costs(self) -> None:
        """See that costs are asked for where they are obeyed. Raises UsageError: names the options."""
        asked = self.least is not None or self.open_water_m is not None
        if asked and self.is_task:
            raise UsageError("--least, --open-water: only for a way from place to place")
        if self.least is not None and not (self.current or self.wind or self.open_water_m is not None):
            raise UsageError(
                "--least: add --current or --wind; without one the shortest route is the cheapest"
            )

    def check_split(self, *, is_finished: bool) -> None:
        """See that what is cut has a pack, and a finished mission its map. Raises UsageError: names them."""
        if self.split and self.boat is None:
            raise UsageError("--split: add --boat BOAT.toml, for whose pack it is cut")
        if self.split and self.depart is not None:
            raise UsageError("--depart: not with --split, as nobody knows when each part leaves")
        if self.split and is_finished and self.check_on is None:
            raise UsageError("--split: ways home need a map: add --check-on MAP (none: they are straight)")

    @property
    def is_task(self) -> bool:
        """Whether more is asked for than a way from place to place."""
        stops = self.any_order or self.is_return or self.hold_s is not None
        has_holds = any(via.hold_s is not None for via in self.via)
        return stops or has_holds or self.survey is not None or self.follow_shore_at is not None

    @property
    def starts_anywhere(self) -> bool:
        """Whether the task itself finds the best place to begin."""
        return self.survey is not None or self.follow_shore_at is not None


def flags(names: Iterable[str]) -> Iterator[str]:
    """What the fields are called on the command line."""
    for name in names:
        unit = next((unit for unit in _UNITS if name.endswith(unit)), "")
        yield _FLAGS.get(name, "--" + name.removesuffix(unit).replace("_", "-"))
