"""A task in parts: each comes home on its pack, nothing is left out, and no other cut has fewer."""

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import combinations, pairwise
from pathlib import Path

import numpy as np
import pytest
import shapely
from task_waters import FRAME, basin

from companion.core.geo import LatLon, Point, distance_m, path_length_m
from mission_tools.assembly.map_source import MapSource
from mission_tools.assembly.open_source import open_source
from mission_tools.assembly.plan_options import PlanOptions, Via
from mission_tools.assembly.planned_mission import PlannedMission
from mission_tools.contract.budget import planned_budget
from mission_tools.contract.split import HEADROOM, Split, split
from mission_tools.costs.boat import Boat, load_boat
from mission_tools.errors import BeyondRange, UsageError
from mission_tools.maps import Chart, Source
from mission_tools.maps.source import RouteDefaults
from mission_tools.mission.mission import Command, Frame, Mission, MissionItem
from mission_tools.tasks.task_route import TaskLeg
from sitl.courses.missions import wire_items
from sitl.run.mission_run import MissionRun
from sitl.scenarios.scenario import load_scenario

pytestmark = pytest.mark.slow

LAKE = load_boat("lake")
HOME = Point(20.0, 20.0)
ISLAND = shapely.box(180.0, 80.0, 240.0, 130.0)
BASIN = basin(ISLAND, width_m=400.0, height_m=220.0)


def packed(capacity_mah: float) -> Boat:
    return replace(LAKE, capacity_mah=capacity_mah)


def planned(options: PlanOptions, chart: Chart = BASIN, home: Point = HOME) -> PlannedMission:
    source = Source(chart, RouteDefaults(start=home, clearance_m=4.0))
    return MapSource("basin", source, replace(options, split=True, boat="lake")).prepare()


def surveyed() -> PlannedMission:
    return planned(PlanOptions(survey="all", footprint_m=30.0, angle_deg=0.0))


def toured(
    places: Sequence[Point], hold_s: float | None = None, *, any_order: bool = False
) -> PlannedMission:
    via = tuple(Via(FRAME.to_global(place)) for place in places)
    return planned(PlanOptions(via=via, hold_s=hold_s, any_order=any_order))


def legs(found: Split, kinds: Sequence[str]) -> list[list[TaskLeg]]:
    return [
        [leg for leg in part.planned.task.legs if leg.kind in kinds]
        for part in found.parts
        if part.planned.task is not None
    ]


def lines(found: Sequence[TaskLeg]) -> shapely.MultiLineString:
    return shapely.MultiLineString([[(at.east_m, at.north_m) for at in leg.points] for leg in found])


@pytest.mark.parametrize("capacity_mah", [900.0, 1200.0, 2000.0, 9000.0])
def test_every_piece_of_a_survey_is_in_exactly_one_part_and_each_part_comes_home(capacity_mah: float) -> None:
    whole, boat = surveyed(), packed(capacity_mah)
    assert whole.task is not None
    found = split(whole, boat)
    work = ("track", "shore")
    wanted = lines([leg for leg in whole.task.legs if leg.kind in work])
    sailed = lines([leg for part in legs(found, work) for leg in part])
    assert sailed.length == pytest.approx(wanted.length, rel=1e-9), "nothing is sailed twice"
    assert sailed.hausdorff_distance(wanted) < 1e-6
    assert wanted.difference(sailed.buffer(1e-6)).length < 1e-6
    for part in found.parts:
        points = part.planned.points
        assert distance_m(points[0], points[-1]) < 0.02
        assert distance_m(points[0], HOME) < 0.02
        assert min(BASIN.leg_clearance_m(a, b) for a, b in pairwise(points)) > 4.59  # clearance and margin
        again = planned_budget(part.planned, boat)
        assert again == part.budget
        assert again.suffices is True
        assert again.charge_mah < (1.0 - HEADROOM) * again.usable_mah
    assert found.least <= len(found.parts)
    straight_mah = wanted.length * float(boat.drawn_a(np.array([boat.cruise_m_s]))[0]) / 3.6 / boat.cruise_m_s
    assert straight_mah < found.work_mah < 1.5 * straight_mah, (
        "corners cost more, ways to the work do not count"
    )
    assert (len(found.parts) == 1) is (capacity_mah == 9000.0)


def test_a_track_is_cut_only_where_that_saves_a_part_and_then_sailed_on_where_it_was_left() -> None:
    long = basin(width_m=900.0, height_m=90.0)  # with home in its middle, where half of a track ends as well
    options = PlanOptions(survey="all", footprint_m=30.0, angle_deg=90.0, shore_passes=0)
    along = planned(options, long, Point(45.0, 450.0))
    assert along.task is not None
    tracks = [leg for leg in along.task.legs if leg.kind == "track"]
    found = split(along, packed(1600.0))
    assert [leg for part in legs(found, ("track",)) for leg in part] == tracks
    assert len(found.parts) == 2
    short = split(along, packed(1200.0))
    stretches = [leg for part in legs(short, ("track",)) for leg in part]
    assert len(stretches) > len(tracks)
    ends = [leg.points[-1] for leg in stretches if leg.points[-1] not in {leg.points[-1] for leg in tracks}]
    starts = [leg.points[0] for leg in stretches if leg.points[0] not in {leg.points[0] for leg in tracks}]
    assert ends == starts


def brute_force(order: Sequence[Point], boat: Boat, hold_s: float) -> tuple[int, float]:
    """The fewest parts of places in this order, and the least way: every cut is tried, each part is planned
    as a tour of its own.
    """
    best = (len(order) + 1, math.inf)
    cautious = replace(boat, capacity_mah=(1.0 - HEADROOM) * boat.capacity_mah)
    tours = {
        (i, j): toured(order[i:j], hold_s) for i in range(len(order)) for j in range(i + 1, len(order) + 1)
    }
    fits = {key: planned_budget(tour, cautious).suffices for key, tour in tours.items()}
    for count in range(len(order)):
        for cuts in combinations(range(1, len(order)), count):
            spans = list(pairwise((0, *cuts, len(order))))
            if all(fits[span] for span in spans):
                way_m = sum(path_length_m(tours[span].points) for span in spans)
                best = min(best, (len(spans), way_m))
    return best


PLACES = [
    Point(200.0, 60.0),
    Point(150.0, 380.0),
    Point(30.0, 300.0),
    Point(60.0, 130.0),
    Point(190.0, 200.0),
]


@pytest.mark.parametrize(
    ("seed", "capacity_mah"), [(0, 520.0), (0, 760.0), (0, 1000.0), *((seed, 700.0) for seed in range(1, 6))]
)
def test_no_other_cut_of_the_same_order_has_fewer_parts_or_as_many_with_a_shorter_way(
    seed: int, capacity_mah: float
) -> None:
    boat, draw = packed(capacity_mah), np.random.default_rng(seed)
    anywhere = [Point(*draw.uniform((10.0, 10.0), (210.0, 390.0))) for _ in range(12)]
    room = BASIN.navigable.buffer(-6.0)
    afloat = [at for at in anywhere if room.contains(shapely.Point(at.east_m, at.north_m))]
    places = afloat[:6] if seed else PLACES
    found = split(toured(places, 20.0), boat)
    count, way_m = brute_force(places, boat, 20.0)
    assert len(found.parts) == count
    assert sum(part.budget.length_m for part in found.parts) == pytest.approx(way_m, abs=0.5)


def test_a_tour_in_parts_holds_at_every_place_once() -> None:
    found = split(toured(PLACES, 20.0, any_order=True), packed(600.0))
    stops = [
        (round(point.north_m), round(point.east_m), hold_s)
        for part in found.parts
        if part.planned.task
        for point, hold_s in part.planned.task.waypoints
        if hold_s > 0.0
    ]
    assert sorted(stops) == sorted((round(at.north_m), round(at.east_m), 20.0) for at in PLACES)
    assert found.whole.task is not None
    assert found.whole.task.hold_s == 100.0
    assert len(found.whole.mission.items) == sum(len(part.planned.mission.items) for part in found.parts)


def test_a_place_that_no_pack_reaches_is_named() -> None:
    with pytest.raises(
        BeyondRange, match=r"no pack takes the boat to 50\.00179\d,-1\.19472\d and home with 1.5 times"
    ):
        split(toured([Point(30.0, 60.0), Point(200.0, 378.0)]), packed(200.0))
    with pytest.raises(UsageError, match=r"--split: set battery\.cruise_a or battery\.draw"):
        split(toured(PLACES), replace(LAKE, draw=()))


def test_a_current_splits_alike_while_it_stays_and_not_at_all_while_it_turns(tmp_path: Path) -> None:
    still, against = (split(toured(PLACES), packed(760.0), water) for water in (None, "0.8,180"))
    assert len(against.parts) > len(still.parts)
    tide = tmp_path / "tide.npz"
    axes = {"time_s": [0.0, 3600.0], "east_m": [0.0], "north_m": [0.0]}
    flow = {name: [[[0.0]], [[1.0]]] for name in ("current_east_m_s", "current_north_m_s")}
    np.savez(tide, **{name: np.array(values) for name, values in (axes | flow).items()})  # type: ignore[arg-type]
    with pytest.raises(UsageError, match="--split: only in a current that stays"):
        split(toured(PLACES), packed(760.0), str(tide))


def of_file(*items: MissionItem, home: Point | None = HOME) -> PlannedMission:
    mission = Mission(items, home=None if home is None else FRAME.to_global(home))
    return PlannedMission("file", mission, BASIN)


def test_the_legs_of_a_mission_are_cut_and_its_speed_stays() -> None:
    ways = [Point(30.0, 60.0), Point(200.0, 60.0), Point(200.0, 300.0), Point(30.0, 300.0)]
    items = [MissionItem.at(FRAME.to_global(at), params=(7.0, 0.0, 0.0, 0.0)) for at in ways]
    whole = of_file(*items)
    whole = replace(whole, mission=whole.mission.at_speed(1.5))
    found = split(whole, packed(450.0))
    assert len(found.parts) >= 2
    tracks = [leg for part in legs(found, ("track",)) for leg in part]
    assert sum(leg.length_m for leg in tracks) == pytest.approx(path_length_m(ways), abs=0.1)
    assert sum(leg.hold_s for part in legs(found, ("track", "transit")) for leg in part) == 28.0
    for part in found.parts:
        assert part.planned.mission.items[0].command == Command.DO_CHANGE_SPEED
        assert part.planned.mission.speed_m_s == 1.5
        assert min(BASIN.leg_clearance_m(a, b) for a, b in pairwise(part.planned.points)) > 3.9


def test_a_leg_that_is_cut_in_the_middle_is_held_at_once_at_its_end() -> None:
    ways = [Point(n, e) for n in (15.0, 45.0, 75.0) for e in ((5.0, 895.0) if n != 45.0 else (895.0, 5.0))]
    items = [MissionItem.at(FRAME.to_global(at), params=(7.0, 0.0, 0.0, 0.0)) for at in ways]
    whole = replace(of_file(*items, home=Point(45.0, 450.0)), chart=basin(width_m=900.0, height_m=90.0))
    found = split(whole, packed(1200.0))
    assert len([leg for part in legs(found, ("track",)) for leg in part]) > len(ways) - 1
    assert sum(leg.hold_s for part in legs(found, ("track", "transit")) for leg in part) == 7.0 * len(ways)


def test_a_mission_that_cannot_be_cut_says_why() -> None:
    place = MissionItem.at(LatLon(50.001, -1.199))
    with pytest.raises(UsageError, match="item 2 is no waypoint: only a mission of waypoints"):
        split(of_file(place, MissionItem(Command.DO_JUMP, Frame.MISSION, (1.0, 2.0, 0.0, 0.0))), LAKE)
    with pytest.raises(UsageError, match="parts begin and end at home: add --start-at"):
        split(of_file(place, home=None), LAKE)
    with pytest.raises(UsageError, match=r"--split: add --boat BOAT\.toml"):
        open_source("lake", PlanOptions(split=True))
    with pytest.raises(UsageError, match="ways home need a map: add --check-on MAP"):
        open_source("some.plan", PlanOptions(split=True, boat="lake"))


@pytest.mark.parametrize("seed", [1])
def test_no_part_of_a_survey_of_the_pond_turns_home_by_itself(tmp_path: Path, seed: int) -> None:
    corners = [[-1.2032, 49.9986], [-1.2008, 49.9986], [-1.2008, 49.9996], [-1.2032, 49.9996]]
    area = tmp_path / "area.geojson"
    area.write_text(f'{{"type": "Polygon", "coordinates": [{[*corners, corners[0]]}]}}')
    options = PlanOptions(survey=str(area), footprint_m=30.0, split=True, boat="lake")
    found = split(open_source("lake", options).prepare(), packed(400.0))
    assert len(found.parts) == 3
    pack = [f"seed={seed}", "battery.capacity_mah=400", "vehicle.battery.capacity_mah=400"]
    for part in found.parts:
        run = MissionRun(load_scenario("lake", pack), wire_items(part.planned.mission))
        result = run.run()
        texts = [event.text for event in run.timeline.events if event.kind == "text"]
        assert result.completed, texts
        assert not [text for text in texts if "Failsafe" in text]
        assert part.budget.time_s == pytest.approx(
            result.time_s, rel=0.1, abs=6.0
        )  # the last part is a minute long
