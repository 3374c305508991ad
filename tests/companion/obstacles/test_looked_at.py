"""Water that is known to be free."""

import math

import pytest

from companion.config.tuning import FenceSetting
from companion.core.geo import LatLon, LocalFrame, Point
from companion.geofence.fence import Fence, FenceCircle
from companion.obstacles.perception.looked_at import LookedAtWater
from companion.obstacles.perception.occupancy import Beam

HERE = Point(0.0, 0.0)
FRAME = LocalFrame(LatLon(50.0, -1.2))
BEAM_RAD = math.radians(15.0)


def fence(radius_m: float = 50.0, *, is_inclusion: bool = True) -> Fence:
    made = Fence()
    made.set_areas([FenceCircle(FRAME.origin, radius_m, is_inclusion)])
    made.update(FRAME, None, FenceSetting(enabled=True))
    return made


def looked(*bearings_deg: float, time_s: float = 0.0, reach_m: float = 4.0, times: int = 2) -> LookedAtWater:
    water = LookedAtWater()
    water.has_ranger = True
    for bearing_deg in bearings_deg * times:
        water.add(Beam(time_s, HERE, math.radians(bearing_deg), BEAM_RAD, math.inf, reach_m))
    return water


@pytest.mark.parametrize(("by_sight", "is_limited"), [(0, False), (1, True), (2, False), (3, True)])
def test_without_a_fence_the_default_and_always_limit_the_speed(by_sight: int, is_limited: bool) -> None:
    assert looked().is_limited(HERE, by_sight, Fence()) is is_limited


@pytest.mark.parametrize(("distance_m", "is_limited"), [(39.9, True), (40.1, False)])
@pytest.mark.parametrize("by_sight", [2, 3])
def test_within_forty_metres_of_what_no_map_has_the_chart_is_not_trusted(
    by_sight: int, distance_m: float, is_limited: bool
) -> None:
    water = looked()
    water.note_unmapped_obstacle(Point(-distance_m, 0.0))
    assert water.is_limited(HERE, by_sight, fence()) is is_limited
    assert not water.is_limited(HERE, 0, fence())


@pytest.mark.parametrize(("by_sight", "is_limited"), [(0, False), (2, True), (3, True)])
def test_a_chart_that_lacks_what_barred_a_planned_way_is_trusted_nowhere(
    by_sight: int, is_limited: bool
) -> None:
    water = looked()
    water.distrusts_chart = True
    assert water.is_limited(HERE, by_sight, fence()) is is_limited


def test_the_room_is_the_sight_ahead_less_the_way_made_since() -> None:
    water = looked(0.0)
    assert water.room_m(HERE, 0.0, 10.0, 0.5) == pytest.approx(4.0, abs=0.5)
    assert water.room_m(Point(1.0, 0.0), 0.0, 10.0, 0.5) == pytest.approx(3.0, abs=0.5)
    assert water.room_m(HERE, math.pi, 10.0, 0.5) == 0.0
    assert water.room_m(Point(6.0, 0.0), 0.0, 10.0, 0.5) == 0.0, "past the end of what was seen"
    assert water.room_m(Point(0.0, 6.0), 0.0, 10.0, 2.0) == 0.0, "looked at too long ago, from elsewhere"
    assert water.room_m(HERE, 0.0, 2.0, 0.5) == 2.0


def test_water_seen_through_twice_stays_known_and_once_does_not() -> None:
    assert looked(0.0).room_m(HERE, 0.0, 10.0, 60.0) == pytest.approx(4.0, abs=0.5)
    assert looked(0.0, times=1).room_m(HERE, 0.0, 10.0, 60.0) < 1.0


def test_what_lies_behind_an_echo_is_unknown() -> None:
    water = LookedAtWater()
    for _ in range(2):
        water.add(Beam(0.0, HERE, 0.0, BEAM_RAD, 2.0, 4.0))
    assert water.is_known(Point(1.4, 0.0))
    assert not water.is_known(Point(2.1, 0.0))


def test_a_longer_ranger_is_not_overruled_by_a_shorter_one() -> None:
    water = looked(0.0, reach_m=12.0)
    water.add(Beam(0.1, HERE, 0.0, BEAM_RAD, math.inf, 4.0))
    assert water.room_m(HERE, 0.0, 20.0, 0.5) >= 12.0


def test_the_frame_moves_and_all_is_forgotten() -> None:
    water = looked(0.0)
    water.note_unmapped_obstacle(HERE)
    water.clear()
    assert water.room_m(HERE, 0.0, 10.0, 0.0) == 0.0
    assert not water.is_limited(HERE, 2, Fence())
