"""Draws mill_pond.geojson beside this file: an invented pond for scenarios, tests and pictures.

Shores are given as a few control points in metres (east, north) of 50.0° N 1.2° W, roughened once by
displacing midpoints with a fixed seed, and rounded by a closed Catmull-Rom spline. Run again after a change:

    python examples/maps/draw_mill_pond.py
"""

import json
import math
import random
from pathlib import Path
from typing import Any

from companion.core.geo import LatLon, LocalFrame, Point
from mission_tools.geojson import collection, feature

Ring = list[tuple[float, float]]

NOTE = "Fictional: drawn for mavboat, no such pond exists. Not for navigation."
FRAME = LocalFrame(LatLon(50.0, -1.2))

SHORE: Ring = [
    (-298, 12), (-290, 62), (-252, 98), (-222, 132), (-232, 178), (-206, 222), (-166, 232), (-134, 204),
    (-116, 158), (-92, 106), (-78, 158), (-52, 196), (-26, 230), (22, 252), (76, 240),
    (108, 204), (140, 178), (172, 188), (194, 222),
    (206, 262), (226, 296), (243, 300), (240, 270), (230, 226), (222, 186), (244, 154), (282, 124), (302, 66),
    (288, 14), (246, -10), (196, -22), (186, -40), (214, -62), (262, -92), (272, -146), (232, -190),
    (172, -196), (134, -168), (98, -176), (62, -222), (4, -246), (-58, -232), (-82, -190), (-112, -166),
    (-152, -184), (-204, -206), (-250, -180), (-262, -132), (-232, -92), (-192, -70), (-188, -50),
    (-226, -34), (-280, -24),
]  # fmt: skip

ISLANDS: dict[str, Ring] = {
    "Alder Island": [
        (-126, -32), (-118, -4), (-88, 8), (-58, -6), (-34, 14), (-6, 16), (6, -8), (-10, -36), (-44, -52),
        (-74, -44), (-102, -54),
    ],
    "Heron Island": [(74, 98), (80, 124), (104, 136), (132, 122), (138, 96), (124, 82), (116, 58), (94, 66)],
    "Willow Ait": [(16, -112), (34, -98), (62, -96), (90, -106), (96, -116), (74, -120), (44, -124),
                   (22, -122)],
}  # fmt: skip

STRUCTURES: dict[str, tuple[str, Ring]] = {
    "Boathouse Pier": ("pier", [(-246, -186), (-243, -189), (-211, -157), (-206, -162), (-203, -159),
                                (-214, -148), (-217, -151), (-214, -154)]),
    "Anglers' Raft": ("raft", [(-124, -110), (-114, -106), (-116.5, -99), (-126.5, -103)]),
    "Diving Raft": ("raft", [(50, 0), (59, -4), (63, 5), (54, 9)]),
    "Sluice Raft": ("raft", [(176, 166), (185, 169), (183, 176), (174, 173)]),
}  # fmt: skip

SWIMMING: Ring = [(-36, 222), (-30, 172), (-6, 158), (40, 164), (66, 186), (82, 238), (30, 262)]

LANDMARKS: dict[str, tuple[float, float]] = {
    "Boathouse": (-256, -197),
    "The Beach": (24, 262),
    "Old Mill": (250, 306),
}


def roughened(ring: Ring, rng: random.Random, share: float) -> Ring:
    """Insert a midpoint into every side, displaced square to it by up to a share of its length."""
    rough: Ring = []
    for (x0, y0), (x1, y1) in zip(ring, ring[1:] + ring[:1], strict=True):
        shift = rng.uniform(-share, share)
        rough += [(x0, y0), ((x0 + x1) / 2 + shift * (y1 - y0), (y0 + y1) / 2 - shift * (x1 - x0))]
    return rough


def rounded(ring: Ring, steps: int) -> Ring:
    """A closed uniform Catmull-Rom spline through the ring's points."""
    count = len(ring)
    curve: Ring = []
    for i in range(count):
        p0, p1, p2, p3 = (ring[(i + k) % count] for k in (-1, 0, 1, 2))
        for step in range(steps):
            t = step / steps
            x, y = (_catmull_rom(*knots, t) for knots in zip(p0, p1, p2, p3, strict=True))
            curve.append((x, y))
    return curve


def _catmull_rom(a: float, b: float, c: float, d: float, t: float) -> float:
    cubic = (3 * b - a - 3 * c + d) * t**3
    return 0.5 * (2 * b + (c - a) * t + (2 * a - 5 * b + 4 * c - d) * t * t + cubic)


def position(east_m: float, north_m: float) -> list[float]:
    """GeoJSON's [longitude, latitude] in 1e-7 degrees, about a centimetre."""
    at = FRAME.to_global(Point(north_m, east_m))
    return [round(at.lon_deg, 7), round(at.lat_deg, 7)]


def polygon(name: str, kind: str, ring: Ring) -> dict[str, Any]:
    """A feature with one counter-clockwise ring, as RFC 7946 asks."""
    area = math.fsum(x0 * y1 - x1 * y0 for (x0, y0), (x1, y1) in zip(ring, ring[1:] + ring[:1], strict=True))
    turned = ring if area > 0 else ring[::-1]
    corners = [position(*at) for at in [*turned, turned[0]]]
    return feature("Polygon", [corners], name=name, kind=kind)


def mill_pond() -> dict[str, Any]:
    """The whole FeatureCollection."""
    rng = random.Random(1786)
    water = polygon("Mill Pond", "water", rounded(roughened(SHORE, rng, 0.13), 5))
    water["properties"]["note"] = NOTE
    islands = [
        polygon(name, "island", rounded(roughened(ring, rng, 0.12), 4)) for name, ring in ISLANDS.items()
    ]
    structures = [polygon(name, kind, ring) for name, (kind, ring) in STRUCTURES.items()]
    swimming = polygon("Swimming area", "swimming", rounded(SWIMMING, 5))
    landmarks = [
        feature("Point", position(*at), name=name, kind="landmark") for name, at in LANDMARKS.items()
    ]
    return collection([water, *islands, *structures, swimming, *landmarks], name="Mill Pond")


def main() -> None:
    """Write the file, one feature a line."""
    pond = mill_pond()
    features = ",\n".join(json.dumps(one, separators=(",", ":")) for one in pond["features"])
    text = f'{{"type":"FeatureCollection","name":"{pond["name"]}","features":[\n{features}\n]}}\n'
    Path(__file__).with_name("mill_pond.geojson").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
