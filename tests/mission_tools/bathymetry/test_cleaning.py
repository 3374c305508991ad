"""Each wrong sounding is rejected for its own reason, and a good bottom is kept."""

from dataclasses import replace

import numpy as np
import pytest
from sounded_lake import ORIGIN, bowl, lake, soundings, with_values

from mission_tools.bathymetry.cleaning import REASONS, CleaningSettings, cleaned, counts
from mission_tools.bathymetry.reduction import Corrections, reduced
from mission_tools.bathymetry.soundings import Soundings

LAKE = lake()
GOOD = soundings(LAKE, bowl(LAKE, 21), 21)
ROWS = np.arange(3000, 3012)


def reasons(s: Soundings) -> list[str]:
    codes = cleaned(s, reduced(s, ORIGIN, Corrections()), LAKE.water, CleaningSettings())
    return [REASONS[code] for code in codes]


def test_a_clean_survey_loses_less_than_one_in_a_thousand() -> None:
    assert sum(reason != "accepted" for reason in reasons(GOOD)) < len(GOOD.depth_m) / 1000


@pytest.mark.parametrize(
    ("values", "reason"),
    [
        ({"depth_m": np.nan}, "no bottom"),
        ({"depth_m": 0.0}, "no bottom"),
        ({"lat_deg": np.nan}, "no position"),
        ({"position_sd_m": 5.1}, "position uncertain"),
        ({"quality": 0.45}, "low quality"),
        ({"quality": 0.3, "depth_m": 1.0}, "weeds"),
        ({"depth_m": 2.0 * GOOD.depth_m[ROWS]}, "multiple echo"),
        ({"lat_deg": GOOD.lat_deg[ROWS] + 8.0 / 111_200.0}, "position jump"),
        ({"lat_deg": GOOD.lat_deg[ROWS] + 300.0 / 111_200.0}, "position jump"),
    ],
)
def test_a_run_of_wrong_soundings_has_its_reason(values: dict[str, object], reason: str) -> None:
    found = reasons(with_values(GOOD, ROWS, **values))
    assert [found[row] for row in ROWS] == [reason] * len(ROWS)
    others = [one for row, one in enumerate(found) if row not in set(ROWS.tolist()) and one != "accepted"]
    assert len(others) < 10


def test_single_spikes_either_way_are_rejected_and_small_errors_are_kept() -> None:
    rows = np.arange(2900, 3200, 30)
    sign = np.where(np.arange(10) % 2, 1.0, -1.0)
    spiked = with_values(GOOD, rows, depth_m=GOOD.depth_m[rows] + 0.4 * sign)
    assert [reasons(spiked)[row] for row in rows] == ["spike"] * 10
    small = with_values(GOOD, rows, depth_m=GOOD.depth_m[rows] + 0.1 * sign)
    assert [reasons(small)[row] for row in rows].count("accepted") >= 9


def test_a_weak_echo_above_the_bottom_is_weed_and_one_below_it_is_not() -> None:
    rows = np.arange(2900, 3200, 30)
    for off_m, quality, reason in ((-0.4, 0.7, "weeds"), (-0.4, 0.85, "spike"), (0.4, 0.7, "spike")):
        weak = with_values(GOOD, rows, depth_m=GOOD.depth_m[rows] + off_m, quality=quality)
        assert {reasons(weak)[row] for row in rows} == {reason}


def test_second_echoes_for_a_minute_are_found_by_the_passes_beside_them() -> None:
    rows = np.arange(3010, 3080)
    doubled = with_values(GOOD, rows, depth_m=2.0 * GOOD.depth_m[rows])
    every = reasons(doubled)
    assert [every[row] for row in rows].count("multiple echo") > 60


def test_soundings_on_land_are_outside_the_water_and_a_lasting_shift_is_kept() -> None:
    inland = replace(GOOD, lon_deg=GOOD.lon_deg + 400.0 / 71_500.0)
    assert set(reasons(inland)) == {"outside the water"}
    shifted = with_values(GOOD, slice(3000, None), lat_deg=GOOD.lat_deg[3000:] + 8.0 / 111_200.0)
    assert reasons(shifted).count("position jump") == 0


def test_every_sounding_is_counted_once() -> None:
    found = counts(np.array([0, 0, 3, 9], dtype=np.int8))
    assert tuple(found) == REASONS
    assert (sum(found.values()), found["position uncertain"], found["spike"]) == (4, 1, 1)
