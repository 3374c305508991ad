"""What the vehicle's rangers see, folded into cells on the chart that fade.

OBSTACLE_DISTANCE and DISTANCE_SENSOR give ranges from the bow; position and heading of the same moment make
each a cell. A cell counts once it has been seen twice, is weakened by a ray that passes through it, and
fades: what floats has drifted on, and what was a ghost is gone.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Final

import shapely
from shapely.geometry import MultiPolygon, Polygon

from companion.core.geo import Point
from mission_tools.maps.chart import Chart

CELL_M: Final = 0.5  # a sector of 5° is 0.35 m wide at the 4 m that a sonar sees
JOINED_M: Final = 1.5  # a gap that is narrower is no way through for a boat of half a metre
FADE_S: Final = 120.0
CONFIRMED: Final = 2.0
MOST_EVIDENCE: Final = 4.0
_PASSED_THROUGH: Final = 0.5
SHORE_M: Final = 2.0
"""What is seen this near to a charted shore is that shore: a receiver's position is good to about 2 m."""
UNKNOWN_CM: Final = 65535
_BODY_FRD: Final = 12
_GLOBAL: Final = 0
_CUSTOM: Final = 100  # MAV_SENSOR_ROTATION_CUSTOM: the quaternion says where it looks


@dataclass(frozen=True, slots=True)
class Echo:
    """A ray from the vehicle. bearing_rad: from north; range_m: what it met, or how far it met nothing."""

    bearing_rad: float
    range_m: float
    is_hit: bool


def echoes_of(
    name: str, fields: Mapping[str, Any], heading_rad: float, before: Mapping[str, Any] | None = None
) -> list[Echo]:
    """The rays of an OBSTACLE_DISTANCE or DISTANCE_SENSOR message.

    before: the last message of the kind. A sector that says the same again is what was measured then: a sonar
    needs a second or two for a sweep, and reports all of it meanwhile. Raises KeyError, TypeError,
    ValueError: fields that make no sense.
    """
    if name == "OBSTACLE_DISTANCE":
        return list(_sectors(fields, heading_rad, () if before is None else before["distances"]))
    least_m, most_m = fields["min_distance"] / 100.0, fields["max_distance"] / 100.0
    range_m = fields["current_distance"] / 100.0
    orientation = int(fields["orientation"])
    if orientation == _CUSTOM:
        w, x, y, z = (float(part) for part in fields["quaternion"])
        yaw = math.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
    elif 0 <= orientation < 8:
        yaw = orientation * math.pi / 4.0
    else:
        return []
    if range_m < least_m:
        return []
    return [Echo(heading_rad + yaw, min(range_m, most_m), range_m <= most_m)]


def _sectors(fields: Mapping[str, Any], heading_rad: float, before: Sequence[int]) -> Iterable[Echo]:
    frame = int(fields.get("frame", _BODY_FRD))
    if frame not in (_GLOBAL, _BODY_FRD):
        return
    step_deg = float(fields.get("increment_f") or 0.0) or float(fields["increment"])
    first_deg = float(fields.get("angle_offset") or 0.0)
    turned = heading_rad if frame == _BODY_FRD else 0.0
    least_cm, most_cm = int(fields["min_distance"]), int(fields["max_distance"])
    for sector, cm in enumerate(fields["distances"]):
        if cm == UNKNOWN_CM or cm < least_cm or abs(sector * step_deg) >= 360.0:
            continue
        if sector < len(before) and before[sector] == cm:
            continue
        bearing = turned + math.radians(first_deg + sector * step_deg)
        yield Echo(bearing, min(cm, most_cm) / 100.0, cm <= most_cm)


@dataclass(frozen=True, slots=True)
class _Cell:
    evidence: float
    seen_s: float


class Sightings:
    """Obstacles that are not on the chart, as far as the vehicle has seen them.

    `area` may run in another thread than `take`, which replaces the cells and never changes them in place.
    """

    def __init__(self, chart: Chart) -> None:
        self._chart = chart
        self._cells: dict[tuple[int, int], _Cell] = {}

    def take(self, echoes: Iterable[Echo], here: Point, now_s: float) -> None:
        """Fold rays in that were taken here; a cell gains once however many rays of them meet it."""
        hits: set[tuple[int, int]] = set()
        rays = list(echoes)
        for ray in rays:
            if ray.is_hit:
                at = here.moved(ray.bearing_rad, ray.range_m)
                if self._chart.clearance_m(at) > SHORE_M:
                    hits.add((math.floor(at.north_m / CELL_M), math.floor(at.east_m / CELL_M)))
        unseen = _Cell(0.0, now_s)
        seen = {
            cell: _Cell(min(self._cells.get(cell, unseen).evidence + 1.0, MOST_EVIDENCE), now_s)
            for cell in hits
        }
        others = {
            cell: replace(known, evidence=known.evidence - _PASSED_THROUGH)
            if _is_passed_through(cell, rays, here)
            else known
            for cell, known in self._cells.items()
            if cell not in hits
        }
        self._cells = {
            cell: known
            for cell, known in (others | seen).items()
            if known.evidence > 0.0 and now_s - known.seen_s < FADE_S
        }

    def area(self, now_s: float) -> Polygon | MultiPolygon:
        """What counts now, east and north in metres; empty if there is nothing.

        Cells within JOINED_M of each other are one obstacle, filled to its convex hull: a ranger sees the
        front of a thing, in pieces.
        """
        squares = [
            shapely.box(column * CELL_M, row * CELL_M, (column + 1) * CELL_M, (row + 1) * CELL_M)
            for (row, column), known in self._cells.items()
            if known.evidence >= CONFIRMED and now_s - known.seen_s < FADE_S
        ]
        if not squares:
            return Polygon()
        joined = shapely.union_all([square.buffer(0.5 * JOINED_M) for square in squares])
        hulls = [
            shapely.union_all([square for square in squares if cluster.intersects(square)]).convex_hull
            for cluster in shapely.get_parts(joined)
        ]
        area: Polygon | MultiPolygon = shapely.union_all(hulls)
        return area


def _is_passed_through(cell: tuple[int, int], rays: Sequence[Echo], here: Point) -> bool:
    """Whether a ray from here passes through a cell: what it showed is not there, or not any more."""
    row, column = cell
    north = (row + 0.5) * CELL_M - here.north_m
    east = (column + 0.5) * CELL_M - here.east_m
    for ray in rays:
        along = north * math.cos(ray.bearing_rad) + east * math.sin(ray.bearing_rad)
        off = abs(east * math.cos(ray.bearing_rad) - north * math.sin(ray.bearing_rad))
        if off <= 0.5 * CELL_M and 0.0 < along < ray.range_m - CELL_M:
            return True
    return False
