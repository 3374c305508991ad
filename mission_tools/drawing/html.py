"""A planned mission as one HTML page that needs nothing else: map, legs with times, tightest places.

The page is a template (`page.html`, `page.css`, `page.js`); its map is SVG in metres of the chart's frame,
east to the right and north up. A content security policy forbids it every connection.
"""

import json
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from html import escape
from itertools import cycle, pairwise
from pathlib import Path
from string import Template

import shapely
from shapely.geometry import MultiPolygon, Polygon
from shapely.geometry.base import BaseGeometry

from companion.core.geo import LatLon, Point, bearing_rad, distance_m
from mission_tools.assembly.planned_mission import PlannedMission
from mission_tools.assembly.timetable import Timetable
from mission_tools.drawing.view import PART_COLOURS, view_of
from mission_tools.geojson import KEPT_OUT, SOLID
from mission_tools.maps.chart import Chart
from mission_tools.mission.qgc_plan import DEFAULT_SPEED_M_S
from mission_tools.vehicle.mission_monitor import MissionMonitor
from mission_tools.wording import counted, distance, duration

WORST_PLACES = 3
MOST_CORNERS = 60_000  # of a shore on the page; a larger one is drawn simpler
BAND_TOLERANCE = 0.05  # of the clearance: how far the drawn edge of its band may be off
_NAMED = KEPT_OUT | SOLID | {"bridge", "landmark"}
_HERE = Path(__file__)
_Drawn = tuple[str, tuple[str, Sequence[Point]]]  # the colour of a part, its words, its line


@dataclass(frozen=True, slots=True)
class Leg:
    """From one waypoint to the next.

    number: of the waypoint where it ends. clearance_m: infinite in open water; nearest and worst say what the
    leg passes at that distance, and where on the leg that is. arrive_s: from the start, before hold_s.
    """

    number: int
    start: Point
    end: Point
    length_m: float
    course_deg: float
    clearance_m: float
    nearest: str
    worst: Point
    hold_s: float
    arrive_s: float


@dataclass(frozen=True, slots=True)
class Itinerary:
    """All legs. speed_m_s: through the whole route; is_assumed: the mission does not say it."""

    legs: tuple[Leg, ...]
    speed_m_s: float
    is_assumed: bool

    @property
    def length_m(self) -> float:
        """The length of all legs together."""
        return sum(leg.length_m for leg in self.legs)

    @property
    def duration_s(self) -> float:
        """Until the end of the last hold."""
        return self.legs[-1].arrive_s + self.legs[-1].hold_s if self.legs else 0.0

    def worst(self, count: int) -> list[Leg]:
        """The legs that pass nearest to something, the nearest first; one for each place."""
        found: list[Leg] = []
        for leg in sorted(self.legs, key=lambda leg: leg.clearance_m):
            is_new = all(distance_m(leg.worst, other.worst) > leg.clearance_m for other in found)
            if math.isfinite(leg.clearance_m) and is_new:
                found.append(leg)
        return found[:count]


def itinerary(planned: PlannedMission) -> Itinerary:
    """The legs of a mission on its chart."""
    mission, points = planned.mission, planned.points
    speed_m_s = mission.speed_m_s or DEFAULT_SPEED_M_S
    holds = [item.hold_s for item in mission.items if item.place is not None]
    holds = [0.0] * (len(points) - len(holds)) + holds
    legs: list[Leg] = []
    clock_s, table = 0.0, planned.timetable
    for number, ((start, end), hold_s) in enumerate(zip(pairwise(points), holds[1:], strict=True), 1):
        length_m = distance_m(start, end)
        clock_s = table.arrive_s[number - 1] - table.depart_s if table else clock_s + length_m / speed_m_s
        clearance_m, nearest, worst = _tightest(planned.chart, start, end)
        course_deg = math.degrees(bearing_rad(start, end)) % 360.0
        legs.append(
            Leg(number, start, end, length_m, course_deg, clearance_m, nearest, worst, hold_s, clock_s)
        )
        clock_s += hold_s
    return Itinerary(tuple(legs), speed_m_s, mission.speed_m_s is None)


def _tightest(chart: Chart, start: Point, end: Point) -> tuple[float, str, Point]:
    if chart.shores.is_empty:
        return math.inf, "", start
    line = shapely.LineString([(start.east_m, start.north_m), (end.east_m, end.north_m)])
    ends: Sequence[tuple[float, float]] = shapely.shortest_line(line, chart.shores).coords
    (east_m, north_m), (shore_east_m, shore_north_m) = ends
    nearest = chart.nearest_feature(Point(shore_north_m, shore_east_m))
    clearance_m = math.hypot(shore_east_m - east_m, shore_north_m - north_m)
    return clearance_m, nearest, Point(north_m, east_m)


def compose(planned: PlannedMission, monitor: MissionMonitor | None = None) -> str:
    """The page of a planned mission, and of the track if it was followed."""
    chart, way = planned.chart, itinerary(planned)
    clearance_m = planned.clearance_m
    track = [chart.frame.to_local(point.place) for point in monitor.track] if monitor is not None else []
    view = view_of(chart, planned.points, track)
    parts = list(zip(cycle(PART_COLOURS), planned.parts, strict=False))
    table = planned.timetable
    notes = (*planned.notes, *(table.lines() if table else ()))
    page = Template(_text("page.html"))
    return page.substitute(
        title=escape(planned.name),
        style=_text("page.css"),
        script=_text("page.js"),
        facts="".join(
            f"<li><b>{value}</b> {label}</li>" for value, label in _facts(way, clearance_m, monitor, table)
        ),
        map=_map(chart, planned.points, track, clearance_m, parts),
        parts="".join(f'<li style="color:{colour}">{words}</li>' for colour, (words, _) in parts),
        view=json.dumps([view[0], -view[3], view[2] - view[0], view[3] - view[1]]),
        rows="".join(_row(chart, leg, clearance_m, table) for leg in way.legs),
        departures=_departures(table) if table and table.tried else "",
        worst="".join(_worst(chart, leg) for leg in way.worst(WORST_PLACES)),
        notes="".join(f"<li>{escape(note)}</li>" for note in notes),
        speed="Times are those of the current." if table else _speed_note(way),
        has_worst="" if way.worst(1) else "hidden",
        has_notes="" if notes else "hidden",
    )


def _text(name: str) -> str:
    return _HERE.with_name(name).read_text(encoding="utf-8")


def _facts(
    way: Itinerary, clearance_m: float, monitor: MissionMonitor | None, table: Timetable | None
) -> Iterable[tuple[str, str]]:
    yield distance(way.length_m), f"in {counted(len(way.legs), 'leg')}"
    yield duration(way.duration_s), "under way" if table else f"at {way.speed_m_s:g} m/s"
    tightest = min((leg.clearance_m for leg in way.legs), default=math.inf)
    if math.isfinite(tightest):
        asked = f", {distance(clearance_m)} asked" if clearance_m else ""
        yield distance(tightest), f"at the tightest place{asked}"
    if monitor is not None and monitor.track:
        yield distance(monitor.track_length_m), f"sailed in {duration(monitor.duration_s)}"


def _speed_note(way: Itinerary) -> str:
    if way.is_assumed:
        return (
            f"Times are for {way.speed_m_s:g} m/s over ground, as the mission names no speed, without turns."
        )
    return f"Times are for the mission's {way.speed_m_s:g} m/s over ground, without turns."


def _map(
    chart: Chart, points: Sequence[Point], track: Sequence[Point], clearance_m: float, lines: Iterable[_Drawn]
) -> str:
    parts = []
    west, south, east, north = chart.water.bounds
    decimals = max(0, 4 - math.ceil(math.log10(max(east - west, north - south, 1e-3))))
    if chart.is_open:
        parts.append(f'<rect class="water" x="{west:.0f}" y="{-north:.0f}" width="{east - west:.0f}" '
                     f'height="{north - south:.0f}"/>')  # fmt: skip
    else:
        corners = shapely.get_num_coordinates(chart.water)
        extent_m = max(east - west, north - south)
        drawn = chart.water if corners <= MOST_CORNERS else chart.water.simplify(extent_m / 20_000.0)
        parts.append(f'<path class="water" d="{_path(drawn, decimals)}"/>')
        if clearance_m > 0.0:
            band = chart.shores.buffer(clearance_m, quad_segs=4).intersection(chart.water)
            band = band.simplify(BAND_TOLERANCE * clearance_m)
            parts.append(f'<path class="band" d="{_path(band, max(decimals, 1))}"/>')
    kept_out = [feature.shape for feature in chart.features if feature.kind in KEPT_OUT]
    parts += [f'<path class="keep-out" d="{_path(shape, decimals)}"/>' for shape in kept_out]
    if not chart.is_open:
        parts.append(f'<path class="shore" d="{_path(drawn, decimals)}"/>')
    parts += [_name(feature.name, feature.shape) for feature in chart.features if feature.kind in _NAMED]
    if track:
        parts.append(f'<polyline class="track" points="{_points(track)}"/>')
    parts.append(f'<polyline class="route casing" points="{_points(points)}"/>')
    for colour, (_, line) in [("", ("", points)), *lines]:
        parts.append(f'<polyline class="route" style="stroke:{colour}" points="{_points(line)}"/>')
    last = len(points) - 1
    parts += [_leg_label(n, start, end) for n, (start, end) in enumerate(pairwise(points), 1)]
    for n, at in enumerate(points):
        look, text = ("start", "S") if n == 0 else ("goal", "G") if n == last else ("", str(n))
        parts.append(
            f'<g class="pin {look}" data-at="{at.east_m:.2f},{-at.north_m:.2f}" data-n="{n}"><circle r="10"/>'
            f"<text{' class=long' if len(text) > 2 else ''}>{text}</text></g>"
        )
    return "\n".join(parts)


def _name(name: str, shape: BaseGeometry) -> str:
    at = shape.representative_point()
    return f'<g class="name" data-at="{at.x:.2f},{-at.y:.2f}"><text>{escape(name)}</text></g>'


def _leg_label(number: int, start: Point, end: Point) -> str:
    east_m, north_m = 0.5 * (start.east_m + end.east_m), 0.5 * (start.north_m + end.north_m)
    length_m = distance_m(start, end)
    # across the leg, upwards on the page
    upwards = math.copysign(1.0 / max(length_m, 1e-9), end.east_m - start.east_m)
    x, y = upwards * (start.north_m - end.north_m), upwards * (start.east_m - end.east_m)
    return (
        f'<g class="length" data-at="{east_m:.2f},{-north_m:.2f}" data-off="{x:.3f},{y:.3f}" '
        f'data-metres="{length_m:.2f}" '
        f'data-n="{number}"><text>{distance(length_m)}</text></g>'
    )


def _departures(table: Timetable) -> str:
    """What each departure costs, over the window: a gap where the current is too strong."""
    most = max((one.cost for one in table.tried if one.cost < math.inf), default=1.0)
    width = 100.0 / len(table.tried)
    bars = "".join(
        f'<path d="M{n * width:.2f} 30v{-30.0 * one.cost / most:.2f}h{0.8 * width:.2f}V30z"'
        f"{' class=best' * (one.depart_s == table.depart_s)}>"
        f"<title>{table.departure_said(one)}</title></path>"
        for n, one in enumerate(table.tried)
        if one.cost < math.inf
    )
    ends = " … ".join(table.departure_said(one) for one in (table.tried[0], table.tried[-1]))
    return (
        '<h2>Departures</h2><svg class="departures" viewBox="0 0 100 30" preserveAspectRatio="none" '
        f'role="img" aria-label="Cost by departure">{bars}</svg><p class="small">{ends}</p>'
    )


def _row(chart: Chart, leg: Leg, clearance_m: float, table: Timetable | None) -> str:
    is_tight = leg.clearance_m < clearance_m - 0.01
    room = "open water" if math.isinf(leg.clearance_m) else distance(leg.clearance_m)
    hold = f" + {duration(leg.hold_s)}" if leg.hold_s else ""
    at = f", {table.said(table.depart_s + leg.arrive_s)}" if table and table.is_dated else ""
    return (
        f'<tr tabindex="0" data-box="{_box(leg)}" data-n="{leg.number}"><td>{leg.number}</td>'
        f"<td>{distance(leg.length_m)}</td><td>{leg.course_deg:03.0f}°</td>"
        f"<td>{duration(leg.arrive_s)}{at}{hold}</td>"
        f"<td{' class=tight' if is_tight else ''}>{room}</td><td>{escape(leg.nearest)}</td>"
        f"<td>{_degrees(chart.frame.to_global(leg.end))}</td></tr>\n"
    )


def _worst(chart: Chart, leg: Leg) -> str:
    east_m, north_m = leg.worst.east_m, -leg.worst.north_m
    half_m = max(8.0 * leg.clearance_m, 5.0)
    box = f"{east_m - half_m:.1f},{north_m - half_m:.1f},{2 * half_m:.1f},{2 * half_m:.1f}"
    return (
        f'<li><button type="button" data-box="{box}" data-mark="{east_m:.2f},{north_m:.2f}">'
        f"<b>{distance(leg.clearance_m)}</b> from {escape(leg.nearest)}<small>leg {leg.number}, "
        f"{_degrees(chart.frame.to_global(leg.worst))}</small></button></li>"
    )


def _box(leg: Leg) -> str:
    west, east = sorted((leg.start.east_m, leg.end.east_m))
    south, north = sorted((leg.start.north_m, leg.end.north_m))
    margin = 0.35 * max(east - west, north - south) + 2.0
    corner = f"{west - margin:.1f},{-north - margin:.1f}"
    return f"{corner},{east - west + 2 * margin:.1f},{north - south + 2 * margin:.1f}"


def _degrees(place: LatLon) -> str:
    return f"{place.lat_deg:.6f}, {place.lon_deg:.6f}"


def _points(points: Iterable[Point]) -> str:
    return " ".join(f"{point.east_m:.2f},{-point.north_m:.2f}" for point in points)


def _path(shape: BaseGeometry, decimals: int) -> str:
    """The rings of all polygons of a shape as an SVG path."""
    parts = shapely.get_parts(shapely.get_parts(shape))
    polygons = [part for part in parts if isinstance(part, Polygon)]
    lines = []
    for polygon in MultiPolygon(polygons).geoms:
        for ring in (polygon.exterior, *polygon.interiors):
            corners = shapely.get_coordinates(ring)[:-1].round(decimals).tolist()
            lines.append("M" + "L".join(f"{x:.{decimals}f} {-y:.{decimals}f}" for x, y in corners) + "Z")
    return "".join(lines)
