"""Samples of logs as a table in CSV, one row a value."""

import csv
from collections.abc import Iterable, Iterator, Sequence
from typing import Final, TextIO

import numpy as np

from mission_tools.bathymetry.from_log import LogSamples
from mission_tools.bathymetry.soundings import Floats, Motion
from mission_tools.overwrite_guard import SAMPLES_HEAD

HEADER: Final = (
    SAMPLES_HEAD + "heading_deg,roll_deg,pitch_deg,speed_m_s,position_sd_m,name,value,unit,quality,"
    "transducer_m,log"
)

_Row = tuple[str, ...]


def write_table(logs: Sequence[LogSamples], file: TextIO) -> int:
    """Write samples, log by log, each kind in order of time; returns how many. Unknown: an empty field."""
    file.write(HEADER + "\n")
    writer, count = csv.writer(file, lineterminator="\n"), 0
    for log in logs:
        for row in _rows(log):
            writer.writerow(row)
            count += 1
    return count


def _rows(log: LogSamples) -> Iterator[_Row]:
    sounded, name = log.soundings, log.soundings.names[0]
    wheres, below = list(_boat(sounded, log.sounded_s)), f"{sounded.transducer_m:.3f}"
    depths = zip(wheres, _texts(sounded.depth_m, 3), _texts(sounded.quality, 2), strict=True)
    yield from ((*where, "depth", depth, "m", sure, below, name) for where, depth, sure in depths)
    for where, warm in zip(wheres, _texts(sounded.temperature_c, 2), strict=True):
        if warm:
            yield (*where, "temperature", warm, "degC", "", "", name)
    values = (f"{value:.9g}" for value in log.values.tolist())
    boat = _boat(log.probed, log.probed_s)
    probes = zip(boat, log.probes.tolist(), values, log.units.tolist(), strict=True)
    yield from ((*where, probe, value, unit, "", "", name) for where, probe, value, unit in probes)


def _boat(at: Motion, log_s: Floats) -> Iterable[_Row]:
    """Time, place and motion of each sample."""
    milliseconds = np.where(np.isnan(at.unix_s), 0.0, 1e3 * at.unix_s).round().astype("datetime64[ms]")
    dates = np.where(np.isnan(at.unix_s), "", np.char.add(np.datetime_as_string(milliseconds), "Z"))
    return zip(
        dates.tolist(),
        _texts(at.unix_s, 3),
        _texts(log_s, 3),
        _texts(at.lat_deg, 8),
        _texts(at.lon_deg, 8),
        *(_texts(np.degrees(angle), 2) for angle in (at.heading_rad, at.roll_rad, at.pitch_rad)),
        _texts(at.speed_m_s, 3),
        _texts(at.position_sd_m, 3),
        strict=True,
    )


def _texts(values: Floats, digits: int) -> list[str]:
    """Decimals; empty of what is not known."""
    return ["" if value != value else f"{value:.{digits}f}" for value in values.tolist()]  # noqa: PLR0124 (NaN)
