"""Samples of a boat's logs in ArduPilot's DataFlash format: soundings (DPTH) and probes (PROB), each at the
time of its measurement, where its sensor was then. docs/logs.md describes the records.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from mission_tools.bathymetry.boat_track import WANTED as TRACK
from mission_tools.bathymetry.boat_track import BoatTrack, Motion
from mission_tools.bathymetry.soundings import Floats, Soundings
from mission_tools.errors import LogError
from mission_tools.files.dataflash_columns import Columns, read_columns

Texts = NDArray[np.str_]

_WANTED: Final[Mapping[str, tuple[str, ...]]] = {
    **TRACK,
    "DPTH": ("TimeUS", "Inst", "Lat", "Lng", "Depth", "Temp", "Quality", "PosZ"),
    "PROB": ("TimeUS", "Lat", "Lng", "Name", "Value", "Unit"),
    "PARM": ("Name", "Value"),
}
_SOUND_M_S: Final = 1480.0  # of a log that does not say it: fresh water at 20 °C


@dataclass(frozen=True, slots=True, eq=False)
class LogSamples:
    """The samples of one log in the order of their times.

    sounded: at each sounding, its place that of the transducer. depth_m, quality, temperature_c: as in
    `Soundings`; transducer_m: its depth below the surface. probed: the boat at each value of a probe;
    probes, values, units: whose, and what it is. notes: what is wrong with the log, a line each.
    """

    name: str
    sounded: Motion
    depth_m: Floats
    quality: Floats
    temperature_c: Floats
    transducer_m: Floats
    sound_m_s: float
    probed: Motion
    probes: Texts
    values: Floats
    units: Texts
    notes: tuple[str, ...] = ()


def read_logs(paths: Sequence[Path]) -> tuple[LogSamples, ...]:
    """Read logs. Raises LogError: a file that cannot be read, or is no log."""
    return tuple(read_samples(path) for path in paths)


def read_samples(path: Path) -> LogSamples:
    """Read a log, whole or as far as it was written. Raises LogError as `read_logs`."""
    try:
        data = path.read_bytes()
    except OSError as error:
        raise LogError(f"{path}: cannot be read: {error.strerror}: name a log of the boat") from None
    columns, log = read_columns(data, _WANTED)
    if not log.count:
        raise LogError(f"{path}: no DataFlash log: expected a .bin of the boat's folder logs")
    track, settings = BoatTrack(columns), _settings(columns["PARM"])
    depth, probe = _in_order(columns["DPTH"]), _in_order(columns["PROB"])
    which = depth["Inst"][0] if len(depth["Inst"]) else 1.0
    depth = {label: column[depth["Inst"] == which] for label, column in depth.items()}
    prefix = f"RNGFND{which + 1.0:.0f}_"
    sounded = _at_records(track, depth, settings.get(f"{prefix}LATENCY", 0.0))
    return LogSamples(
        path.name,
        sounded.of_part(settings.get(f"{prefix}POS_X", 0.0), settings.get(f"{prefix}POS_Y", 0.0)),
        np.where(depth["Depth"] > 0.0, depth["Depth"], np.nan),
        np.where(depth["Quality"] >= 0.0, depth["Quality"] / 100.0, np.nan),
        depth["Temp"],
        np.where(np.isnan(depth["PosZ"]), settings.get(f"{prefix}POS_Z", 0.0), depth["PosZ"]),
        settings.get(f"{prefix}SOUND", _SOUND_M_S),
        _at_records(track, probe, 0.0),
        _decoded(probe["Name"]),
        probe["Value"],
        _decoded(probe["Unit"]),
        _notes(
            path,
            is_cut=log.is_cut,
            is_dated=track.is_dated,
            is_empty=not len(depth["Lat"]) + len(probe["Lat"]),
        ),
    )


def soundings_of(logs: Sequence[LogSamples]) -> Soundings:
    """The soundings of some logs, one after the other, as if all had the transducer's depth and the speed of
    sound of the first. Raises LogError: none has any; names them.
    """
    with_any = [log for log in logs if len(log.depth_m)]
    if not with_any:
        names = ", ".join(log.name for log in logs)
        raise LogError(f"{names}: no soundings (DPTH): fit a depth sounder, [parts.depth] of the boat's file")
    first = with_any[0]
    transducer_m, sound_m_s = float(np.median(first.transducer_m)), first.sound_m_s

    def joined(of: Callable[[LogSamples], Floats]) -> Floats:
        return np.concatenate([of(log) for log in logs])

    return Soundings(
        unix_s=joined(lambda log: log.sounded.unix_s),
        lat_deg=joined(lambda log: log.sounded.lat_deg),
        lon_deg=joined(lambda log: log.sounded.lon_deg),
        position_sd_m=joined(lambda log: log.sounded.position_sd_m),
        heading_rad=joined(lambda log: log.sounded.heading_rad),
        roll_rad=joined(lambda log: log.sounded.roll_rad),
        pitch_rad=joined(lambda log: log.sounded.pitch_rad),
        speed_m_s=joined(lambda log: log.sounded.speed_m_s),
        depth_m=joined(lambda log: log.depth_m * sound_m_s / log.sound_m_s + log.transducer_m - transducer_m),
        quality=joined(lambda log: log.quality),
        temperature_c=joined(lambda log: log.temperature_c),
        voyage=np.repeat(np.arange(len(logs)), [len(log.depth_m) for log in logs]),
        transducer_m=transducer_m,
        sound_m_s=sound_m_s,
        names=tuple(log.name for log in logs),
    )


def _in_order(columns: Columns) -> Columns:
    """The records of one kind in the order of their times."""
    order = np.argsort(columns["TimeUS"], kind="stable")
    return {label: column[order] for label, column in columns.items()}


def _at_records(track: BoatTrack, columns: Columns, latency_s: float) -> Motion:
    """The boat when these samples were taken. Where its track has a gap, its place is the record's own."""
    motion = track.at(columns["TimeUS"] * 1e-6 - latency_s)
    return replace(
        motion,
        lat_deg=np.where(np.isnan(motion.lat_deg), columns["Lat"], motion.lat_deg),
        lon_deg=np.where(np.isnan(motion.lon_deg), columns["Lng"], motion.lon_deg),
    )


def _settings(parameters: Columns) -> dict[str, float]:
    """The parameters as they were last."""
    names, values = _decoded(parameters["Name"]).tolist(), parameters["Value"].tolist()
    return dict(zip(names, values, strict=True))


def _decoded(column: NDArray[Any]) -> Texts:
    """Texts; empty ones of a log without the field."""
    raw = column if column.dtype.kind == "S" else np.full(len(column), b"")
    return np.char.decode(raw, "utf-8", "replace")


def _notes(path: Path, *, is_cut: bool, is_dated: bool, is_empty: bool) -> tuple[str, ...]:
    told = (
        (is_cut, "cut off or damaged: its whole records are read"),
        (is_empty, "without samples: no sounding (DPTH) and no value of a probe (PROB)"),
        (not is_dated and not is_empty, "without a date: no fix had one; times are since the boat's start"),
    )
    return tuple(f"{path}: {text}" for is_so, text in told if is_so)
