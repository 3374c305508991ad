"""A boat with a depth sounder: shallow water stops it, its soundings are sent and logged."""

import math

import pytest
from boat_rig import Rig, scenario, waypoint
from sailing_rig import begin, tells

from companion.core.geo import Point

FITTED = "sensors.depth.fitted=true"
SHALLOW = "Failsafe: Shallow"


def shore_ahead(source: str) -> tuple[Point, Point]:
    """A place in deep water and one at the shore beyond it, on a straight line."""
    water = scenario(source)
    for degrees in range(0, 360, 10):
        north, east = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
        way = [Point(water.start.north_m + north * m, water.start.east_m + east * m) for m in range(0, 120)]
        room = [water.chart.clearance_m(place) for place in way]
        if 0.0 in room and room.index(0.0) > 25 and max(room[: room.index(0.0)]) > 12.0:
            return way[room.index(max(room[: room.index(0.0)]))], way[room.index(0.0) - 1]
    raise AssertionError("no such way")


def test_a_mission_that_leads_into_shallow_water_goes_back_the_way_it_came() -> None:
    _, ashore = shore_ahead("lake")
    rig = Rig("lake", FITTED, "faults=[]", "seed=3").ready()  # of eight runs: 0.8 to 1.3 m
    rig.sail(waypoint(ashore.north_m, ashore.east_m, "lake"))
    rig.until(lambda: tells(rig, SHALLOW), 200.0)
    nearest_m = 100.0
    for _ in range(40):
        rig.run(0.5)
        truth = rig.world.truth
        now_m = rig.scenario.chart.clearance_m(Point(truth.north_m, truth.east_m))
        nearest_m = min(nearest_m, now_m)
    assert rig.mode == "SMART_RTL"
    assert nearest_m > 1.0
    assert now_m > 5.0
    assert not truth.grounded


def under_way(*settings: str) -> Rig:
    rig = Rig("open", FITTED, *settings).sail(waypoint(600.0, 0.0))
    rig.run(8.0)
    rig.peer.forget()
    return rig


def test_a_shoal_stops_a_mission_after_two_soundings_and_deep_water_ends_it() -> None:
    rig = under_way("sensors.depth.lost_share=0.3")
    begin(rig, "depth", "wrong", -4.2)
    took_s = rig.until(lambda: tells(rig, "Failsafe: Shallow: 0."), 5.0)
    assert 1.4 < took_s < 2.6
    rig.run(0.2)
    assert rig.mode == "SMART_RTL"
    rig.world.electronics.faults.end("depth")
    assert 4.8 < rig.until(lambda: "Failsafe over: deep enough again" in rig.peer.texts, 10.0) < 6.8


@pytest.mark.parametrize("kind", ["off", "garbage"])
def test_a_faulty_sounder_stops_no_mission(kind: str) -> None:
    rig = under_way()
    begin(rig, "depth", kind)
    rig.run(15.0)
    assert rig.mode == "AUTO"
    assert not tells(rig, SHALLOW)
    assert rig.peer.texts.count("Depth sounder is silent") == (kind == "off")
