"""Courses for path-following tests, on which other autopilots have been measured, too.

    straight    200 m north
    zigzag      five right angles, alternately to starboard and to port, on legs of 50 m
    square      50 m a side, to starboard, back to where it began
    station     sail to a place 10 m off and stay there for ten minutes

What is measured comes from the truth. The *cross-track error* is the distance to the line of the leg being
sailed, so that a corner that is cut counts with how far inside it the boat was. The *path error* is the
distance to the nearest place of the whole planned line. The *overshoot* of a corner is how far the boat goes
beyond the new leg, seen from the inside of the corner, while it sails the first OVERSHOOT_M of it. Its *cut*
is the distance at which the boat passes the waypoint. A run's overshoot and cut are those of its worst
corner.

The boat starts at rest, so a current displaces it before it gathers speed. That displacement is reported
separately (*start*); the other figures count from RUN_IN_M along the first leg.
"""

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import shapely

from companion.core.geo import Line, LocalFrame, Point, distance_m
from companion.core.units import wrap_pi
from mission_tools.mission.mission import Command, Mission, MissionItem
from mission_tools.mission.route import mission_along
from sitl.run.recording.recorder import Recorder

if TYPE_CHECKING:
    from numpy.typing import NDArray

RUN_IN_M = 15.0  # of the first leg, within which the boat gathers way
OVERSHOOT_M = 20.0  # of the new leg, within which a corner is sailed out

COURSES: dict[str, tuple[Point, ...]] = {
    "straight": (Point(0.0, 0.0), Point(200.0, 0.0)),
    "zigzag": (
        Point(0.0, 0.0),
        Point(50.0, 0.0),
        Point(50.0, 50.0),
        Point(100.0, 50.0),
        Point(100.0, 100.0),
        Point(150.0, 100.0),
        Point(150.0, 150.0),
    ),
    "square": (Point(0.0, 0.0), Point(50.0, 0.0), Point(50.0, 50.0), Point(0.0, 50.0), Point(0.0, 0.0)),
}


STATION = "station"
AWAY_M = 10.0
STAY_S = 600.0
NEAR_M = 1.0


def course_mission(name: str, frame: LocalFrame, start: Point) -> Mission:
    """A course laid out from where the boat lies. Raises KeyError: no such course."""
    points = [Point(start.north_m + at.north_m, start.east_m + at.east_m) for at in COURSES[name]]
    return mission_along([frame.to_global(point) for point in points])


def tracking(recorder: Recorder, planned: Sequence[Point]) -> dict[str, float | None]:
    """The figures of a run along a planned line; none when no leg was sailed beyond the run-in.

    kept_*: cross-track error; path_*: path error; overshoot_m and cut_m are None without a corner.
    """
    cross = np.abs(recorder.cross_track_m(planned))
    begun = _begun(recorder, planned)
    if begun >= len(cross):
        return {}
    track = np.asarray(recorder.track(), dtype=np.float64)[recorder.legs >= 0]
    off, kept = off_path_m(track[begun:], planned), cross[begun:]
    corners = corners_sailed(recorder, planned)
    return {
        "path_rms_m": math.sqrt(float(np.mean(off * off))),
        "path_max_m": float(off.max()),
        "kept_rms_m": math.sqrt(float(np.mean(kept * kept))),
        "kept_max_m": float(kept.max()),
        "start_max_m": float(cross[: begun + 1].max()),
        "overshoot_m": max((corner.beyond_m for corner in corners), default=None),
        "cut_m": max((corner.cut_m for corner in corners), default=None),
    }


def _begun(recorder: Recorder, planned: Sequence[Point]) -> int:
    """Which of the ticks with a leg is the first beyond the run-in."""
    if len(planned) < 2:
        return 0
    first = Line(planned[0], planned[1])
    run_in_m = min(RUN_IN_M, 0.5 * first.length_m)
    sailed = [(at, leg) for at, leg in zip(recorder.track(), recorder.legs.tolist(), strict=True) if leg >= 0]
    for tick, (at, leg) in enumerate(sailed):
        if leg > 0 or first.along_and_cross_track_m(at)[0] >= run_in_m:
            return tick
    return len(sailed)


class Corner(NamedTuple):
    """How far the boat went beyond the new leg, 0 where it did not, and how near it came to the waypoint."""

    beyond_m: float
    cut_m: float


def corners_sailed(recorder: Recorder, planned: Sequence[Point]) -> list[Corner]:
    """The corners that were reached, in order."""
    track = np.asarray(recorder.track(), dtype=np.float64)
    lines = [Line(a, b) for a, b in pairwise(planned)]
    found = []
    for leg, (before, after) in enumerate(pairwise(lines), start=1):
        turn_rad = wrap_pi(after.course_rad - before.course_rad)
        onto = track[recorder.legs == leg]
        if not turn_rad or not len(onto):
            continue
        near = track[(recorder.legs == leg) | (recorder.legs == leg - 1)]
        cut_m = float(np.hypot(near[:, 0] - after.start.north_m, near[:, 1] - after.start.east_m).min())
        beyond_m = 0.0
        for north_m, east_m in onto.tolist():
            along_m, cross_m = after.along_and_cross_track_m(Point(north_m, east_m))
            if along_m <= OVERSHOOT_M:
                beyond_m = max(beyond_m, -math.copysign(cross_m, cross_m * turn_rad))
        found.append(Corner(beyond_m, cut_m))
    return found


def off_path_m(track: "NDArray[np.float64]", planned: Sequence[Point]) -> "NDArray[np.float64]":
    """Distance of each place of a track, north and east, to the nearest one of the planned line."""
    line = shapely.LineString(np.asarray([*planned, planned[-1]], dtype=np.float64))
    off_m: NDArray[np.float64] = shapely.distance(shapely.points(track), line)
    return off_m


def station_mission(frame: LocalFrame, start: Point) -> Mission:
    """Stay for STAY_S at the place AWAY_M north of the start."""
    there = frame.to_global(Point(start.north_m + AWAY_M, start.east_m))
    stay = MissionItem.at(there, Command.NAV_LOITER_TIME, (STAY_S, 0.0, 0.0, math.nan))
    return Mission((stay,), home=frame.to_global(start))


def station_figures(recorder: Recorder, station: Point) -> dict[str, float | None]:
    """Distances to the station from the moment it was first reached within NEAR_M until the end.

    station_near_share: share of that time within NEAR_M; None, like the others, when it was never reached.
    """
    away_m = np.asarray([distance_m(at, station) for at in recorder.track()])
    near = away_m <= NEAR_M
    if not near.any():
        return dict.fromkeys(("station_s", "station_near_share", "station_95_m", "station_max_m"))
    first = int(near.argmax())
    times_s = recorder.rows[first:, 0]
    return {
        "station_s": float(times_s[-1] - times_s[0]),
        "station_near_share": float(near[first:].mean()),
        "station_95_m": float(np.percentile(away_m[first:], 95.0)),
        "station_max_m": float(away_m[first:].max()),
    }
