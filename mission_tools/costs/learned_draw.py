"""What a boat draws at which speed through the water, from logs of its voyages: means over bands of speed, of
stretches of READINGS at a steady speed. A band that draws no more than a slower one is left out.
"""

import math
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Final

import numpy as np

from mission_tools.costs.travel import Floats
from mission_tools.errors import MapError
from mission_tools.files.dataflash import Log

READINGS: Final = 10
"""Of the battery, one a second: longer than a boat takes to follow a change of thrust, and some waves."""
STEADY_SHARE: Final = 0.15
"""How much the speed may vary in a stretch, of its mean: noise of the estimate, and waves."""
BAND: Final = 1.12
"""Fastest over slowest speed of a band."""
_FEWEST: Final = 2  # stretches in a band
_FRESH_S: Final = 2.0  # an older speed is not that of a current
_SLOWEST_SHARE: Final = 0.1  # of the fastest: a boat that drifts says nothing about its motors
_WANTED: Final = {
    "BAT": ("TimeUS", "Curr", "Inst"),
    "XKF1": ("TimeUS", "VN", "VE", "C"),
    "EST": ("TimeUS", "CurN", "CurE"),
}


def learn_draw(logs: Sequence[Path], idle_a: float = 0.0) -> tuple[tuple[float, float], ...]:
    """Pairs of speed and current as [battery] draw wants them, from logs in ArduPilot's DataFlash format.
    idle_a: with the motors stopped. Raises MapError: a log that cannot be read, or no steady speed in any.
    """
    means = np.concatenate([_steady(log) for log in logs])
    means = means[(means[:, 1] > idle_a) & (means[:, 0] > _SLOWEST_SHARE * means[:, 0].max(initial=0.0))]
    bands = np.round(np.log(means[:, 0]) / math.log(BAND))
    pairs: list[tuple[float, float]] = []
    for band in np.unique(bands):
        speed_m_s, drawn_a = means[bands == band].mean(axis=0).tolist()
        if (bands == band).sum() >= _FEWEST and (not pairs or drawn_a > pairs[-1][1]):
            pairs.append((speed_m_s, drawn_a))
    if not pairs:
        raise MapError(
            f"{', '.join(map(str, logs))}: no speed that was steady for {_FEWEST * READINGS} s, with a "
            "current (BAT) and a velocity (XKF1): sail straight legs at several speeds"
        )
    return tuple(pairs)


def _steady(log: Path) -> Floats:
    """Mean speed and current of the steady stretches of a log."""
    try:
        read = np.array(list(_readings(log.read_bytes()))).reshape(-1, 2)
    except OSError as error:
        raise MapError(f"{log}: cannot be read: {error.strerror}") from None
    stretches = read[: len(read) // READINGS * READINGS].reshape(-1, READINGS, 2)
    means = stretches.mean(axis=1)
    steady: Floats = means[np.ptp(stretches[:, :, 0], axis=1) <= STEADY_SHARE * means[:, 0]]
    return steady


def _readings(data: bytes) -> Iterator[tuple[float, float]]:
    """The speed through the water at each reading of the current, and that."""
    flow, velocity, known_us = 0j, 0j, -math.inf
    for name, (time_us, one, other, *instance) in Log(data, _WANTED).records():
        if not (isinstance(time_us, int | float) and isinstance(one, int | float)):
            continue
        if name == "BAT" and not other and time_us - known_us < 1e6 * _FRESH_S:
            yield abs(velocity - flow), one
        elif isinstance(other, int | float) and name == "EST":
            flow = complex(one, other)
        elif isinstance(other, int | float) and name == "XKF1" and not any(instance):
            velocity, known_us = complex(one, other), time_us
