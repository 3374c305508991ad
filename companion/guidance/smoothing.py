"""Smooth path along legs: straight lines joined by fillets, with the speed limit at each place.

A pure function of places, hull, current and speed. The path ends at the last place or at a corner too sharp
for a fillet, where the boat turns on the spot and a new path begins.

Fillets are chosen from last to first, so that each knows the speed limit of the path behind it. The speed
profile (`speed_profile.py`) is then applied to the whole.
"""

import math
from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import NamedTuple

from companion.config.boat_config import BoatConfig
from companion.core.geo import Line, Point
from companion.core.units import wrap_pi
from companion.guidance.fillet import LEAST_TURN_RAD, Bend, Fillet, best_fillet
from companion.guidance.path import Node, Path
from companion.guidance.speed_profile import with_speeds

LEG_SHARE = 0.5  # of a leg may be used by the fillet at either end

Corner = tuple[Point, Point, Point]  # the places before, at and behind it


class SmoothPath(NamedTuple):
    """marks_m: along-track distance of each place. entries_m, exits_m: begin and end of the fillet at each
    place, the place itself without one. fillets: by their corners.
    """

    path: Path
    marks_m: tuple[float, ...]
    entries_m: tuple[float, ...]
    exits_m: tuple[float, ...]
    fillets: Mapping[Corner, Fillet]


def smooth(
    places: Sequence[Point],
    radius_m: float,
    speed_m_s: float,
    current_m_s: tuple[float, float],
    config: BoatConfig,
    kept: Mapping[Corner, Fillet] | None = None,
) -> SmoothPath:
    """The path from the first place to the last, or to the first corner without a fillet.

    places: two or more, no two consecutive ones equal. current_m_s: north and east. kept: fillets to reuse.
    """
    lines = [Line(one, other) for one, other in pairwise(places)]
    fillets = _fillets(places, lines, radius_m, speed_m_s, current_m_s, config, kept or {})
    nodes = [Node(*places[0], lines[0].course_rad, speed_m_s)]
    ends: list[tuple[int, int, int]] = [(0, 0, 0)]  # nodes at entry, middle and exit of each place
    used: dict[Corner, Fillet] = {}
    course = lines[0].course_rad
    for n, line in enumerate(lines):
        fillet, at, first = fillets[n], line.end, len(nodes)
        turn = wrap_pi(lines[n + 1].course_rad - course) if n + 1 < len(lines) else math.pi
        if fillet is not None:
            nodes.extend(
                Node(at.north_m + north, at.east_m + east, course + turned, speed)
                for north, east, turned, speed in fillet.nodes
            )
            middle = min(range(len(fillet.nodes)), key=lambda k: math.hypot(*fillet.nodes[k][:2]))
            ends.append((first, first + middle, len(nodes) - 1))
            used[places[n], at, places[n + 2]] = fillet
        else:
            nodes.append(Node(*at, course, speed_m_s if abs(turn) <= LEAST_TURN_RAD else 0.0))
            ends.append((first, first, first))
            if abs(turn) > LEAST_TURN_RAD:
                break
        course += turn
    path = Path(with_speeds(nodes, [(one, other) for one, _, other in ends], speed_m_s, config))
    along_m = Path(nodes).along_m
    entries, marks, exits = ([along_m(end[which]) for end in ends] for which in range(3))
    return SmoothPath(path, tuple(marks), tuple(entries), tuple(exits), used)


def _fillets(
    places: Sequence[Point],
    lines: Sequence[Line],
    radius_m: float,
    speed_m_s: float,
    current_m_s: tuple[float, float],
    config: BoatConfig,
    kept: Mapping[Corner, Fillet],
) -> list[Fillet | None]:
    """Fillets at the end of each line, from last to first."""
    fillets: list[Fillet | None] = [None] * len(lines)
    entry_m, entry_m_s = 0.0, 0.0  # of the next fillet: distance before its place, speed
    for n in range(len(lines) - 2, -1, -1):
        line, onward = lines[n], lines[n + 1]
        turn = wrap_pi(onward.course_rad - line.course_rad)
        corner = (places[n], places[n + 1], places[n + 2])
        fillet = kept.get(corner)
        if fillet is None:
            bend = Bend(
                line.course_rad,
                turn,
                LEG_SHARE * line.length_m,
                LEG_SHARE * onward.length_m,
                radius_m,
                speed_m_s,
                current_m_s[0],
                current_m_s[1],
                onward.length_m - entry_m,
                entry_m_s,
            )
            fillet = best_fillet(bend, config)
        fillets[n] = fillet
        if fillet is not None:
            entry_m, entry_m_s = fillet.entry_m, fillet.nodes[0][3]
        elif abs(turn) <= LEAST_TURN_RAD:
            room_m = onward.length_m - entry_m
            entry_m = 0.0
            entry_m_s = math.sqrt(entry_m_s * entry_m_s + 2.0 * config.guidance.accel_m_s2 * room_m)
        else:
            entry_m, entry_m_s = 0.0, 0.0
    return fillets
