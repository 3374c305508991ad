"""From what a sounder says to depths below the datum, at the places that it sounded."""

import math
from dataclasses import dataclass, replace

import numpy as np

from companion.core.geo import LatLon
from mission_tools.bathymetry.soundings import Floats, Soundings
from mission_tools.maps.projection import local_coordinates

_FRESH = (1402.38744, 5.03836171, -5.81172916e-2, 3.34638117e-4, -1.48259672e-6, 3.16585020e-9)
BEAM_DEG = 25.0  # full width at −3 dB of a Ping1D (Blue Robotics, technical details)


@dataclass(frozen=True, slots=True)
class Corrections:
    """What the logs do not say.

    water_level_m: of the surface during the survey above the datum, which the map's shore line is.
    sound_m_s: mean speed of sound, before everything else. temperature_c: of the water, before what the log
    has. salinity: practical salinity, 0: fresh water. beam_rad: full width of the sounder's cone. forward_m,
    starboard_m, latency_s: lever arm and latency beyond those that the soundings have already.
    """

    water_level_m: float = 0.0
    sound_m_s: float | None = None
    temperature_c: float | None = None
    salinity: float = 0.0
    beam_rad: float = math.radians(BEAM_DEG)
    forward_m: float = 0.0
    starboard_m: float = 0.0
    latency_s: float = 0.0


@dataclass(frozen=True, slots=True, eq=False)
class Reduced:
    """Soundings in a chart's frame, arrays of shape (n,): place in metres, depth below the datum, NaN where
    there is none. sound_m_s: median speed of sound; sound_source: where it is from.
    """

    east_m: Floats
    north_m: Floats
    depth_m: Floats
    sound_m_s: float
    sound_source: str


def speed_of_sound_m_s(temperature_c: Floats, salinity: float = 0.0) -> Floats:
    """Of water near the surface.

    Fresh water: N. Bilaniuk and G. S. K. Wong, J. Acoust. Soc. Am. 93 (1993) 1609 and 99 (1996) 3257, 148
    points, 0 to 100 °C. Salt water: H. Medwin, J. Acoust. Soc. Am. 58 (1975) 1318, 0 to 35 °C.
    """
    if salinity <= 0.0:
        return np.asarray(np.polynomial.polynomial.polyval(temperature_c, _FRESH), dtype=np.float64)
    t = temperature_c
    return 1449.2 + 4.6 * t - 0.055 * t**2 + 2.9e-4 * t**3 + (1.34 - 0.01 * t) * (salinity - 35.0)


def reduced(soundings: Soundings, origin: LatLon, given: Corrections) -> Reduced:
    """Depths below the datum and where they were sounded, in the frame round an origin.

    The first echo comes from the nearest bottom within the cone: a tilt below half the beam changes nothing
    on level ground; what goes beyond moves the footprint and shortens the depth.
    """
    s = _delayed(soundings, given.latency_s)
    place = local_coordinates(np.column_stack((s.lon_deg, s.lat_deg)), origin)
    sound, source = _sound(s, given)
    slant = s.depth_m * sound / s.sound_m_s
    roll, pitch = np.nan_to_num(s.roll_rad), np.nan_to_num(s.pitch_rad)
    # the transducer's axis in level axes (Fossen 2011, eq. 2.18): ahead, right, down
    ahead, right = np.cos(roll) * np.sin(pitch), -np.sin(roll)
    tilt = np.arccos(np.clip(np.cos(roll) * np.cos(pitch), -1.0, 1.0))
    excess = np.maximum(tilt - 0.5 * given.beam_rad, 0.0)
    reach = np.nan_to_num(slant) * np.sin(excess) / np.maximum(np.sin(tilt), 1e-9)
    forward, starboard = given.forward_m + reach * ahead, given.starboard_m + reach * right
    c, sn = np.cos(np.nan_to_num(s.heading_rad)), np.sin(np.nan_to_num(s.heading_rad))
    depth = s.transducer_m + slant * np.cos(excess) - given.water_level_m
    return Reduced(
        place[:, 0] + forward * sn + starboard * c,
        place[:, 1] + forward * c - starboard * sn,
        np.where(s.depth_m > 0.0, depth, np.nan),
        float(np.median(sound)),
        source,
    )


def _sound(s: Soundings, given: Corrections) -> tuple[Floats, str]:
    """The speed of sound at each sounding, and where it is from."""
    ones = np.ones_like(s.depth_m)
    if given.sound_m_s is not None:
        return ones * given.sound_m_s, "given"
    known = np.isfinite(s.temperature_c)
    if given.temperature_c is not None:
        return ones * speed_of_sound_m_s(ones * given.temperature_c, given.salinity), "given temperature"
    if known.any():
        at = np.arange(len(known))
        filled = np.interp(at, at[known], s.temperature_c[known])
        return speed_of_sound_m_s(filled, given.salinity), "temperature in the log"
    return ones * s.sound_m_s, "as the sounder assumes"


def _delayed(s: Soundings, latency_s: float) -> Soundings:
    """The soundings at the places, headings and tilts of a latency earlier, within each voyage."""
    if latency_s == 0.0:
        return s
    columns = (s.lat_deg, s.lon_deg, s.heading_rad, s.roll_rad, s.pitch_rad)
    moved = [column.copy() for column in columns]
    for voyage in np.unique(s.voyage):
        (own,) = np.nonzero((s.voyage == voyage) & np.isfinite(s.unix_s) & np.isfinite(s.lat_deg))
        for values, turn in zip(moved, (360.0, 360.0, math.tau, math.tau, math.tau), strict=True):
            whole = np.unwrap(np.nan_to_num(values[own]), period=turn)
            values[own] = np.interp(s.unix_s[own] - latency_s, s.unix_s[own], whole)
    lat, lon, heading, roll, pitch = moved
    return replace(s, lat_deg=lat, lon_deg=lon, heading_rad=heading, roll_rad=roll, pitch_rad=pitch)
