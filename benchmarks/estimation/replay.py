"""The estimator on recorded inputs: its estimates beside the truth, and what it reports of itself."""

import math
from collections.abc import Sequence
from typing import Any

import msgspec
import numpy as np
from numpy.typing import NDArray

from benchmarks.estimation.sensor_recorder import SensorRecording
from companion.config.actuators import DriveSetting
from companion.config.tuning import Estimation, Speed
from companion.core.geo import LatLon, LocalFrame
from companion.core.readings import GnssFix, HeadingReading
from companion.core.state import MotorCommand, NavState
from companion.estimation.estimator import Estimator, EstimatorReport

NAV = (
    "time_s", "north_m", "east_m", "heading_rad", "yaw_rate_rad_s", "north_m_s", "east_m_s", "surge_m_s",
    "sway_m_s", "position_age_s", "heading_age_s", "current_north_m_s", "current_east_m_s",
    "position_sigma_m", "faults",
)  # fmt: skip
SENSORS = ("position_north", "position_east", "velocity_north", "velocity_east", "compass", "gyro")
EVERY = 5  # ticks between two rows: as often as the truth

Numbers = NDArray[np.float64]


def replay(recording: SensorRecording, every: int = EVERY) -> dict[str, Numbers]:
    """Feed a recording to the estimator.

    Returns nav (rows like NAV, in the truth's frame), state and covariance, and of the innovations time,
    value and variance (SENSORS × 3 a row); a row every so many ticks, NaN before the first estimate.
    """
    settings, target = recording.settings, LocalFrame(LatLon(*recording.frame))
    estimator = Estimator(
        msgspec.convert(settings["speed"], Speed),
        msgspec.convert(settings["estimation"], Estimation),
        msgspec.convert(settings["drive"], DriveSetting),
    )
    fixes = [GnssFix(**{**fix, "position": LatLon(**fix["position"])}) for fix in recording.fixes]
    headings = [HeadingReading(**reading) for reading in recording.headings]
    frame, shift = None, target.to_local(target.origin)
    rows: list[list[float]] = []
    reports: list[EstimatorReport | None] = []
    for number, (now_s, fix, heading, left, right, rudder) in enumerate(recording.ticks.tolist()):
        nav = estimator.update(
            fixes[int(fix)] if fix >= 0 else None,
            headings[int(heading)] if heading >= 0 else None,
            now_s,
            MotorCommand(left, right, "", rudder),
        )
        if number % every:
            continue
        if estimator.frame is not frame and estimator.frame is not None:
            frame = estimator.frame
            shift = target.to_local(frame.origin)
        rows.append(_row(nav, *shift) if frame is not None else [math.nan] * len(NAV))
        reports.append(estimator.report)
    return {"nav": np.array(rows, dtype=np.float64), **_inside(reports)}


def _row(nav: NavState | None, north_m: float, east_m: float) -> list[float]:
    if nav is None:
        return [math.nan] * len(NAV)
    row = [float(getattr(nav, name)) for name in NAV]
    row[1] += north_m
    row[2] += east_m
    return row


def _inside(reports: Sequence[EstimatorReport | None]) -> dict[str, Numbers]:
    states = len(next(one.state for one in reports if one is not None))
    unknown = np.full((states, states), math.nan)
    silent: Any = [(math.nan,) * 3] * len(SENSORS)
    return {
        "state": np.array([unknown[0] if one is None else one.state for one in reports]),
        "covariance": np.array([unknown if one is None else one.covariance for one in reports]),
        "innovations": np.array(
            [
                silent
                if one is None
                else [
                    (each.time_s, each.value, each.variance)
                    for each in (getattr(one, name) for name in SENSORS)
                ]
                for one in reports
            ]
        ),
    }
