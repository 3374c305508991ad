"""Time and charge of a route, by hand and in figures of the emulator."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import shapely

from companion.config.boat_config import BoatConfig
from companion.core.errors import ConfigError
from companion.core.geo import LatLon, LocalFrame, Point
from mission_tools.assembly.map_source import MapSource
from mission_tools.assembly.plan_options import PlanOptions
from mission_tools.contract.budget import Budget, budget_of, planned_budget
from mission_tools.contract.ways_home import ways_home_m
from mission_tools.costs.boat import Boat, load_boat
from mission_tools.costs.current import Current, River, UniformCurrent
from mission_tools.costs.current_source import open_current
from mission_tools.errors import BeyondRange, NoRoute, UsageError
from mission_tools.maps import Source, build_chart
from mission_tools.mission.route import mission_along
from sitl.courses.missions import wire_items
from sitl.run.mission_run import MissionRun
from sitl.scenarios.scenario import load_scenario
from sitl.world.truth import Truth

pytestmark = pytest.mark.slow

OPEN = build_chart("sea", LocalFrame(LatLon(50.0, -1.2)), None, ())
CRUISE_A = 0.6 + 1.08 * 3.0
BOAT = replace(
    load_boat(None), cruise_m_s=2.0, top_m_s=3.0, capacity_mah=1000.0, draw=((2.0, CRUISE_A),), idle_a=0.6
)
NEAR = LatLon(49.9995, -1.2010)  # from the start of the lake, round a corner
OUT = [Point(0.0, 0.0), Point(1000.0, 0.0)]


def budget(
    points: list[Point] = OUT,
    boat: Boat = BOAT,
    holds_s: list[float] | None = None,
    speed_m_s: float | None = None,
    current: Current | None = None,
) -> Budget:
    holds_s = holds_s or [0.0] * (len(points) - 1)
    ways_m = ways_home_m(OPEN, points, 4.0)
    return budget_of(points, holds_s, ways_m, boat, speed_m_s, current or UniformCurrent())


def test_a_straight_way_takes_its_length_at_cruise_speed_and_a_start_and_a_stop() -> None:
    found = budget()
    # speeding up at 0.6 m/s² costs half of its 3.3 s; 2 m before its end the mission is over, and the boat
    # then has slowed down from 2 m/s to √(2 × 0.4 × 2) m/s at 0.4 m/s²
    slowing_s = (2.0 - math.sqrt(1.6)) ** 2 / (2.0 * 2.0 * 0.4)
    assert found.time_s == pytest.approx(500.0 + 0.5 * 2.0 / 0.6 + slowing_s - 2.0 / 2.0, abs=0.01)
    sailing_a = 0.6 + 1.08 * 3.0
    assert found.charge_mah == pytest.approx(sailing_a * found.time_s / 3.6, rel=1e-6)
    assert (found.home_m, found.home_s) == (1000.0, 500.0)
    assert found.home_mah == pytest.approx(sailing_a * 500.0 / 3.6)


def test_a_slower_boat_draws_less_in_all() -> None:
    slow = budget(speed_m_s=1.0)
    drawn_a = 0.6 + 1.08 * 3.0 * 0.5**2.1
    assert slow.charge_mah == pytest.approx(drawn_a * slow.time_s / 3.6, rel=1e-6)


def test_a_sharp_corner_costs_the_time_to_slow_down_and_to_gain_speed() -> None:
    straight = budget([Point(0.0, 0.0), Point(100.0, 0.0), Point(200.0, 0.0)])
    gentle = budget([Point(0.0, 0.0), Point(100.0, 0.0), Point(100.0, 100.0)])
    turning_s = 0.7 * 0.5 * math.pi / 0.65  # the fillet itself is sailed at 1.97 m/s
    assert gentle.time_s == pytest.approx(straight.time_s + turning_s, abs=0.01)
    drawn_mah = (turning_s * (0.6 + 1.08 * 3.0) + 4.0 * 1.08 * 3.0 * 0.5 * math.pi) / 3.6
    assert gentle.charge_mah == pytest.approx(straight.charge_mah + drawn_mah, abs=0.05)
    back = budget([Point(0.0, 0.0), Point(100.0, 0.0), Point(0.0, 0.0)])
    on_the_spot_s = math.pi / 0.65
    assert back.time_s == pytest.approx(straight.time_s + 2.0 / 0.8 + 2.0 / 1.2 + on_the_spot_s, abs=0.2)


def test_a_corner_that_is_sharper_is_taken_more_slowly() -> None:
    ahead = [Point(0.0, 0.0), Point(100.0, 0.0)]
    back = Point(100.0 - 50.0, 100.0 * math.sin(math.pi / 3.0))  # 120° to the right
    slowest_m_s = math.sqrt(0.8 * 2.0)  # the fillet's radius is the waypoint's, as 1 / cos 60° is 2
    slowing_s = (2.0 - slowest_m_s) ** 2 / (2.0 * 2.0) * (1.0 / 0.4 + 1.0 / 0.6)
    turning_s = 0.7 * (2.0 * math.pi / 3.0) / 0.65
    straight = budget([*ahead, Point(200.0, 0.0)])
    assert budget([*ahead, back]).time_s == pytest.approx(straight.time_s + slowing_s + turning_s, abs=1e-3)


@pytest.mark.parametrize("by_rad", [0.5, 2.0, -2.3])
def test_a_budget_is_the_same_whichever_way_the_whole_is_turned(by_rad: float) -> None:
    def turned(at: Point) -> Point:
        north_m = at.north_m * math.cos(by_rad) - at.east_m * math.sin(by_rad)
        return Point(north_m, at.north_m * math.sin(by_rad) + at.east_m * math.cos(by_rad))

    way, current = [Point(0.0, 0.0), Point(300.0, 50.0), Point(200.0, -150.0)], Point(0.7, -1.1)
    found = budget(list(map(turned, way)), current=UniformCurrent(*turned(current)))
    expected = budget(way, current=UniformCurrent(*current))
    assert (found.time_s, found.charge_mah) == pytest.approx((expected.time_s, expected.charge_mah))
    assert (found.home_s, found.home_mah) == pytest.approx((expected.home_s, expected.home_mah))


@pytest.mark.parametrize("radius_m", [3.0, 0.8])
def test_a_boat_that_cannot_turn_on_the_spot_sails_half_a_circle_at_a_sharp_corner(radius_m: float) -> None:
    way = [Point(0.0, 0.0), Point(100.0, 0.0), Point(0.0, 0.0)]
    rudder = replace(BOAT, least_radius_m=radius_m)
    wait_s = radius_m * math.pi / 0.4 - math.pi / 0.65  # at the slowest speed, rather than on the spot
    assert budget(way, rudder).time_s == pytest.approx(budget(way).time_s + wait_s, abs=0.1)


def test_the_current_is_that_of_where_the_boat_is() -> None:
    river = River((Point(30.0, 0.0), Point(30.0, 400.0)), 60.0, 1.0)
    way = [Point(30.0, 10.0), Point(30.0, 210.0)]
    found, expected = budget(way, current=river), budget(way, current=UniformCurrent(0.0, 1.0))
    assert found.charge_mah == pytest.approx(expected.charge_mah)
    assert found.home_mah == pytest.approx(expected.home_mah)


def test_a_hold_draws_what_station_keeping_does() -> None:
    longer, brief = budget(holds_s=[101.0]), budget(holds_s=[1.0])
    assert longer.time_s - brief.time_s == pytest.approx(100.0)
    assert longer.charge_mah - brief.charge_mah == pytest.approx((0.6 + 0.06 * 1.08 * 3.0) * 100.0 / 3.6)


def test_a_stop_on_the_way_is_slowed_down_for_and_sped_up_from_and_held_in_the_current() -> None:
    way = [Point(0.0, 0.0), Point(100.0, 0.0), Point(200.0, 0.0)]
    stop_s = 0.5 * 2.0 / 0.4 + 0.5 * 2.0 / 0.6
    longer, still = budget(way, holds_s=[50.0, 0.0]), budget(way)
    assert longer.time_s - still.time_s == pytest.approx(50.0 + stop_s)
    drawn_mah = (3.84 * stop_s + (0.6 + 0.06 * 1.08 * 3.0) * 50.0) / 3.6
    assert longer.charge_mah - still.charge_mah == pytest.approx(drawn_mah)
    river = UniformCurrent(0.6, 0.8)
    held = budget(way, holds_s=[50.0, 0.0], current=river).charge_mah - budget(way, current=river).charge_mah
    assert held == pytest.approx((3.84 * stop_s + BOAT.held_a(1.0) * 50.0) / 3.6)
    with pytest.raises(NoRoute, match="leg 2 cannot"):
        budget([*way[:2], Point(100.0, 100.0)], current=UniformCurrent(0.0, -2.95))


def test_a_current_from_ahead_costs_charge_and_no_time_while_the_boat_can_stem_it() -> None:
    against = budget(current=UniformCurrent(-0.5, 0.0))
    assert against.time_s == pytest.approx(budget().time_s)
    assert against.charge_mah > 1.3 * budget().charge_mah
    assert against.home_mah < budget().home_mah
    slowed = budget(current=UniformCurrent(-2.0, 0.0))
    assert slowed.time_s == pytest.approx(1000.0, rel=0.01)  # 3 m/s less 2
    with pytest.raises(NoRoute, match="leg 1 cannot be sailed against the current at 3 m/s"):
        budget(current=UniformCurrent(-2.95, 0.0))


def test_a_current_from_abeam_takes_its_part_of_the_speed_through_the_water() -> None:
    abeam = budget(current=UniformCurrent(0.0, 1.5))
    through_m_s = math.hypot(2.0, 1.5)
    drawn_a = 0.6 + 1.08 * 3.0 * (through_m_s / 2.0) ** 2.7
    assert abeam.charge_mah == pytest.approx(drawn_a * 500.0 / 3.6, rel=0.01)


def test_the_point_of_no_return_leaves_the_margin_for_the_way_home() -> None:
    boat = replace(BOAT, capacity_mah=1000.0, reserve=0.1, margin=1.5)
    per_m = (0.6 + 1.08 * 3.0) / 3.6 / 2.0  # mAh
    far = [Point(0.0, 0.0), Point(1600.0, 0.0)]
    found = budget(far, boat)
    expected_m = 900.0 / (per_m * 2.5)  # what is left after s is 900 − s p, and 1.5 s p is wanted
    assert found.no_return_m is not None
    assert expected_m - 10.0 <= found.no_return_m <= expected_m
    with pytest.raises(BeyondRange, match="does not come home"):
        found.check()
    found.check(one_way=True)
    assert found.lines() == [
        "budget: 13 min 21 s, 854 of 900 mAh; home from there 1600 m, 13 min 20 s, 853 mAh",
        "point of no return: after 672 m",
    ]
    assert budget(far, replace(boat, margin=1.0)).no_return_m > found.no_return_m + 100.0  # type: ignore[operator]
    assert budget(far, replace(boat, reserve=0.3)).no_return_m < found.no_return_m - 100.0  # type: ignore[operator]


def left_beside(way: list[Point], factor: float, holds_s: list[float] | None = None) -> bool | None:
    """Whether a pack suffices that has factor times the charge of the straight way home left at the end."""
    found = budget(way, holds_s=holds_s)
    capacity_mah = found.charge_mah + factor * found.home_mah
    return budget(way, replace(BOAT, reserve=0.0, capacity_mah=capacity_mah), holds_s).suffices


def test_the_boat_believes_that_the_way_home_takes_what_its_last_half_minute_took_corners_included() -> None:
    zigzag = [Point(20.0 * n, 20.0 * (n % 2)) for n in range(40)]  # 90° each
    found = budget(zigzag)
    dearer = found.charge_mah / found.length_m / ((0.6 + 1.08 * 3.0) / 3.6 / 2.0)
    assert dearer > 1.4
    assert left_beside(zigzag, 1.5 * dearer * 1.06) is True
    assert left_beside(zigzag, 1.5 * dearer * 0.94) is False
    after_200_m = [*zigzag, Point(zigzag[-1].north_m + 200.0, 20.0)]
    assert left_beside(after_200_m, 1.5 * 1.25) is True, "it has half forgotten the corners"


def test_holds_and_turns_on_the_spot_say_nothing_about_the_way_home() -> None:
    out = [Point(0.0, 0.0), Point(500.0, 0.0), Point(400.0, 0.0), Point(700.0, 0.0)]
    assert left_beside(out, 1.55) is True
    assert left_beside(out, 1.55, [0.0, 120.0, 0.0]) is True


def test_a_route_that_leads_home_is_good_as_long_as_it_always_could_turn_back() -> None:
    there_and_back = [Point(0.0, 0.0), Point(600.0, 0.0), Point(0.0, 0.0)]
    found = budget(there_and_back)
    assert (found.home_m, found.no_return_m) == (0.0, None)
    found.check()
    assert found.lines() == [
        "budget: 10 min 10 s, 662 of 900 mAh",
        "comes home from everywhere on it with 1.5 times the charge for the way",
    ]


def test_a_budget_suffices_where_the_boat_always_comes_home_and_says_the_way_home() -> None:
    assert (
        budget([Point(0.0, 0.0), Point(0.5, 0.0)]).lines()[0].endswith("home from there 0.50 m, 0 s, 0 mAh")
    )
    assert budget([Point(0.0, 0.0), Point(600.0, 0.0), Point(0.0, 0.0)]).suffices is True
    assert budget([Point(0.0, 0.0), Point(1600.0, 0.0)]).suffices is False
    assert budget([Point(0.0, 0.0), Point(3000.0, 0.0)]).suffices is False
    assert budget(boat=replace(BOAT, draw=(), idle_a=0.0)).suffices is None


def test_a_charge_that_does_not_last_is_refused_one_way_too() -> None:
    found = budget([Point(0.0, 0.0), Point(3000.0, 0.0)])
    assert found.reached_m == pytest.approx(900.0 / ((0.6 + 1.08 * 3.0) / 7.2), abs=20.0)
    assert found.lines()[1:] == ["the charge lasts for 1680 m of 3000 m"]
    said = "the charge lasts for 1680 m of 3000 m: 1601 mAh are needed, 900 can be used"
    with pytest.raises(BeyondRange, match=said):
        found.check(one_way=True)
    assert (found.capacity_mah, found.margin) == (1000.0, 1.5)
    assert budget(boat=replace(BOAT, capacity_mah=1.0)).reached_m == 0.0


def test_without_a_draw_there_is_a_time_and_no_charge() -> None:
    found = budget(boat=replace(BOAT, draw=(), idle_a=0.0))
    assert found.time_s > 500.0
    assert math.isnan(found.charge_mah)
    found.check()
    assert found.lines()[0].startswith(
        "budget: 8 min 21 s; home from there 1000 m, 8 min 20 s; no charge: set"
    )


def test_the_way_home_is_straight_in_open_water() -> None:
    box = build_chart("sea", OPEN.frame, None, ())
    points = [Point(0.0, 0.0), Point(100.0, 0.0), Point(100.0, 100.0)]
    assert ways_home_m(box, points, 4.0) == [0.0, 100.0, pytest.approx(math.hypot(100.0, 100.0))]


def test_the_way_home_is_the_shortest_round_an_island_also_from_a_home_ashore() -> None:
    water = shapely.box(-200.0, -200.0, 200.0, 200.0).difference(shapely.box(-20.0, 20.0, 20.0, 80.0))
    chart = build_chart("lake", OPEN.frame, water, ())
    points = [Point(0.0, 0.0), Point(50.0, -60.0), Point(0.0, 100.0), Point(100.0, 0.0), Point(83.0, 0.0)]
    found = ways_home_m(chart, points, 4.0)
    assert found[:3] == pytest.approx([0.0, math.hypot(50.0, 60.0), 100.0])
    at_the_corners_m = 60.0 + 2.0 * math.hypot(20.0, 20.0)
    outside_them_m = 68.0 + 2.0 * math.hypot(16.0, 24.0)
    assert at_the_corners_m < found[3] < outside_them_m
    assert found[4] == pytest.approx(found[3] + 17.0), "nearer to the shore than 4 m: along the route"
    jetty = [Point(18.0, 0.0), *points[1:4]]
    assert ways_home_m(chart, jetty, 4.0)[2] == pytest.approx(2.0 + math.hypot(16.0, 100.0), abs=0.1)


def test_a_speed_beyond_the_boat_is_refused() -> None:
    with pytest.raises(UsageError, match="top speed of 3 m/s"):
        budget(speed_m_s=4.0)


def test_a_boat_is_read_from_its_own_file_and_from_an_emulated_ones(tmp_path: Path) -> None:
    (tmp_path / "b.toml").write_text(
        "[battery]\ncapacity_mah = 7000.0\ncruise_a = 4.0\n[speed]\ncruise_m_s = 1.5\n"
    )
    boat = load_boat(str(tmp_path / "b.toml"))
    assert (boat.name, boat.capacity_mah, boat.draw, boat.cruise_m_s) == (
        "b",
        7000.0,
        ((1.5, 1.08 * 4.0),),
        1.5,
    )
    default = BoatConfig()
    assert boat.most_fence_items == default.mission.max_fence_items
    assert boat.margin == default.failsafe.range_margin
    assert load_boat("lake").capacity_mah == 5000.0
    assert load_boat("kit").cruise_m_s == 1.2
    with pytest.raises(UsageError, match=r"no such boat \(there are: .*kit, lake, pool"):
        load_boat("canoe")
    (tmp_path / "c.toml").write_text("[battery]\ncruise = 4.0\n")
    with pytest.raises(ConfigError, match="cruise"):
        load_boat(str(tmp_path / "c.toml"))


@pytest.mark.parametrize(("name", "from_deg"), [("catamaran", 0.0), ("rudder", 90.0)])
def test_the_emulator_sails_the_budget_in_a_wind_with_gusts(name: str, from_deg: float) -> None:
    settings = [f"boat.model={name}", "environment.wind_m_s=5", f"environment.wind_from_deg={from_deg}"]
    scenario = load_scenario("open", [*settings, "environment.gust_m_s=7.5"])
    way = [Point(0.0, 0.0), Point(100.0, 20.0)]
    run = MissionRun(scenario, wire_items(mission_along([scenario.frame.to_global(point) for point in way])))
    result = run.run()
    assert result.completed
    sailed_mah = float(run.sailed_rows[:, Truth._fields.index("current_a")].sum()) * 0.02 / 3.6
    found = budget(way, load_boat(name, f"5@{from_deg}"))
    assert found.time_s == pytest.approx(result.time_s, rel=0.03)
    assert found.charge_mah == pytest.approx(sailed_mah, rel=0.1)


def test_in_a_tide_that_turns_under_way_the_emulator_sails_the_times_of_the_budget(tmp_path: Path) -> None:
    path, time_s = tmp_path / "tide.npz", np.arange(0.0, 600.0, 10.0)
    along = (-1.6 * np.cos(2.0 * math.pi * time_s / 300.0))[:, np.newaxis, np.newaxis]  # begins from ahead
    np.savez(
        path,
        time_s=time_s,
        north_m=[0.0],
        east_m=[0.0],
        current_north_m_s=along,
        current_east_m_s=0.3 * along,
    )
    scenario = load_scenario("open", ["boat.model=lake", f'environment.current_file="{path}"'])
    way = [Point(0.0, 0.0), Point(150.0, 20.0), Point(300.0, -20.0)]
    run = MissionRun(scenario, wire_items(mission_along([scenario.frame.to_global(point) for point in way])))
    result = run.run()
    assert result.completed
    tide = open_current(str(path), scenario.frame)
    sailed_mah = float(run.sailed_rows[:, Truth._fields.index("current_a")].sum()) * 0.02 / 3.6
    found = budget(way, load_boat("lake"), current=tide)
    assert found.time_s == pytest.approx(result.time_s, rel=0.03)
    assert found.charge_mah == pytest.approx(sailed_mah, rel=0.1)
    frozen = budget(way, load_boat("lake"), current=UniformCurrent(-1.6, -0.48))
    assert frozen.charge_mah > 1.3 * sailed_mah


def test_the_emulator_sails_the_budget_in_a_current_within_ten_percent() -> None:
    scenario = load_scenario("lake", ["environment.current_m_s=0.5", "environment.current_to_deg=90"])
    source = Source(scenario.chart, scenario.route)
    planned = MapSource("lake", source, PlanOptions(goal=NEAR)).prepare()
    found = planned_budget(planned, "lake", UniformCurrent(0.0, 0.5))
    run = MissionRun(scenario, wire_items(planned.mission))
    result = run.run()
    assert result.completed
    sailed_mah = float(run.recorder.rows[:, Truth._fields.index("current_a")].sum()) * 0.02 / 3.6
    assert found.time_s == pytest.approx(result.time_s, rel=0.1)
    assert found.charge_mah == pytest.approx(sailed_mah, rel=0.1)


@pytest.mark.parametrize("draw", [BOAT.draw, ()], ids=["of known draw", "of unknown draw"])
def test_a_boat_that_a_current_keeps_from_coming_home_is_refused_and_told_so(
    draw: tuple[tuple[float, float], ...],
) -> None:
    swept = budget(boat=replace(BOAT, draw=draw), current=UniformCurrent(north_m_s=3.5))
    assert math.isinf(swept.home_s)
    assert "no way home against current or wind" in swept.lines()[0]
    assert swept.no_return_m == 0.0
    with pytest.raises(BeyondRange, match="does not come home"):
        swept.check()
    swept.check(one_way=True)
