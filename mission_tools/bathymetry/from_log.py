"""Samples of a boat's logs in ArduPilot's DataFlash format: soundings (DPTH) and probes (PROB), each at the
time of its measurement, where its sensor was then. docs/logs.md describes the records.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from mission_tools.bathymetry.boat_track import WANTED as TRACK
from mission_tools.bathymetry.boat_track import BoatTrack, of_part
from mission_tools.bathymetry.soundings import Floats, Motion, Soundings
from mission_tools.errors import LogError
from mission_tools.files.dataflash_columns import Columns, parameters_of, read_columns, texts_of

Texts = NDArray[np.str_]

_WANTED: Final[Mapping[str, tuple[str, ...]]] = {
    **TRACK,
    "DPTH": ("TimeUS", "Inst", "Lat", "Lng", "Depth", "Temp", "Quality", "PosZ"),
    "PROB": ("TimeUS", "Lat", "Lng", "Name", "Value", "Unit"),
    "PARM": ("Name", "Value"),
    "CMD": ("CNum", "CId", "Lat", "Lng"),
}
_OF_MOTION: Final = tuple(field.name for field in fields(Motion))
_JOINED: Final = (*_OF_MOTION, "quality", "temperature_c")
_TEXTS: Final = ("Name", "Unit")
_WAYPOINT: Final = 16.0  # MAV_CMD_NAV_WAYPOINT
_SOUND_M_S: Final = 1480.0  # of a log that does not say it: fresh water at 20 °C


@dataclass(frozen=True, slots=True, eq=False)
class LogSamples:
    """The samples of one log in the order of their times.

    sounded_s, probed_s: when, since the boat's start. probed: the boat at each value of a probe; probes,
    values, units: whose, and what it is. notes: what is wrong with the log, a line each.
    """

    soundings: Soundings
    sounded_s: Floats
    probed_s: Floats
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
    columns, log = read_columns(data, _WANTED, _TEXTS)
    if not log.count:
        raise LogError(f"{path}: no DataFlash log: expected a .bin of the boat's folder logs")
    depth, probe = _in_order(columns["DPTH"]), _in_order(columns["PROB"])
    which = depth["Inst"][0] if len(depth["Inst"]) else 1.0  # of several sounders, the first
    depth = {label: column[depth["Inst"] == which] for label, column in depth.items()}
    prefix, settings = f"RNGFND{which + 1.0:.0f}_", parameters_of(columns["PARM"])
    track = BoatTrack(columns)
    probed_s, sounded_s = probe["TimeUS"] * 1e-6, depth["TimeUS"] * 1e-6
    sounded_s = sounded_s - settings.get(f"{prefix}LATENCY", 0.0)
    probed, lever = _at_records(track, probe, probed_s), (f"{prefix}POS_X", f"{prefix}POS_Y")
    sounded = of_part(_at_records(track, depth, sounded_s), *(settings.get(name, 0.0) for name in lever))
    below_m = depth["PosZ"][np.isfinite(depth["PosZ"])]
    dates = np.concatenate((sounded.unix_s, probed.unix_s))
    told = (
        (log.is_cut, "cut off or damaged: its whole records are read"),
        (not len(dates), "without samples: no sounding (DPTH) and no value of a probe (PROB)"),
        (np.isnan(dates[:1]).any(), "without a date: no fix had one; times are since the boat's start"),
    )
    return LogSamples(
        Soundings(
            **{name: getattr(sounded, name) for name in _OF_MOTION},
            depth_m=np.where(depth["Depth"] > 0.0, depth["Depth"], np.nan),
            quality=np.where(depth["Quality"] >= 0.0, depth["Quality"] / 100.0, np.nan),
            temperature_c=depth["Temp"],
            voyage=np.zeros(len(depth["Lat"]), np.int64),
            transducer_m=float(np.median(below_m)) if len(below_m) else settings.get(f"{prefix}POS_Z", 0.0),
            sound_m_s=settings.get(f"{prefix}SOUND", _SOUND_M_S),
            names=(path.name,),
            plans=(_plan(columns["CMD"]),),
        ),
        sounded_s,
        probed_s,
        probed,
        texts_of(probe["Name"]),
        probe["Value"],
        texts_of(probe["Unit"]),
        tuple(f"{path}: {text}" for is_so, text in told if is_so),
    )


def soundings_of(logs: Sequence[LogSamples]) -> Soundings:
    """The soundings of some logs, one after the other, as if all had the transducer's depth and the speed of
    sound of the first. Raises LogError: none has any; names them.
    """
    parts = [log.soundings for log in logs]
    names = tuple(part.names[0] for part in parts)
    like = next((part for part in parts if len(part.depth_m)), None)
    if like is None:
        raise LogError(
            f"{', '.join(names)}: no soundings (DPTH): fit a depth sounder, [parts.depth] of the boat's file"
        )
    depths_m = [
        part.depth_m * (like.sound_m_s / part.sound_m_s) + part.transducer_m - like.transducer_m
        for part in parts
    ]
    joined: dict[str, Any] = {
        name: np.concatenate([getattr(part, name) for part in parts]) for name in _JOINED
    }
    plans = tuple(plan for part in parts for plan in part.plans)
    voyage = np.repeat(np.arange(len(parts)), [len(part.depth_m) for part in parts])
    return replace(like, **joined, depth_m=np.concatenate(depths_m), voyage=voyage, names=names, plans=plans)


def _plan(items: Columns) -> Floats:
    """The waypoints of the last mission: it is logged whole, from item 0, which is home."""
    begins = np.flatnonzero(items["CNum"] == 0.0)
    last = {label: column[begins[-1] + 1 if len(begins) else 0 :] for label, column in items.items()}
    is_place = (last["CId"] == _WAYPOINT) & ((last["Lat"] != 0.0) | (last["Lng"] != 0.0))
    found: Floats = np.column_stack((last["Lat"][is_place], last["Lng"][is_place]))
    return found


def _in_order(columns: Columns) -> Columns:
    """The records of one kind in the order of their times."""
    order = np.argsort(columns["TimeUS"], kind="stable")
    return {label: column[order] for label, column in columns.items()}


def _at_records(track: BoatTrack, columns: Columns, log_s: Floats) -> Motion:
    """The boat when these samples were taken. Where its track has a gap, its place is the record's own."""
    motion = track.at(log_s)
    return replace(
        motion,
        lat_deg=np.where(np.isnan(motion.lat_deg), columns["Lat"], motion.lat_deg),
        lon_deg=np.where(np.isnan(motion.lon_deg), columns["Lng"], motion.lon_deg),
    )
