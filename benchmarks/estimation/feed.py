"""Feed recordings to the estimator of the checkout whose interpreter and PYTHONPATH run this file.

    PYTHONPATH=CHECKOUT CHECKOUT/.venv/bin/python -P …/feed.py CHECKOUT OUT timed|untimed RECORDING.npz …

It imports nothing but numpy and the checkout's own `companion`, so that it also runs on older checkouts.
"""

import json
import math
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any, TypeVar

import msgspec
import numpy as np
from numpy.typing import NDArray

import companion
from companion.config.boat_config import Speed
from companion.config.drive import DriveSetting
from companion.config.estimation import Estimation
from companion.core.geo import LatLon, LocalFrame
from companion.core.state import MotorCommand, NavState
from companion.estimation.estimator import Estimator
from companion.sensors.readings import GnssFix, HeadingReading

NAV = (
    "time_s", "north_m", "east_m", "heading_rad", "yaw_rate_rad_s", "north_m_s", "east_m_s", "surge_m_s",
    "sway_m_s", "position_age_s", "heading_age_s", "current_north_m_s", "current_east_m_s",
    "position_sigma_m", "faults",
)  # fmt: skip
SENSORS = ("position_north", "position_east", "velocity_north", "velocity_east", "compass", "gyro")
EVERY = 5  # ticks between two rows: as often as the truth

Input = tuple[GnssFix | None, HeadingReading | None, float, MotorCommand]
Numbers = NDArray[np.float64]
S = TypeVar("S", bound=msgspec.Struct)


def feed(recording: Path, out: Path, *, is_timed: bool = True) -> None:
    """Write the estimates of a recording: an .npz with nav (rows like NAV, in the truth's frame), cpu_us per
    tick, and what the estimator reports: state, covariance, and time, value and variance of innovations.
    """
    with np.load(recording, allow_pickle=False) as stored:
        rest = json.loads(stored["rest"].tobytes())
        ticks = stored["ticks"]
    inputs = inputs_of(rest["fixes"], rest["headings"], ticks)
    nav, reports = estimates(rest["settings"], inputs, rest["frame"])
    cpu_us = _cpu_us(rest["settings"], inputs) if is_timed else math.nan
    arrays: dict[str, Any] = {"nav": nav, "cpu_us": cpu_us, **inside(reports)}
    np.savez(out, **arrays)


def inside(reports: Sequence[Any]) -> dict[str, Numbers]:
    """Reports as arrays, a row each; NaN before the first. Empty for an estimator that makes none."""
    first = next((one for one in reports if one is not None), None)
    if first is None:
        return {}
    states = len(first.state)
    unknown = np.full((states, states), math.nan)
    return {
        "state": np.array([unknown[0] if one is None else one.state for one in reports]),
        "covariance": np.array([unknown if one is None else one.covariance for one in reports]),
        "innovations": np.array(
            [
                [(math.nan,) * 3] * len(SENSORS)
                if one is None
                else [(each.time_s, each.value, each.variance) for each in _channels(one)]
                for one in reports
            ]
        ),
    }


def _channels(report: Any) -> list[Any]:  # noqa: ANN401 (of whatever checkout)
    return [getattr(report, name) for name in SENSORS]


def _cpu_us(settings: dict[str, Any], inputs: Sequence[Input]) -> float:
    """CPU time of a call of `Estimator.update`."""
    estimator = _estimator(settings)
    began_s = time.process_time()
    for fix, heading, now_s, command in inputs:
        estimator.update(fix, heading, now_s, command)
    return (time.process_time() - began_s) * 1e6 / len(inputs)


def inputs_of(
    fixes: Sequence[dict[str, Any]], headings: Sequence[dict[str, Any]], ticks: Numbers
) -> list[Input]:
    """The arguments of every call of `Estimator.update`."""
    # By keyword: structs of a compiled checkout have lost the types that msgspec.convert needs.
    all_fixes = [GnssFix(**{**fix, "position": LatLon(**fix["position"])}) for fix in fixes]
    all_headings = [HeadingReading(**reading) for reading in headings]
    return [
        (
            all_fixes[int(fix)] if fix >= 0 else None,
            all_headings[int(heading)] if heading >= 0 else None,
            now_s,
            MotorCommand(left, right, "", rudder),
        )
        for now_s, fix, heading, left, right, rudder in ticks.tolist()
    ]


def estimates(
    settings: dict[str, Any], inputs: Sequence[Input], origin: Sequence[float], every: int = EVERY
) -> tuple[Numbers, list[Any]]:
    """Rows like NAV of every so many ticks, and the estimator's reports. origin: of the rows' frame."""
    estimator, target = _estimator(settings), LocalFrame(LatLon(*origin))
    frame, shift = None, target.to_local(target.origin)
    rows, reports = [], []
    for number, (fix, heading, now_s, command) in enumerate(inputs):
        nav = estimator.update(fix, heading, now_s, command)
        if number % every:
            continue
        if estimator.frame is not frame and estimator.frame is not None:
            frame = estimator.frame
            shift = target.to_local(frame.origin)
        rows.append(_row(nav, *shift) if frame is not None else [math.nan] * len(NAV))
        reports.append(getattr(estimator, "report", None))
    return np.array(rows, dtype=np.float64), reports


def _row(nav: NavState | None, north_m: float, east_m: float) -> list[float]:
    if nav is None:
        return [math.nan] * len(NAV)
    row = [float(getattr(nav, name)) for name in NAV]
    row[1] += north_m
    row[2] += east_m
    return row


def _estimator(settings: dict[str, Any]) -> Estimator:
    return Estimator(
        _section(settings["speed"], Speed),
        _section(settings["estimation"], Estimation),
        _section(settings["drive"], DriveSetting),
    )


def _section(tree: dict[str, Any], kind: type[S]) -> S:
    """The settings that this checkout knows."""
    known = {field.name for field in msgspec.structs.fields(kind)}
    return msgspec.convert({name: value for name, value in tree.items() if name in known}, kind)


def main(arguments: list[str]) -> int:
    """Entry point."""
    checkout, out, timed, *recordings = arguments
    loaded = Path(companion.__path__[0]).resolve().parent
    if loaded != Path(checkout).resolve():
        sys.stderr.write(f"companion is loaded from {loaded}, not from {checkout}\n")
        return 2
    for recording in recordings:
        feed(Path(recording), Path(out) / Path(recording).name, is_timed=timed == "timed")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
