"""Soundings of one or more voyages, as arrays."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]


@dataclass(frozen=True, slots=True, eq=False)
class Motion:
    """A boat or a part of it at n times, each array of shape (n,); NaN where the log says nothing.

    unix_s: the time, NaN where the log has no date. lat_deg, lon_deg: WGS 84; position_sd_m: one standard
    deviation per axis. heading_rad: true, clockwise. roll_rad (to starboard), pitch_rad (bow up): NaN where
    not measured. speed_m_s: over ground.
    """

    unix_s: Floats
    lat_deg: Floats
    lon_deg: Floats
    position_sd_m: Floats
    heading_rad: Floats
    roll_rad: Floats
    pitch_rad: Floats
    speed_m_s: Floats


@dataclass(frozen=True, slots=True, eq=False)
class Soundings(Motion):
    """Samples of a depth sounder in the order of their times: where the transducer was when it measured, its
    lever arm and latency applied, and what it found, each array of shape (n,).

    depth_m: below the transducer, at the speed of sound that the sounder assumes; NaN: it found no bottom.
    quality: 0 to 1 as the sounder says, NaN where it says nothing. temperature_c: of the water, NaN where not
    measured. voyage: the index of the log.

    transducer_m: the transducer's depth below the surface. sound_m_s: the speed of sound that the sounder
    assumes. names: of the logs. plans: the waypoints of each log's last mission, latitude and longitude,
    (k, 2).
    """

    depth_m: Floats
    quality: Floats
    temperature_c: Floats
    voyage: NDArray[np.int64]
    transducer_m: float = 0.0
    sound_m_s: float = 1480.0
    names: tuple[str, ...] = ()
    plans: tuple[Floats, ...] = ()
