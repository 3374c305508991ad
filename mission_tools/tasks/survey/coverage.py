"""How much of the water a survey covers, and how long the ways in it are."""

import math
from collections.abc import Sequence

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry

from companion.core.geo import Point

Array = NDArray[np.float64]
SAMPLES = 40_000  # of the area: the error of the share is well below 0.1 %


def coverage(path: Sequence[Point], target: BaseGeometry, swath_m: float) -> float:
    """The share of the target that lies within half a swath of the path, by a regular grid of samples."""
    points = sample_points(target, SAMPLES)
    line = shapely.LineString([(point.east_m, point.north_m) for point in path])
    return float(np.mean(is_covered(points, line, swath_m)))


def sample_points(target: BaseGeometry, samples: int) -> Array:
    """A hexagonal grid of about that many points in the target, as (east, north)."""
    side_m = math.sqrt(target.area / samples / (math.sqrt(3.0) / 2.0))
    west, south, east, north = target.bounds
    row_m = side_m * math.sqrt(3.0) / 2.0
    rows = np.arange(south + 0.5 * row_m, north, row_m)
    columns = np.arange(west + 0.25 * side_m, east, side_m)
    grid_x = columns[None, :] + np.where(np.arange(len(rows)) % 2, 0.5 * side_m, 0.0)[:, None]
    points = np.column_stack((grid_x.ravel(), np.repeat(rows, len(columns))))
    shapely.prepare(target)
    found: Array = points[shapely.intersects_xy(target, points[:, 0], points[:, 1])]
    return found


def is_covered(points: Array, path: BaseGeometry, swath_m: float) -> NDArray[np.bool_]:
    """Which points lie within half a swath of a path."""
    shapely.prepare(path)
    found: NDArray[np.bool_] = shapely.dwithin(path, shapely.points(points), 0.5 * swath_m)
    return found


NEIGHBOURS = 12  # of each place that are joined by a straight line where that is clear
UNREACHED = 4.0  # times the straight distance, where the triangulation shows no way


def way_lengths_m(water: Polygon, places: Array, sources: NDArray[np.intp], detail_m: float) -> Array:
    """lengths_m[i, j] from place sources[i] to place sources[j]; places as (east, north), in the water.

    detail_m: how far the outline of the water may be simplified.
    """
    from scipy.sparse import coo_matrix  # noqa: PLC0415  a survey alone needs it
    from scipy.sparse.csgraph import dijkstra  # noqa: PLC0415
    from scipy.spatial import Delaunay, QhullError, cKDTree  # noqa: PLC0415

    corners = shapely.get_coordinates(water.simplify(detail_m))
    nodes = np.unique(np.vstack((places, corners)).round(3), axis=0)
    index = cKDTree(nodes)
    number = index.query(places)[1]
    count = min(NEIGHBOURS + 1, len(nodes))
    near = index.query(nodes[number], k=count)[1].reshape(len(places), count)
    pairs = [np.column_stack((np.repeat(number, count), near.ravel()))]
    try:
        triangles = Delaunay(nodes).simplices
        pairs += [triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [0, 2]]]
    except QhullError:  # all in a line, or fewer than three
        pass
    edges = np.unique(np.sort(np.vstack(pairs), axis=1), axis=0)
    edges = edges[edges[:, 0] != edges[:, 1]]
    around = water.simplify(0.25 * detail_m).buffer(detail_m, quad_segs=1, join_style="bevel")
    shapely.prepare(around)
    edges = edges[shapely.covers(around, shapely.linestrings(nodes[edges]))]
    length_m = np.hypot(*(nodes[edges[:, 0]] - nodes[edges[:, 1]]).T)
    graph = coo_matrix((length_m, (edges[:, 0], edges[:, 1])), shape=(len(nodes), len(nodes))).tocsr()
    ends = number[sources]
    found: Array = dijkstra(graph, directed=False, indices=ends)[:, ends]
    straight_m = np.hypot(*(nodes[ends][:, None] - nodes[ends][None]).transpose(2, 0, 1))
    return np.where(np.isfinite(found), found, UNREACHED * straight_m)
