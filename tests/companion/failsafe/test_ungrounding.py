"""Getting off a shore."""

import itertools
import math

import pytest
from msgspec.structs import replace

from companion.config.boat_config import BoatConfig
from companion.config.fence import FenceSetting
from companion.core.geo import LatLon, LocalFrame, Point
from companion.core.intent import Drive, HoldCourse, Stop
from companion.core.state import NavState
from companion.failsafe.recovery.ungrounding import Ungrounding
from companion.geofence.fence import Fence, FencePolygon

CONFIG = BoatConfig()
FRAME = LocalFrame(LatLon(50.0, -1.2))
DT = 0.1


def fence() -> Fence:
    """Water to the south of north = 0."""
    laid = Fence()
    corners = [(-200.0, -200.0), (-200.0, 200.0), (0.0, 200.0), (0.0, -200.0)]
    laid.set_areas([FencePolygon(tuple(FRAME.to_global(Point(n, e)) for n, e in corners), is_inclusion=True)])
    laid.update(FRAME, None, FenceSetting())
    return laid


def nav_at(north_m: float, east_m: float, heading_rad: float) -> NavState:
    return NavState(0.0, north_m, east_m, heading_rad, 0.0, 0.0, 0.0, 0.0, 0.0, 0.1, 0.1)


def tries(
    refloat: Ungrounding, heading_rad: float, seconds: float, slide_m_s: float = 0.0
) -> list[tuple[float, Drive]]:
    """What is driven, and since when, by a boat that lies on the north shore."""
    begun: list[tuple[float, Drive]] = []
    was_driving, water = False, fence()
    for tick in range(round(seconds / DT)):
        now_s = tick * DT
        intent = refloat.intent(nav_at(-0.3, slide_m_s * now_s, heading_rad), water, CONFIG, now_s)
        assert isinstance(intent, Drive | Stop)
        if isinstance(intent, Drive) and not was_driving:
            begun.append((now_s, intent))
        was_driving = isinstance(intent, Drive)
    return begun


def begun_at(now_s: float = 0.0) -> Ungrounding:
    refloat = Ungrounding()
    refloat.begin(now_s)
    return refloat


@pytest.mark.parametrize("heading_deg", [80.0, -80.0, 60.0, 150.0, 20.0])
def test_by_turns_it_goes_along_the_shore_straight_off_and_turns_off(heading_deg: float) -> None:
    heading = math.radians(heading_deg)
    along, off, back, turn = (drive for _, drive in tries(begun_at(), heading, 24.0)[:4])
    side = math.copysign(1.0, math.remainder(math.pi - heading, math.tau))  # where the water is
    assert along.throttle > 0.0
    assert back.throttle < 0.0
    assert math.copysign(1.0, off.throttle) == math.copysign(1.0, math.cos(math.pi - heading))
    assert turn == Drive(0.0, side)
    assert all(drive.steering * side > 0.0 for drive in (along, off, back))


def test_the_motors_rest_between_tries_and_longer_after_each_round() -> None:
    refloat = begun_at()
    begun = [at_s for at_s, _ in tries(refloat, math.pi / 2.0, 400.0)]
    gaps = [later - at_s for at_s, later in itertools.pairwise(begun)]
    assert min(gaps) > 5.0
    assert [round(gap) for gap in gaps[3:12:4]] == [19, 34, 64]  # a try of four seconds each
    assert refloat.rounds >= 4
    assert refloat.is_running


def test_a_try_that_makes_way_goes_on_but_not_for_ever() -> None:
    begun = [at_s for at_s, _ in tries(begun_at(), math.pi / 2.0, 60.0, slide_m_s=0.3)]
    assert 20.0 < begun[1] - begun[0] < 27.0


def test_once_off_it_stands_off_and_then_ends() -> None:
    refloat, water = begun_at(), fence()
    intent = refloat.intent(nav_at(-1.5, 0.0, 0.0), water, CONFIG, 1.0)
    assert isinstance(intent, HoldCourse)
    assert abs(intent.course_rad) == pytest.approx(math.pi, abs=1e-3)  # south
    assert refloat.is_running
    assert refloat.intent(nav_at(-4.0, 0.0, 0.0), water, CONFIG, 3.0) == Stop()
    assert not refloat.is_running


def test_one_that_cannot_get_further_off_does_not_try_for_ever() -> None:
    refloat, water = begun_at(), fence()
    for second in range(30):
        refloat.intent(nav_at(-1.5, 0.0, 0.0), water, CONFIG, float(second))
    assert not refloat.is_running


ASHORE = nav_at(-0.3, 0.0, 0.0)
LOST = [None, replace(ASHORE, heading_age_s=60.0), replace(ASHORE, position_age_s=60.0)]


@pytest.mark.parametrize("nav", LOST)
def test_without_position_or_heading_it_ends(nav: NavState | None) -> None:
    refloat = begun_at()
    assert refloat.intent(nav, fence(), CONFIG, 1.0) == Stop()
    assert not refloat.is_running


def test_without_a_fence_there_is_no_shore_to_get_off() -> None:
    refloat = begun_at()
    assert refloat.intent(ASHORE, Fence(), CONFIG, 1.0) == Stop()
    assert not refloat.is_running


def test_beginning_again_does_not_begin_anew() -> None:
    refloat = begun_at()
    tries(refloat, 1.0, 100.0)
    rounds = refloat.rounds
    refloat.begin(100.0)
    assert refloat.rounds == rounds > 0
