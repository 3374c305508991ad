"""Figures of a chart against integrals and areas computed from the known bottom."""

import json
from dataclasses import replace

import numpy as np
import pytest
import shapely
from charted_lake import BOTTOM, HOLE, LAKE, charted_lake, survey
from scipy.integrate import dblquad
from sounded_lake import bowl, lake, soundings

from mission_tools.bathymetry.crossings import Crossings
from mission_tools.bathymetry.depth_chart import ChartSettings, charted
from mission_tools.bathymetry.s44 import ORDERS, tvu_m
from mission_tools.errors import UsageError

CHART = charted_lake()


def test_area_and_volume_are_within_one_per_cent_of_the_integral() -> None:
    whole = lake(160.0, 120.0)
    bottom = bowl(whole, 42)
    made = charted(whole, soundings(whole, bottom, 42, spacing_m=10.0), ChartSettings(clearance_m=2.0))

    def depth(turn: float, share: float) -> float:  # times the area's element in an ellipse
        east, north = 80.0 * share * np.cos([turn]), 60.0 * share * np.sin([turn])
        return float(bottom(east, north)[0]) * 4800.0 * share

    volume_m3, _ = dblquad(depth, 0.0, 1.0, 0.0, 2.0 * np.pi, epsrel=1e-4)
    figures = made.figures()
    assert figures["surveyed_share"] > 0.99
    assert figures["volume_m3"] == pytest.approx(volume_m3, rel=0.01)
    assert figures["area_m2"] == pytest.approx(np.pi * 80.0 * 60.0, rel=0.01)
    assert figures["mean_depth_m"] == pytest.approx(figures["volume_m3"] / figures["area_m2"], abs=1e-4)
    raised = replace(made, settings=replace(made.settings, level_m=0.5)).figures()
    assert raised["volume_m3"] == pytest.approx(volume_m3 + 0.5 * np.pi * 4800.0, rel=0.01)
    assert made.below(-3.0)[0] < made.below(-1.0)[0] < figures["area_m2"]


def test_the_hole_is_the_gap_and_lowers_coverage() -> None:
    assert shapely.get_num_geometries(CHART.gaps) == 1
    assert CHART.gaps.contains(shapely.Point(*HOLE))
    assert 60.0 < CHART.gaps.area < np.pi * 11.0**2
    assert 0.95 < CHART.coverage < 0.99
    assert CHART.unknown.contains(shapely.Point(*HOLE))
    row, column = CHART.surface.grid.cells(*(np.array([at]) for at in HOLE))
    assert np.isnan(CHART.surface.depth_m[row, column]).all()


def test_soundings_are_counted_by_reason_and_figures_are_json() -> None:
    found = CHART.figures()["soundings"]
    assert found["position jump"] == 10
    assert found["multiple echo"] == found["weeds"] == 10
    assert found["no bottom"] >= np.isnan(survey().depth_m).sum()
    assert sum(found.values()) == len(survey().depth_m)
    json.dumps(CHART.figures(), allow_nan=False)


def test_crossings_tell_the_order_and_few_tell_none() -> None:
    figures = CHART.figures()
    assert figures["within_order"]["special"] == 1.0
    assert figures["meets_order"]
    assert tvu_m("special", np.array([10.0])) == pytest.approx([np.sqrt(0.25**2 + 0.075**2)])
    assert tvu_m("2", np.array([100.0])) == pytest.approx([np.sqrt(1.0 + 2.3**2)])
    assert list(ORDERS) == ["special", "1a", "1b", "2"]
    few = np.zeros(0)
    alone = replace(CHART, crossings=Crossings(few, few, few, few, few)).figures()
    assert alone["within_order"]["1b"] is None
    assert not alone["meets_order"]


def test_seven_crossings_meet_no_order_and_no_sounding_is_told_with_the_reasons() -> None:
    for count in (7, 8):
        some = np.zeros(count)
        made = replace(CHART, crossings=Crossings(some, some, some, some, some))
        assert made.figures()["meets_order"] == (count == 8)
    s = survey()
    with pytest.raises(UsageError, match=f"{len(s.depth_m)} no bottom"):
        charted(LAKE, replace(s, depth_m=s.depth_m * np.nan), ChartSettings())


def test_hypsography_falls_from_the_whole_area_to_nothing() -> None:
    depths, areas = CHART.hypsography()
    assert areas[0] == CHART.below(0.0)[0]
    assert areas[-1] == 0.0
    assert (np.diff(areas) <= 0.0).all()
    east, north = np.meshgrid(*CHART.surface.grid.middles)
    deep = (BOTTOM(east, north) > depths[10]).sum() * CHART.surface.grid.cell_m**2
    assert areas[10] == pytest.approx(deep, rel=0.05)
