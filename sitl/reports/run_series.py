"""What the pictures of a run show over time: fault and mode spans, braking, cross-track error."""

import math
from itertools import pairwise

import numpy as np

from companion.core.modes import Mode
from sitl.reports.run_record import Numbers, RunRecord
from sitl.run.recording.recorder import cross_track_m
from sitl.run.timeline import OVER

_ASTERN = 0.1  # of full command: less is the dead band of a boat that keeps its position
_MOVING_M_S = 0.1
_ONE_BRAKE_S = 1.0  # motors that go astern again within this time continue the same braking


def cross_track_errors_m(record: RunRecord) -> Numbers:
    """Signed distance to the line of the current leg, starboard positive; NaN without a leg."""
    out = np.full(len(record.legs), np.nan)
    if len(record.planned) > 1:
        at = np.column_stack((record.truth["north_m"], record.truth["east_m"]))
        out[record.legs >= 0] = cross_track_m(at, record.legs, record.planned)
    return out


def fault_spans(record: RunRecord) -> list[tuple[float, float, str]]:
    """Begin, end and name of each fault; one that lasts ends with the run."""
    open_since: dict[str, float] = {}
    spans = []
    for event in record.events:
        if event.kind == "fault":
            name = event.text.removesuffix(OVER)
            if name == event.text:
                open_since[name] = event.time_s
            elif name in open_since:
                spans.append((open_since.pop(name), event.time_s, name))
    end_s = float(record.truth["time_s"][-1]) if len(record.truth["time_s"]) else 0.0
    spans += [(begin_s, max(end_s, begin_s), name) for name, begin_s in open_since.items()]
    return sorted(spans)


def brakes(record: RunRecord) -> list[tuple[float, float]]:
    """Begin and end of each time that both motors went astern while the boat moved ahead."""
    times = record.estimates["time_s"]
    if not len(times):
        return []
    ahead_m_s = at_estimates(record, record.truth["surge_m_s"])
    astern = np.maximum(record.estimates["left"], record.estimates["right"]) < -_ASTERN
    flags = np.concatenate(([False], astern & (ahead_m_s > _MOVING_M_S), [False])).astype(np.int8)
    begins, ends = np.flatnonzero(np.diff(flags) == 1), np.flatnonzero(np.diff(flags) == -1) - 1
    found: list[tuple[float, float]] = []
    for begin_s, end_s in zip(times[begins].tolist(), times[ends].tolist(), strict=True):
        if found and begin_s - found[-1][1] < _ONE_BRAKE_S:
            found[-1] = found[-1][0], end_s
        else:
            found.append((begin_s, end_s))
    return found


def mode_spans(record: RunRecord) -> list[tuple[float, float, str]]:
    """Begin, end and name of each mode."""
    times, modes = record.estimates["time_s"], record.estimates["mode"]
    if not len(times):
        return []
    changes = [0, *(np.flatnonzero(np.diff(modes)) + 1).tolist(), len(times) - 1]
    return [
        (float(times[a]), float(times[b]), Mode(int(modes[a])).name)
        for a, b in pairwise(changes)
        if b > a or len(changes) == 2
    ]


def at_estimates(record: RunRecord, column: Numbers) -> Numbers:
    """A column of the truth at the times of the estimates."""
    return np.interp(record.estimates["time_s"], record.truth["time_s"], column)


def wrapped_deg(angle_rad: Numbers) -> Numbers:
    wrapped: Numbers = np.degrees(np.mod(angle_rad + math.pi, 2.0 * math.pi) - math.pi)
    return wrapped
