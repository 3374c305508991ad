"""Random worlds from a seed: the scenario's table [random] draws water, weather and faults.

The scenario's own tables override it. Start and goal lie in one region of free water, so a route that keeps
the clearance always exists, and the start leaves room for the drift while booting.
"""

import math
from random import Random
from typing import Annotated, Any

import shapely
from msgspec import Meta
from shapely.geometry import Polygon

from companion.config.section import NonNegative, Positive, Section
from sitl.world.faults.catalogue import CATALOGUE
from sitl.world.sampling import generator

Tree = dict[str, Any]
Place = tuple[float, float]  # east and north, metres
Crowd = Annotated[int, Meta(ge=0, le=1000)]  # with 1000 of each a world is drawn in some seconds

_BOOT_S = 8.0  # from the first drift to the first thrust
_LEEWAY = 0.06  # share of the wind speed: the drift of a boat without thrust
_SPARE_M = 1.0  # of clearance at start and goal beyond what is asked for
_TRIES = 20  # at a world, each with an islet less
_PAIRS = 200  # at start and goal in one world
_STARTS_S = (8.0, 60.0)  # when a fault begins
_LASTS_S = (5.0, 60.0)
_FITTED = sorted(CATALOGUE.keys() - {"rc", "leak", "thermometer", "cpu"})  # what seeds choose from
_PASSING = frozenset(("computer",))  # without power for good, there is nothing left to watch


class RandomWater(Section, frozen=True):
    """How large and how crowded the water, how strong current and gusts at most, and whether a part fails.

    distance_m: from start to goal as the crow flies, least and most.
    """

    across_m: Annotated[float, Meta(ge=30.0, le=5000.0)] = 200.0
    islands: Crowd = 8
    rafts: Crowd = 5
    rocks: Crowd = 8
    distance_m: tuple[float, float] = (90.0, 150.0)
    clearance_m: Positive = 4.0
    current_m_s: NonNegative = 1.0
    gust_m_s: NonNegative = 8.0
    fault: bool = False


def random_world(settings: RandomWater, seed: int) -> Tree:
    """The tables [map], [route], [environment] and, where asked for, [[faults]].

    Raises ValueError: no water of the asked size has room for a way of the asked length.
    """
    random = generator(seed, "world")
    weather = _weather(settings, generator(seed, "weather"))
    tree = _waters(settings, random, _drift_m(weather)) | {"environment": weather}
    if settings.fault:
        tree["faults"] = [_fault(generator(seed, "mishap"))]
    return tree


def _drift_m(weather: Tree) -> Place:
    """The longest drift while the boat boots and receives its mission."""
    towards = math.radians(weather["current_to_deg"])
    blown = math.radians(weather["wind_from_deg"] + 180.0)
    current_m, leeway_m = weather["current_m_s"] * _BOOT_S, _LEEWAY * weather["gust_m_s"] * _BOOT_S
    return (
        current_m * math.sin(towards) + leeway_m * math.sin(blown),
        current_m * math.cos(towards) + leeway_m * math.cos(blown),
    )


def _waters(settings: RandomWater, random: Random, drift_m: Place) -> Tree:
    low_m, high_m = settings.distance_m
    for attempt in range(_TRIES):
        crowd = 1.0 - attempt / _TRIES
        shore = _blob(random, 0.0, 0.0, 0.5 * settings.across_m, 0.12, 60)
        things = [
            *(
                _thing("island", n, _round(random, shore, (3.0, 9.0), 0.2, 16))
                for n in range(round(crowd * settings.islands))
            ),
            *(_thing("raft", n, _raft(random, shore)) for n in range(round(crowd * settings.rafts))),
            *(
                _thing("obstacle", n, _round(random, shore, (0.4, 1.5), 0.15, 8))
                for n in range(round(crowd * settings.rocks))
            ),
        ]
        solid = shapely.union_all([Polygon(thing["polygon"]) for thing in things])
        free = Polygon(shore).difference(solid).buffer(-(settings.clearance_m + _SPARE_M))
        largest = max(shapely.get_parts(free), key=lambda part: part.area, default=Polygon())
        ends = None if largest.is_empty else _ends(random, largest, low_m, high_m, drift_m)
        if ends is not None:
            return {
                "map": {"name": "Random water", "water": shore, "obstacles": things},
                "route": {"start": ends[0], "goal": ends[1], "clearance_m": settings.clearance_m},
            }
    raise ValueError(
        f"random: no way of {low_m:g} to {high_m:g} m in a water {settings.across_m:g} m across: "
        "expected a shorter distance_m, a larger across_m or a smaller clearance_m"
    )


def _ends(
    random: Random, free: Polygon, low_m: float, high_m: float, drift_m: Place
) -> tuple[Place, Place] | None:
    """Start and goal, if possible with something between them. From the start it may drift by drift_m."""
    found = None
    for _ in range(_PAIRS):
        start, goal = _place(random, free), _place(random, free)
        adrift = start[0] + drift_m[0], start[1] + drift_m[1]
        if low_m <= math.dist(start, goal) <= high_m and free.covers(shapely.LineString((start, adrift))):
            found = start, goal
            if not free.covers(shapely.LineString(found)):
                break
    return found


def _weather(settings: RandomWater, random: Random) -> Tree:
    gust_m_s = random.uniform(0.0, settings.gust_m_s)
    return {
        "current_m_s": random.uniform(0.0, settings.current_m_s),
        "current_to_deg": random.uniform(0.0, 360.0),
        "wind_m_s": random.uniform(0.4, 0.8) * gust_m_s,
        "gust_m_s": gust_m_s,
        "wind_from_deg": random.uniform(0.0, 360.0),
    }


def _fault(random: Random) -> Tree:
    """One fault of any part that every boat has, of any kind, of the usual size; for a while or for good."""
    what = random.choice(_FITTED)
    kind = random.choice(sorted(CATALOGUE[what]))
    fault: Tree = {"what": what, "kind": kind, "at_s": random.uniform(*_STARTS_S)}
    for_s, towards_deg = random.uniform(*_LASTS_S), random.uniform(0.0, 360.0)
    if random.random() < 0.5 or what in _PASSING:
        fault["for_s"] = for_s
    return fault | {"towards_deg": towards_deg}


def _thing(kind: str, number: int, polygon: list[Place]) -> Tree:
    named = {"island": "Islet", "raft": "Raft", "obstacle": "Rock"}[kind]
    return {"name": f"{named} {number + 1}", "kind": kind, "polygon": polygon}


def _round(
    random: Random, shore: list[Place], radii_m: tuple[float, float], roughness: float, corners: int
) -> list[Place]:
    east_m, north_m = _place(random, Polygon(shore))
    return _blob(random, east_m, north_m, random.uniform(*radii_m), roughness, corners)


def _raft(random: Random, shore: list[Place]) -> list[Place]:
    east_m, north_m = _place(random, Polygon(shore))
    length_m, width_m, angle = (
        random.uniform(3.0, 7.0),
        random.uniform(1.5, 3.0),
        random.uniform(0.0, math.pi),
    )
    cos, sin = math.cos(angle), math.sin(angle)
    corners = [(0.5 * a * length_m, 0.5 * b * width_m) for a, b in ((1, 1), (-1, 1), (-1, -1), (1, -1))]
    return [_rounded(east_m + x * cos - y * sin, north_m + x * sin + y * cos) for x, y in corners]


def _blob(
    random: Random, east_m: float, north_m: float, radius_m: float, roughness: float, corners: int
) -> list[Place]:
    """A wobbly outline: a radius with a few harmonics, so that it never crosses itself."""
    waves = [
        (order, random.uniform(0.3, 1.0) * roughness * 2.0 / order, random.uniform(0.0, 2.0 * math.pi))
        for order in range(2, 7)
    ]
    outline = []
    for corner in range(corners):
        angle = 2.0 * math.pi * corner / corners
        wobble = sum(size * math.cos(order * angle + phase) for order, size, phase in waves)
        reach_m = radius_m * max(0.3, 1.0 + wobble)
        outline.append(_rounded(east_m + reach_m * math.cos(angle), north_m + reach_m * math.sin(angle)))
    return outline


def _place(random: Random, area: Polygon) -> Place:
    """A point of an area, each as likely as the next."""
    west, south, east, north = area.bounds
    while True:
        place = _rounded(random.uniform(west, east), random.uniform(south, north))
        if shapely.contains_xy(area, *place):
            return place


def _rounded(east_m: float, north_m: float) -> Place:
    return round(east_m, 2), round(north_m, 2)
