"""Station keeping as a task with figures: sail to a place a little way off and stay there."""

import math

import numpy as np

from companion.core.geo import LocalFrame, Point, distance_m
from mission_tools.mission.mission import Command, Mission, MissionItem
from sitl.run.recording.recorder import Recorder

STATION = "station"
AWAY_M = 10.0
STAY_S = 600.0
NEAR_M = 1.0


def station_mission(frame: LocalFrame, start: Point, stay_s: float = STAY_S) -> Mission:
    """Stay for stay_s at the place AWAY_M north of the start."""
    there = frame.to_global(Point(start.north_m + AWAY_M, start.east_m))
    stay = MissionItem.at(there, Command.NAV_LOITER_TIME, (stay_s, 0.0, 0.0, math.nan))
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
