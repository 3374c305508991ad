"""Approximate lengths of the ways between many places at once, to choose an order by.

The ways lead along a Delaunay triangulation of the places and the corners of the shore, those of its edges
that lie in the water, and along the straight lines between near places. They are never shorter than the true
ways and, in a triangulation, seldom more than a few hundredths longer.
"""

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry import Polygon

Array = NDArray[np.float64]
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
