import dataclasses

import pytest
from boat_rig import HOME_ITEM, scenario, waypoint
from fence_rig import box

from companion.config.boat_config import BoatConfig
from companion.core.geo import LatLon, Point
from companion.mavlink.items import MissionItem
from mission_tools.mission.mission import Command, Fence, FencePolygon, Mission
from mission_tools.mission.mission import MissionItem as PlannedItem
from sitl.courses.missions import fence_along, plan_mission, wire_fence, wire_items
from sitl.run.mission_run import MissionRun
from sitl.run.station_commands import RunError

pytestmark = pytest.mark.slow

ITEMS = [HOME_ITEM, waypoint(20.0, 0.0), waypoint(20.0, 20.0)]


def test_a_run_is_measured_against_the_truth() -> None:
    told: list[tuple[float, int]] = []
    mission_run = MissionRun(scenario("open"), ITEMS)
    result = mission_run.run(tell=lambda time_s, seq: told.append((time_s, seq)))
    assert result.completed
    assert (result.waypoints, result.waypoints_reached) == (2, 2)
    assert result.planned_length_m == pytest.approx(40.0, abs=1.0)
    assert result.path_length_m == pytest.approx(40.0, abs=4.0)
    assert 15.0 < result.time_s < 60.0
    assert result.min_clearance_m is None  # open water has no shore
    assert result.groundings == 0
    assert result.real_time_factor == pytest.approx(result.sim_seconds / result.cpu_seconds)
    assert len(result.state_hash) == 64
    assert len(told) == pytest.approx(result.time_s, abs=2)
    assert {seq for _, seq in told} == {1, 2}


def test_the_time_that_a_mission_waits_at_its_places_counts_towards_its_limit() -> None:
    stay = dataclasses.replace(waypoint(5.0, 0.0), param1=80.0)
    result = MissionRun(scenario("open"), [HOME_ITEM, stay]).run()
    assert result.completed
    assert result.time_s > 80.0


def test_the_way_home_belongs_to_the_mission_that_asks_for_it() -> None:
    mission_run = MissionRun(scenario("open"), [*ITEMS, MissionItem(frame=2, command=20)])
    result = mission_run.run()
    truth = mission_run.lockstep.world.truth
    assert result.completed
    assert result.final_mode == "RTL"
    assert (truth.north_m**2 + truth.east_m**2) ** 0.5 < 4.0


def test_the_longest_mission_that_a_boat_takes_reaches_it() -> None:
    most = BoatConfig().mission.max_items
    long = [HOME_ITEM, *(waypoint(20.0, 0.1 * n) for n in range(most - 1))]
    mission_run = MissionRun(scenario("open"), long)
    mission_run.run(timeout_s=1.0)
    assert mission_run.lockstep.boat.vehicle.progress.last_seq == most - 1


def test_a_mission_that_the_boat_refuses_is_told_in_its_words() -> None:
    with pytest.raises(RunError, match="command 84"):
        MissionRun(scenario("open"), [HOME_ITEM, waypoint(20.0, 0.0, command=84)]).run()


def test_a_start_that_is_refused_is_told_with_its_reason() -> None:
    with pytest.raises(RunError, match="refused the start of the mission: AUTO: no mission"):
        MissionRun(scenario("open"), [HOME_ITEM]).run()


def test_the_outline_of_the_water_goes_aboard_as_a_fence_before_the_mission() -> None:
    pond = scenario("lake")
    fence = fence_along(pond)
    mission_run = MissionRun(pond, wire_items(plan_mission(pond)[0]), fence=fence)
    mission_run.run(timeout_s=1.0)
    assert mission_run.lockstep.boat.vehicle.fence.is_active
    rings = [item.param1 for item in fence]
    assert all(count >= 3 for count in rings)
    inside = [item for item in fence if item.command == 5001]
    islands = [item for item in fence if item.command == 5002]
    assert len(inside) > 20
    assert len(islands) > 20


def test_a_plan_that_moves_home_and_returns_is_sailed_to_the_new_home_inside_the_plan_s_own_fence() -> None:
    start = scenario("open").frame
    corners = tuple(start.to_global(Point(*corner)) for corner in box(-20.0, -20.0, 40.0, 20.0))
    home = PlannedItem.at(start.to_global(Point(20.0, 0.0)), Command.DO_SET_HOME)
    plan = Mission((home, PlannedItem(Command.NAV_RETURN_TO_LAUNCH)), fence=Fence((FencePolygon(corners),)))
    fence = wire_fence(plan, scenario("open"), has_outline=False)
    mission_run = MissionRun(scenario("open"), wire_items(plan), fence=fence)
    assert mission_run.run(60.0).completed
    truth = mission_run.lockstep.world.truth
    assert (truth.north_m, truth.east_m) == pytest.approx((20.0, 0.0), abs=3.0)
    assert len(mission_run.lockstep.boat.vehicle.fence.areas) == 1


def test_of_waters_that_are_apart_the_fence_is_the_one_with_the_boat_in_it() -> None:
    water = [[-50.0, -50.0], [50.0, -50.0], [50.0, 50.0], [-50.0, 50.0]]
    across = [[-60.0, 10.0], [60.0, 10.0], [60.0, 20.0], [-60.0, 20.0]]
    dam = f'{{name = "Dam", kind = "island", polygon = {across}}}'
    cut = scenario("random", f"map.water={water}", f"map.obstacles=[{dam}]", "route.start=[0.0, -20.0]")
    inclusions = [item for item in fence_along(cut) if item.command == 5001]
    norths = [cut.frame.to_local(LatLon(item.x / 1e7, item.y / 1e7)).north_m for item in inclusions]
    assert max(norths) == pytest.approx(10.0, abs=0.1)
