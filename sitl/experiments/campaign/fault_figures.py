"""Detection time, position error and track error for faults of GNSS and compass.

Only for runs with a single such fault, against ground truth, ten times a second.
"""

import math
from typing import Final

import numpy as np

from companion.core.state import COMPASS_FAULTS, GNSS_FAULTS, EstimateFault
from sitl.courses.courses import off_path_m
from sitl.run.mission_run import MissionRun
from sitl.run.recording.estimate_recorder import Estimate
from sitl.world.truth import Truth

_BITS: Final = {"gnss": GNSS_FAULTS, "compass": COMPASS_FAULTS}
_LOST: Final = int(EstimateFault.POSITION_LOST)
_PLACE: Final = slice(Truth._fields.index("north_m"), Truth._fields.index("east_m") + 1)
_NAMES: Final = ("notice_s", "given_up_s", "astray_m", "astray_share", "off_plan_m")


def fault_figures(mission_run: MissionRun) -> dict[str, float | None]:
    """The figures of a run with one fault of the receiver or the compass; nothing for any other.

    notice_s: from the fault to the estimate's saying so. given_up_s: to the position's being given up.
    astray_m: by how much the position's error has grown at most, until then or until the fault was over.
    astray_share: what is more than a metre of that, over the way sailed meanwhile. off_plan_m: how far the
    boat was from its planned line at most, since the fault began, while it sailed along it. None: never.
    """
    faults = mission_run.scenario.faults
    if len(faults) != 1 or faults[0].what not in _BITS:
        return {}
    fault, out = faults[0], dict[str, float | None].fromkeys(_NAMES)
    estimates, truth = mission_run.estimates.rows, mission_run.recorder.rows
    since = estimates[estimates[:, 0] >= fault.at_s]
    if not len(since) or not len(truth) or truth[0, 0] > fault.at_s:
        return out
    bits = since[:, Estimate._fields.index("faults")].astype(int)
    for name, wanted in (("notice_s", _BITS[fault.what]), ("given_up_s", _LOST)):
        if (bits & wanted).any():
            out[name] = float(since[int((bits & wanted != 0).argmax()), 0] - fault.at_s)
    given_up_s = out["given_up_s"]
    ends_s = min(fault.ends_s, math.inf if given_up_s is None else fault.at_s + given_up_s)
    _add_position_errors(out, since[since[:, 0] < ends_s], truth)
    late = truth[(mission_run.recorder.legs >= 0) & (truth[:, 0] >= fault.at_s), _PLACE]
    out["off_plan_m"] = float(off_path_m(late, mission_run.planned).max()) if len(late) else None
    return out


def _add_position_errors(
    out: dict[str, float | None],
    estimates: "np.ndarray[tuple[int, int], np.dtype[np.float64]]",
    truth: "np.ndarray[tuple[int, int], np.dtype[np.float64]]",
) -> None:
    believed = slice(Estimate._fields.index("north_m"), Estimate._fields.index("east_m") + 1)
    rows = np.minimum(np.searchsorted(truth[:, 0], estimates[:, 0] - 1e-6), len(truth) - 1)
    if not len(rows):
        return
    at = truth[rows, _PLACE]
    error_m = np.hypot(*(estimates[:, believed] - at).T)
    way_m = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(at, axis=0).T))))
    grown_m = error_m - error_m[0]
    out["astray_m"] = float(grown_m.max())
    out["astray_share"] = float(np.max((grown_m - 1.0) / np.maximum(way_m, 1.0)))
