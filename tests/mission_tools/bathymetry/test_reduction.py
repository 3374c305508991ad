"""Depths below the datum from what a sounder says."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from sounded_lake import ORIGIN, of_places, with_values

from mission_tools.bathymetry.reduction import Corrections, reduced, speed_of_sound_m_s
from mission_tools.bathymetry.soundings import Soundings


def along_a_line(**values: Any) -> Soundings:  # noqa: ANN401
    """Ten soundings of 4 m, a second and a metre apart, heading north."""
    place = np.column_stack((np.zeros(10), np.arange(10.0)))
    return replace(of_places(place, np.full(10, 4.0), 1.0), heading_rad=np.zeros(10), **values)


def test_speed_of_sound_agrees_with_published_values() -> None:
    fresh = speed_of_sound_m_s(np.array([0.0, 20.0, 74.0]))
    # V. Del Grosso and C. Mader, J. Acoust. Soc. Am. 52 (1972) 1442: 1402.388, 1482.343, at 74 °C 1555.147
    assert fresh == pytest.approx([1402.388, 1482.343, 1555.15], abs=0.03)
    # UNESCO equation (Fofonoff and Millard 1983): 1521.5 m/s at 20 °C, salinity 35, surface
    assert speed_of_sound_m_s(np.array([20.0]), 35.0) == pytest.approx([1521.5], abs=0.5)


def test_positions_come_back_in_the_frame() -> None:
    at = reduced(along_a_line(), ORIGIN, Corrections())
    assert at.north_m == pytest.approx(np.arange(10.0), abs=1e-3)
    assert at.east_m == pytest.approx(np.zeros(10), abs=1e-3)


def test_depth_has_transducer_water_level_and_speed_of_sound() -> None:
    at = reduced(along_a_line(transducer_m=0.3, sound_m_s=1500.0), ORIGIN, Corrections(0.5, sound_m_s=1425.0))
    assert at.depth_m == pytest.approx(np.full(10, 0.3 + 4.0 * 0.95 - 0.5))
    assert (at.sound_m_s, at.sound_source) == (1425.0, "given")


def test_temperature_of_the_log_is_used_and_the_given_one_goes_before() -> None:
    cold = along_a_line(temperature_c=np.array([np.nan, *np.full(9, 5.0)]))
    assert reduced(cold, ORIGIN, Corrections()).depth_m == pytest.approx(
        np.full(10, 4.0 * 1426.16 / 1480.0), abs=1e-3
    )
    warm = reduced(cold, ORIGIN, Corrections(temperature_c=20.0))
    assert warm.depth_m == pytest.approx(np.full(10, 4.0 * 1482.36 / 1480.0), abs=1e-3)


def test_a_tilt_within_the_beam_changes_nothing_and_one_beyond_moves_the_footprint() -> None:
    within = reduced(along_a_line(roll_rad=np.full(10, 0.2)), ORIGIN, Corrections())
    assert within.depth_m == pytest.approx(np.full(10, 4.0))
    assert within.east_m == pytest.approx(np.zeros(10), abs=1e-3)
    beyond = reduced(along_a_line(roll_rad=np.full(10, 0.3)), ORIGIN, Corrections(beam_rad=0.4))
    assert beyond.depth_m == pytest.approx(np.full(10, 4.0 * math.cos(0.1)))
    pencil = Corrections(beam_rad=0.0)
    port = reduced(along_a_line(roll_rad=np.full(10, 0.2)), ORIGIN, pencil)  # starboard down: beam to port
    assert port.east_m == pytest.approx(np.full(10, -4.0 * math.sin(0.2)), abs=1e-3)
    assert port.depth_m == pytest.approx(np.full(10, 4.0 * math.cos(0.2)))
    ahead = reduced(along_a_line(pitch_rad=np.full(10, 0.2)), ORIGIN, pencil)
    assert ahead.north_m - np.arange(10.0) == pytest.approx(np.full(10, 4.0 * math.sin(0.2)), abs=1e-3)


def test_lever_arm_turns_with_the_heading_and_latency_goes_back_along_the_track() -> None:
    east = replace(along_a_line(), heading_rad=np.full(10, math.pi / 2))
    at = reduced(east, ORIGIN, Corrections(forward_m=2.0, starboard_m=1.0))
    assert at.east_m == pytest.approx(np.full(10, 2.0), abs=1e-3)
    assert at.north_m == pytest.approx(np.arange(10.0) - 1.0, abs=1e-3)
    late = reduced(along_a_line(), ORIGIN, Corrections(latency_s=0.4))
    assert late.north_m[1:] == pytest.approx(np.arange(1.0, 10.0) - 0.4, abs=1e-3)
    lost = with_values(along_a_line(), np.array([4]), lon_deg=np.nan, lat_deg=np.nan, heading_rad=np.nan)
    at = reduced(lost, ORIGIN, Corrections(latency_s=0.4, forward_m=1.0))
    assert at.north_m[5:] == pytest.approx(np.arange(5.0, 10.0) + 0.6, abs=1e-3)
    assert np.isnan(at.north_m[4])
