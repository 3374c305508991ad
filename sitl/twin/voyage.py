"""A voyage out of a boat's log: commands on an even grid, fixes, headings and the pack.

Gyro and compass are joined before anything is fitted. With G the integral of the gyro's rate, the compass
shows

    ψ = s G + b(t) + deviation(ψ) − c U r cos ψ

with the gyro's scale 1/s, its drifting bias as a line with a knot a minute, the deviation of hard and soft
iron as two sines (W. Denne, *Magnetic Compass Deviation and Correction*, 1979: coefficients B to E), and the
tilt that an accelerometer reports in a turn at speed U. Its least squares give heading and turn rate without
these errors. What is constant in the heading's error stays: `sitl.twin.fit` finds it from straight legs.
"""

import math
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import cumulative_trapezoid

from companion.core.errors import ConfigError
from companion.core.geo import LatLon, LocalFrame
from mission_tools.files.dataflash_columns import parameters_of, read_columns

Floats = NDArray[np.float64]

STORED_S: Final = 0.1
"""Spacing of what is compared; the fastest time constant of a small boat is a few tenths of a second."""
_WANTED: Final = {
    "RCOU": ("TimeUS", "C1", "C3"),
    "HDG": ("TimeUS", "Hdg", "GyrZ"),
    "GPS": ("TimeUS", "Lat", "Lng", "Spd", "GCrs", "Status"),
    "BAT": ("TimeUS", "Volt", "Curr", "Inst"),
    "PARM": ("TimeUS", "Name", "Value"),
}
_SHORTEST_S: Final = 60.0
_KNOT_S: Final = 60.0  # a MEMS gyro's bias moves by hundredths of a degree a second in a minute
_SCALE_SD: Final = 0.02  # of a BNO055's rate (sitl/world/sensors/settings.py)
_DEVIATION_SD: Final = 0.02  # rad: what a calibrated compass keeps
_TILT_SD: Final = 0.1  # rad per m/s²: half of the sideways acceleration taken for heel, in a field of 63° dip
_COMPASS_RAD: Final = 0.02  # what is left of its error, which changes
_COMPASS_S: Final = 5.0  # within this time
_FAST_HZ: Final = 25.0  # a log of every tick, or nearly so
_STEPPED: Final = ("left", "right", "open_v", "heading_rad", "rate_rad_s")


@dataclass(frozen=True, slots=True)
class Voyage:
    """Times in s since boot. Per step of step_s from start_s on: commands −1..1, the pack's open-circuit
    voltage in V, heading (rad, unwrapped, clockwise from north) and turn rate (rad/s).

    fixes: time, north and east velocity (m/s), north and east place (m), shape (n, 5). pack: time, V, A,
    shape (n, 3); A is NaN where it is not measured. parameters: of the boat, by name. pack_ohm: of the pack.
    """

    start_s: float
    step_s: float
    left: Floats
    right: Floats
    open_v: Floats
    heading_rad: Floats
    rate_rad_s: Floats
    fixes: Floats
    pack: Floats
    pack_ohm: float
    parameters: dict[str, float]

    def part(self, from_s: float, to_s: float) -> "Voyage":
        """The voyage between two times since its start."""
        first, last = (round(one / self.step_s) for one in (from_s, to_s))
        changed: dict[str, Any] = {name: getattr(self, name)[first:last] for name in _STEPPED}
        for name in ("fixes", "pack"):
            rows = getattr(self, name)
            low, high = np.searchsorted(rows[:, 0], [self.start_s + from_s, self.start_s + to_s])
            changed[name] = rows[low:high]
        return replace(self, start_s=self.start_s + first * self.step_s, **changed)

    @property
    def duration_s(self) -> float:
        return len(self.left) * self.step_s


def read_voyage(path: Path, pack_ohm: float) -> Voyage:
    """Read a log in ArduPilot's DataFlash format. pack_ohm: of the pack, where the log does not tell it.

    Raises ConfigError: it cannot be read, lacks a record, or is shorter than a minute.
    """
    rows, parameters = _records(path)
    missing = [name for name in ("RCOU", "HDG", "GPS", "BAT") if len(rows[name]) < 2]
    if missing:
        raise ConfigError(
            f"{path}: no records {', '.join(missing)}: expected a log of an armed boat with motors, compass, "
            "receiver and battery monitor"
        )
    outputs, headings, fixes, pack = (rows[name] for name in ("RCOU", "HDG", "GPS", "BAT"))
    first_s = max(one[0, 0] for one in (outputs, headings, fixes, pack))
    last_s = min(one[-1, 0] for one in (outputs, headings, fixes, pack))
    if last_s - first_s < _SHORTEST_S:
        raise ConfigError(f"{path}: {last_s - first_s:.0f} s of a voyage: expected a minute at least")
    is_fast = float(np.median(np.diff(outputs[:, 0]))) * _FAST_HZ <= 1.0
    step_s = 0.02 if is_fast else 0.05
    times_s = np.arange(first_s, last_s, step_s)
    left, right = outputs[np.searchsorted(outputs[:, 0], times_s + 1e-6, side="right") - 1, 1:].T
    if not is_fast:  # commands that were not logged lie between those that were
        left, right = (np.interp(times_s, outputs[:, 0], row) for row in outputs[:, 1:].T)
    heading_rad, rate_rad_s = _heading(headings, fixes, times_s)
    open_v, ohm = _open_circuit(pack, times_s, pack_ohm)
    frame = LocalFrame(LatLon(float(fixes[0, 1]), float(fixes[0, 2])))
    places = np.array([frame.to_local(LatLon(lat, lon)) for lat, lon in fixes[:, 1:3].tolist()])
    course = np.radians(fixes[:, 4])
    track = np.column_stack([fixes[:, 0], fixes[:, 3] * np.cos(course), fixes[:, 3] * np.sin(course), places])
    track = track[(track[:, 0] >= first_s) & (track[:, 0] < last_s) & np.isfinite(track).all(axis=1)]
    return Voyage(first_s, step_s, left, right, open_v, heading_rad, rate_rad_s, track, pack, ohm, parameters)


def _records(path: Path) -> tuple[dict[str, Floats], dict[str, float]]:
    """Rows of numbers by record, times in s, in the order of time; and the parameters."""
    try:
        data = path.read_bytes()
    except OSError as error:
        raise ConfigError(f"{path}: cannot be read: {error.strerror}") from None
    columns, log = read_columns(data, _WANTED, ("Name",))
    if not log.count:
        raise ConfigError(f"{path}: not a log in ArduPilot's DataFlash format")
    parameters = parameters_of(columns.pop("PARM"))
    rows = {name: np.column_stack([*kind.values()]) for name, kind in columns.items()}
    pulses = rows["RCOU"][:, 1:]
    rows["RCOU"][:, 1:] = np.where(pulses == 0.0, 0.0, (pulses - 1500.0) / 500.0)
    rows["GPS"] = rows["GPS"][rows["GPS"][:, -1] >= 3.0, :-1]  # GPS_FIX_TYPE: in three dimensions
    rows["BAT"] = rows["BAT"][~(rows["BAT"][:, -1] > 0.0), :-1]  # the first pack
    for name, table in rows.items():
        table[:, 0] *= 1e-6
        needed = table[:, :2] if name == "BAT" else table  # a current may not be measured
        rows[name] = _increasing(table[np.isfinite(needed).all(axis=1)])
    return rows, parameters


def _increasing(rows: Floats) -> Floats:
    """Rows of later and later times; a reading that a record repeats is taken once."""
    first: Floats = rows[np.unique(rows[:, 0], return_index=True)[1]]
    return first


def hat_functions(times_s: Floats, knot_s: float) -> Floats:
    """Values of the linear splines with knots knot_s apart or closer, shape (times, knots)."""
    span_s = max(float(times_s[-1] - times_s[0]), 1e-9)
    pieces = max(1, math.ceil(span_s / knot_s))
    at = (times_s - times_s[0]) * (pieces / span_s)
    values: Floats = np.maximum(0.0, 1.0 - np.abs(at[:, None] - np.arange(pieces + 1)))
    return values


def _heading(rows: Floats, fixes: Floats, times_s: Floats) -> tuple[Floats, Floats]:
    """Heading and turn rate at these times, as the module's text says."""
    at_s, rate = rows[:, 0], np.radians(rows[:, 2])
    turned: Floats = cumulative_trapezoid(rate, at_s, initial=0.0)
    compass = turned + np.unwrap(np.radians(rows[:, 1]) - turned)  # whole turns are counted by the gyro
    spline, sideways = hat_functions(at_s, _KNOT_S), np.interp(at_s, fixes[:, 0], fixes[:, 3]) * rate
    waves = [wave(turns * compass) for turns in (1.0, 2.0) for wave in (np.sin, np.cos)]
    design = np.column_stack([turned, spline, *waves, sideways * np.cos(compass)])
    sd = np.array([_SCALE_SD, *[10.0] * spline.shape[1], *[_DEVIATION_SD] * 4, _TILT_SD])
    noise = _COMPASS_RAD * math.sqrt(_COMPASS_S * len(at_s) / (at_s[-1] - at_s[0]))
    rows = np.vstack([design / noise, np.diag(1.0 / sd)])
    wanted = np.concatenate([compass / noise, np.eye(1, len(sd))[0] / sd])
    found = np.linalg.lstsq(rows, wanted, rcond=None)[0]
    kept = 1 + spline.shape[1]
    known = design[:, :kept] @ found[:kept]
    before, heading, after = (
        np.interp(times_s + late_s, at_s, known) for late_s in (-0.5 * STORED_S, 0.0, 0.5 * STORED_S)
    )
    return heading, (after - before) / STORED_S


def _open_circuit(pack: Floats, times_s: Floats, pack_ohm: float) -> tuple[Floats, float]:
    """Open-circuit voltage at these times and the pack's resistance: V = E(t) − R I, E a line with a knot
    every two minutes, R known within a factor of two. Without a current the voltage is taken as it is.
    """
    at_s, volts, amps = pack.T
    if not np.isfinite(amps).all():
        return np.interp(times_s, at_s, volts), 0.0
    knots = hat_functions(at_s, 2.0 * _KNOT_S)
    noise_v = 0.02  # of a shunt monitor
    design = np.vstack([np.column_stack([knots, -amps]) / noise_v, np.zeros((1, knots.shape[1] + 1))])
    design[-1, -1] = 1.0 / max(pack_ohm, 0.01)
    wanted = np.append(volts / noise_v, 1.0)
    *levels, ohm = np.linalg.lstsq(design, wanted, rcond=None)[0].tolist()
    return np.interp(times_s, at_s, knots @ np.array(levels)), max(ohm, 0.0)
