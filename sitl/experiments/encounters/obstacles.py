"""The waters of the encounters: a leg of LEG_M northward, and what is in its way, drawn from a seed.

lone      one round rock on the leg
gap       a wall across the leg with one way through, 5 m wide and up to 6 m aside
field     rocks with room between any two of them
dense     rocks half a metre apart and more: the boat must often turn back
head_on   something round comes along the leg towards the boat
crossing  something round crosses the leg from one side
shore     a wavy shore 2.0 to 3.5 m beside the leg, all along it
"""

import math
from random import Random
from typing import Any, Final, Literal, NamedTuple

from companion.core.geo import Point
from sitl.world.sampling import generator

Kind = Literal["lone", "gap", "field", "dense", "head_on", "crossing", "shore"]
Tree = dict[str, Any]

LEG_M: Final = 60.0
MOVER_RADIUS_M: Final = 0.5
_UNDER_WAY_S: Final = 25.0  # what moves sets out so long before the boat would meet it
_MEETS_M: Final = (22.0, 38.0)  # along the leg
_OFF_M: Final = 0.5  # so far beside the boat, at most, it would pass: a collision with a hull, or nearly


class Meeting(NamedTuple):
    """Where and when the boat would be if nothing were in its way, and how fast on which course."""

    time_s: float
    at: Point
    course_rad: float


def still_obstacles(kind: Kind, seed: int) -> Tree:
    """The table [map] of what lies still."""
    random = generator(seed, f"encounter/{kind}")
    if kind == "lone":
        return _map([(random.uniform(22.0, 38.0), random.uniform(-1.0, 1.0), random.uniform(0.3, 2.0))])
    if kind == "gap":
        return _wall(random)
    if kind == "field":
        return _map(_rocks(random, 9, 8.0, 4.0))
    if kind == "dense":
        return _map(_rocks(random, 14, 8.0, 0.5))
    if kind == "shore":
        return _shore(random)
    return {}


def meets_at_m(kind: Kind, seed: int) -> float:
    """How far along the leg what moves would meet the boat."""
    return generator(seed, f"encounter/{kind}/meeting").uniform(*_MEETS_M)


def mover(kind: Kind, seed: int, speed_m_s: float, meeting: Meeting) -> Tree:
    """The one of [[movers]] that is on a collision course with a boat that sails on."""
    random = generator(seed, f"encounter/{kind}")
    if kind == "head_on":
        course = meeting.course_rad + math.pi + random.uniform(-0.2, 0.2)
    else:
        course = meeting.course_rad + random.choice((-1.0, 1.0)) * random.uniform(1.05, 2.1)
    aside_m = random.uniform(-_OFF_M, _OFF_M)
    north_m_s, east_m_s = speed_m_s * math.cos(course), speed_m_s * math.sin(course)
    begins_s = max(meeting.time_s - _UNDER_WAY_S, 0.0)
    for_s = meeting.time_s - begins_s
    north_m = meeting.at.north_m - for_s * north_m_s - aside_m * math.sin(course)
    east_m = meeting.at.east_m - for_s * east_m_s + aside_m * math.cos(course)
    return {
        "start": (east_m, north_m),
        "radius_m": MOVER_RADIUS_M,
        "ais": "A",  # heard if sensors.ais.fitted
        "at_s": begins_s,
        "velocity_m_s": (east_m_s, north_m_s),
    }


def _map(rocks: list[tuple[float, float, float]]) -> Tree:
    each = [
        {"name": f"Rock {number + 1}", "circle": {"centre": (east_m, north_m), "radius_m": radius_m}}
        for number, (north_m, east_m, radius_m) in enumerate(rocks)
    ]
    return {"map": {"obstacles": each}}


def _rocks(random: Random, most: int, aside_m: float, apart_m: float) -> list[tuple[float, float, float]]:
    """North, east and radius of each; none over the leg's ends."""
    rocks: list[tuple[float, float, float]] = []
    for _ in range(8 * most):
        north_m, radius_m = random.uniform(8.0, LEG_M - 8.0), random.uniform(0.3, 2.0)
        east_m = random.uniform(-aside_m, aside_m)
        is_apart = all(math.hypot(north_m - n, east_m - e) > radius_m + r + apart_m for n, e, r in rocks)
        to_ends_m = min(math.hypot(north_m, east_m), math.hypot(north_m - LEG_M, east_m))
        if is_apart and to_ends_m > radius_m + 4.0 and len(rocks) < most:
            rocks.append((north_m, east_m, radius_m))
    return rocks


def _wall(random: Random) -> Tree:
    north_m, middle_m = random.uniform(25.0, 35.0), random.uniform(-6.0, 6.0)
    sides = ((-40.0, middle_m - 2.5), (middle_m + 2.5, 40.0))
    each = [
        {
            "name": name,
            "polygon": [(west, north_m), (east, north_m), (east, north_m + 1.0), (west, north_m + 1.0)],
        }
        for name, (west, east) in zip(("Wall west", "Wall east"), sides, strict=True)
    ]
    return {"map": {"obstacles": each}}


def _shore(random: Random) -> Tree:
    """A shore to one side: three waves of different lengths, drawn at every metre."""
    side = random.choice((-1.0, 1.0))
    waves = [
        (random.uniform(3.0, 25.0), random.uniform(0.1, 0.3), random.uniform(0.0, math.tau)) for _ in range(3)
    ]
    line = []
    for metre in range(-10, int(LEG_M) + 11):
        off_m = 2.75 + sum(
            size * math.sin(math.tau * metre / length + phase) for length, size, phase in waves
        )
        line.append((side * min(max(off_m, 2.0), 3.5), float(metre)))
    behind = [(side * 20.0, LEG_M + 10.0), (side * 20.0, -10.0)]
    return {"map": {"obstacles": [{"name": "Shore", "polygon": [*line, *behind]}]}}
