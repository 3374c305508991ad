"""A map to plan on, as Python programs and notebooks see it."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from os import PathLike, fspath
from typing import Any, Literal, TypeAlias

from companion.core.geo import LatLon, Point
from mission_tools.assembly.areas import parse_areas
from mission_tools.assembly.map_source import MapSource
from mission_tools.assembly.plan_options import PlanOptions, Via
from mission_tools.assembly.planned_mission import PlannedMission
from mission_tools.assembly.planned_task import WHOLE_WATER, SurveyArea, survey_area
from mission_tools.errors import MapError, UsageError
from mission_tools.maps import Source, load_source
from mission_tools.maps.geojson import parse_geojson
from mission_tools.mission.mission import Mission
from mission_tools.route_plan import RoutePlan, picture

Place: TypeAlias = LatLon | tuple[float, float]
"""A LatLon, or (latitude, longitude) in degrees."""

MapSourceName: TypeAlias = str | PathLike[str] | Mapping[str, Any]


def open_map(source: MapSourceName) -> "WaterMap":
    """Open a map: the path of a map file or scenario, a scenario's name, GeoJSON as a dict or as text. Raises
    MapError: it cannot be used; one line that names the file, the feature and the place.
    """
    if isinstance(source, Mapping):
        return WaterMap(Source(parse_geojson(source, "the map", "map")))
    text = fspath(source)
    if text.lstrip().startswith("{"):
        try:
            tree = json.loads(text)
        except ValueError as error:
            raise MapError(f"the map: not GeoJSON: {error}") from None
        return WaterMap(Source(parse_geojson(tree, "the map", "map")))
    return WaterMap(load_source(text))


@dataclass(frozen=True, slots=True)
class WaterMap:
    """Water to plan routes on.

    Its methods raise NoRouteError where there is no way, and UsageError for values that make no sense; each
    message is one line for a person. clearance_m, everywhere: metres kept from shores, obstacles and keep-out
    areas; None: the scenario's, or 4. speed_m_s: over ground, put into the mission; None: the boat's own.
    """

    source: Source

    @property
    def name(self) -> str:
        """What the map calls its water."""
        return self.source.chart.name

    def route(
        self,
        start: Place | None = None,
        goal: Place | None = None,
        *,
        via: Sequence[Place] = (),
        clearance_m: float | None = None,
        speed_m_s: float | None = None,
    ) -> RoutePlan:
        """The shortest way from start through the via places to the goal; a scenario has its own two."""
        options = PlanOptions(
            start_at=_at("start", start),
            goal=_at("goal", goal),
            via=_via(via),
            clearance_m=clearance_m,
            speed_m_s=speed_m_s,
        )
        return self._planned(options)

    def tour(
        self,
        start: Place,
        stops: Sequence[Place],
        *,
        hold_s: float = 0.0,
        any_order: bool = False,
        is_return: bool = False,
        clearance_m: float | None = None,
        speed_m_s: float | None = None,
    ) -> RoutePlan:
        """Several places, as given or (any_order) in the order that makes the route shortest.

        hold_s: how long the boat holds at each. is_return: back to the start at the end.
        """
        *via, goal = stops or (start,)
        options = PlanOptions(
            start_at=_at("start", start),
            goal=_at("stop", goal),
            via=_via(via),
            any_order=any_order,
            is_return=is_return,
            hold_s=hold_s,
            clearance_m=clearance_m,
            speed_m_s=speed_m_s,
        )
        return self._planned(options)

    def survey(
        self,
        area: Mapping[str, Any] | str | PathLike[str] | None = None,
        *,
        start: Place | None = None,
        spacing_m: float | None = None,
        footprint_m: float | None = None,
        overlap: float | None = None,
        angle_deg: float | None = None,
        cross_m: float | None = None,
        shore_passes: int | None = None,
        is_return: bool = False,
        clearance_m: float | None = None,
        speed_m_s: float | None = None,
    ) -> RoutePlan:
        """Cover an area, GeoJSON as a dict, a file, or None for all, by passes along the shores and tracks.

        Two of spacing_m (between tracks), footprint_m (the width that the sensor covers) and overlap (a share
        of it) give the third. angle_deg: course of the tracks, None: the one with the fewest turns. cross_m:
        between lines across, for checking. shore_passes: how often along the shores, None: six times, with an
        angle once. start: None begins at the most convenient track.
        """
        options = PlanOptions(
            start_at=_at("start", start),
            survey=WHOLE_WATER if area is None or isinstance(area, Mapping) else fspath(area),
            spacing_m=spacing_m,
            footprint_m=footprint_m,
            overlap=overlap,
            angle_deg=angle_deg,
            cross_m=cross_m,
            shore_passes=shore_passes,
            is_return=is_return,
            clearance_m=clearance_m,
            speed_m_s=speed_m_s,
        )
        if not isinstance(area, Mapping):
            return self._planned(options)
        name = "the area"
        return self._planned(options, survey_area(self.source.chart, parse_areas(area, name), name))

    def follow_shore(
        self,
        near: Place,
        distance_m: float,
        *,
        start: Place | None = None,
        shore_to: Literal["port", "starboard"] = "starboard",
        clearance_m: float | None = None,
        speed_m_s: float | None = None,
    ) -> RoutePlan:
        """Along the shore nearest to a place, all round, at a distance of at least the clearance."""
        options = PlanOptions(
            start_at=_at("start", start),
            follow_shore_at=_at("near", near),
            distance_m=distance_m,
            shore_to=shore_to,
            clearance_m=clearance_m,
            speed_m_s=speed_m_s,
        )
        return self._planned(options)

    def is_water(self, place: Place) -> bool:
        """Whether a boat may be there."""
        return self.source.chart.obstruction(self._local(place)) is None

    def clearance_m(self, place: Place) -> float:
        """Distance to the nearest shore or obstacle in metres; 0 ashore, infinite in open water."""
        return self.source.chart.clearance_m(self._local(place))

    def _local(self, place: Place) -> Point:
        at = _at("place", place)
        assert at is not None  # noqa: S101  a place was given
        return self.source.chart.frame.to_local(at)

    def _planned(self, options: PlanOptions, area: SurveyArea | None = None) -> RoutePlan:
        return RoutePlan(MapSource(self.name, self.source, options, area=area).prepare())

    def _repr_png_(self) -> bytes:
        return picture(PlannedMission(self.name, Mission(()), self.source.chart))


def _via(places: Sequence[Place]) -> tuple[Via, ...]:
    return tuple(Via(at) for place in places if (at := _at("via", place)) is not None)


def _at(what: str, place: Place | None) -> LatLon | None:
    """A place as LatLon. Raises UsageError: not a latitude and a longitude."""
    if place is None or isinstance(place, LatLon):
        return place
    try:
        lat_deg, lon_deg = place
        return LatLon(float(lat_deg), float(lon_deg))
    except (TypeError, ValueError) as error:
        raise UsageError(f"{what} {place!r}: expected (latitude, longitude) in degrees: {error}") from None
