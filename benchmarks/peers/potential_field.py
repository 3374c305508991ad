"""Artificial potential field with ant colony optimisation, after the paper's reference [9].

The colony gives a path over the whole map; the field leads from point to point of it. The goal of the field
is the farthest point of the colony's path in reach that the boat sees. It attracts with unit force; a shore
pushes away with a power function of how far the boat has come into its range, so that the force rises
smoothly from zero and the boat does not zigzag. A step that would not keep the clearance is turned until it
does.
"""

import math

from benchmarks.peers.ants import improved_ant_colony
from benchmarks.peers.interface import Deadline, NoPath, Path, Sea
from companion.core.geo import Point, distance_m

RANGE_CLEARANCES = 1.5  # beyond the clearance, the range of a shore's push
POWER = 2.0
PUSH = 1.2  # at the clearance itself, in the attraction
STEP_CLEARANCES = 0.5
MOST_STEPS = 6000
_TURNS_RAD = [sign * math.radians(angle) for angle in range(0, 180, 15) for sign in (1.0, -1.0)]


def field_and_ants(sea: Sea, start: Point, goal: Point, seed: int, deadline: Deadline) -> Path:
    """The track of a boat in the field along the colony's path."""
    guide = improved_ant_colony(sea, start, goal, seed, deadline)
    step_m = max(STEP_CLEARANCES * sea.clearance_m, 0.002 * distance_m(start, goal))
    track, aim = [start], 1
    for _ in range(MOST_STEPS):
        deadline.check()
        here = track[-1]
        while aim < len(guide) - 1 and sea.is_clear(here, guide[aim + 1]):
            aim += 1
        if distance_m(here, goal) <= step_m and sea.is_clear(here, goal):
            return (*track, goal)
        track.append(_step(sea, here, guide[aim], step_m))
        if distance_m(track[-1], guide[aim]) <= step_m and aim < len(guide) - 1:
            aim += 1
    raise NoPath(f"the field did not lead to the goal in {MOST_STEPS} steps")


def _step(sea: Sea, here: Point, aim: Point, step_m: float) -> Point:
    """One step along the force, or turned from it as little as keeps the clearance."""
    length_m = max(distance_m(here, aim), 1e-9)
    north, east = (aim.north_m - here.north_m) / length_m, (aim.east_m - here.east_m) / length_m
    push_north, push_east = _push(sea, here)
    heading = math.atan2(east + push_east, north + push_north)
    length_m = min(step_m, length_m)
    for share in (1.0, 0.25):
        for turn in _TURNS_RAD:
            there = Point(
                here.north_m + share * length_m * math.cos(heading + turn),
                here.east_m + share * length_m * math.sin(heading + turn),
            )
            if sea.is_clear(here, there):
                return there
    raise NoPath("the field led into a corner without a way out")


def _push(sea: Sea, here: Point) -> tuple[float, float]:
    """The shore's push: away from it, along the gradient of the distance."""
    range_m = RANGE_CLEARANCES * sea.clearance_m
    distance = sea.water.distance_m(here)
    inside = 1.0 - (distance - sea.clearance_m) / range_m if range_m else 0.0
    if inside <= 0.0:
        return 0.0, 0.0
    probe_m = 0.01 * range_m
    north = sea.water.distance_m(Point(here.north_m + probe_m, here.east_m)) - distance
    east = sea.water.distance_m(Point(here.north_m, here.east_m + probe_m)) - distance
    slope = math.hypot(north, east)
    if not slope:
        return 0.0, 0.0
    force = PUSH * min(inside, 1.0) ** POWER
    return force * north / slope, force * east / slope
