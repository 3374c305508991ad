"""Errors of replayed estimates against the truth."""

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.estimation.feed import NAV
from companion.core.state import EstimateFault
from sitl.run.sensor_recorder import SensorRecording
from sitl.world.world import Truth

SETTLED_S = 15.0  # after boot
QUANTITIES = {"position": "m", "heading": "°", "velocity": "m/s", "current": "m/s"}
_BITS = {
    "gnss": int(
        EstimateFault.GNSS_LOST
        | EstimateFault.GNSS_FROZEN
        | EstimateFault.GNSS_JUMPING
        | EstimateFault.GNSS_LATE
    ),
    "compass": int(EstimateFault.COMPASS_LOST | EstimateFault.COMPASS_OFF | EstimateFault.COMPASS_LATE),
}

Numbers = NDArray[np.float64]


def errors(nav: Numbers, truth: Numbers) -> dict[str, Numbers]:
    """The size of each error, row by row; NaN without an estimate. current: without leeway in the truth."""

    def of(*names: str) -> Numbers:
        off = [nav[:, NAV.index(name)] - truth[:, Truth._fields.index(name)] for name in names]
        return np.asarray(np.hypot(*off))

    turn = nav[:, NAV.index("heading_rad")] - truth[:, Truth._fields.index("heading_rad")]
    return {
        "position": of("north_m", "east_m"),
        "heading": np.degrees(np.abs((turn + math.pi) % (2.0 * math.pi) - math.pi)),
        "velocity": of("north_m_s", "east_m_s"),
        "current": of("current_north_m_s", "current_east_m_s"),
    }


def figures(recording: SensorRecording, replayed: Mapping[str, Any]) -> dict[str, float]:
    """RMS, 95 % and largest error of each quantity; noticing times and false alarms in seconds.

    A run with a fault: largest errors are those from its beginning until 10 s after its end.
    """
    nav, truth = replayed["nav"], recording.truth
    rows = min(len(nav), len(truth))
    nav, truth = nav[:rows], truth[:rows]
    times = truth[:, 0]
    out: dict[str, float] = {"cpu_us": float(replayed["cpu_us"])}
    faults = recording.settings["faults"]
    counted = times >= SETTLED_S
    begins_s = ends_s = math.inf
    if faults:
        begins_s = faults[0]["at_s"]
        ends_s = begins_s + (faults[0].get("for_s") or math.inf)
    if SETTLED_S < begins_s < math.inf:
        counted = (times >= begins_s) & (times < ends_s + 10.0)
    for name, error in errors(nav, truth).items():
        seen = error[counted & ~np.isnan(error)]
        if len(seen):
            out[f"{name}_rms"] = float(np.sqrt(np.mean(seen * seen)))
            out[f"{name}_95"] = float(np.percentile(seen, 95.0))
            out[f"{name}_max"] = float(seen.max())
    bits = np.nan_to_num(nav[:, NAV.index("faults")]).astype(int)
    sound = (times >= SETTLED_S) & (times < begins_s) if begins_s > SETTLED_S else counted
    out["false_s"] = float(np.count_nonzero(bits[sound])) * 0.1
    if math.isfinite(begins_s) and begins_s > SETTLED_S:
        out |= _noticing(bits, times, begins_s, ends_s, faults[0]["what"])
    return out


def _noticing(
    bits: "NDArray[np.int64]", times: Numbers, begins_s: float, ends_s: float, what: str
) -> dict[str, float]:
    """notice_s: until any flag; own_s: until a flag of this sensor; clear_s: from the end until no flag."""
    wanted, out = _BITS.get(what, _BITS["compass"]), {"notice_s": math.nan, "own_s": math.nan}
    for name, mask in (("notice_s", -1), ("own_s", wanted)):
        flagged = times[(bits & mask != 0) & (times >= begins_s)]
        if len(flagged):
            out[name] = float(flagged[0] - begins_s)
    after = times[(bits != 0) & (times >= ends_s)]
    out["clear_s"] = float(after[-1] - ends_s) if len(after) and math.isfinite(ends_s) else 0.0
    return out


def load_replayed(path: Path) -> dict[str, Any]:
    """What `feed` wrote."""
    with np.load(path, allow_pickle=False) as arrays:
        return {name: arrays[name] for name in arrays.files}
