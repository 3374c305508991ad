"""Getting off a shore."""

import itertools
import math

import pytest
from fence_rig import box
from laid_fence import area, laid

from companion.config.boat_config import BoatConfig
from companion.core.geo import Point
from companion.core.intent import Drive, HoldCourse, Intent, Stop
from companion.core.state import NavState
from companion.failsafe.actions import Trigger
from companion.failsafe.recovery.recovery import RecoveryManeuvers
from companion.geofence.fence import Fence

CONFIG = BoatConfig()
DT = 0.1


def fence() -> Fence:
    """Water to the south of north = 0."""
    return laid(area(box(-200.0, -200.0, 0.0, 200.0)))


def nav_at(north_m: float, east_m: float, heading_rad: float) -> NavState:
    return NavState(0.0, north_m, east_m, heading_rad, 0.0, 0.0, 0.0, 0.0, 0.0, 0.1, 0.1)


def tries(
    recovery: RecoveryManeuvers, heading_rad: float, seconds: float, slide_m_s: float = 0.0
) -> list[tuple[float, Drive]]:
    """What is driven, and since when, by a boat that lies on the north shore."""
    starts: list[tuple[float, Drive]] = []
    was_driving, water = False, fence()
    for tick in range(round(seconds / DT)):
        now_s = tick * DT
        intent = get_off(recovery, nav_at(-0.3, slide_m_s * now_s, heading_rad), water, now_s)
        assert isinstance(intent, Drive | Stop)
        if isinstance(intent, Drive) and not was_driving:
            starts.append((now_s, intent))
        was_driving = isinstance(intent, Drive)
    return starts


def get_off(recovery: RecoveryManeuvers, nav: NavState | None, water: Fence, now_s: float) -> Intent:
    return recovery.update(nav, water, CONFIG, 0.0, 0.0, now_s).intent


def begun() -> RecoveryManeuvers:
    recovery = RecoveryManeuvers()
    recovery.handle(Trigger.UNGROUND, 0.0)
    return recovery


@pytest.mark.parametrize("heading_deg", [80.0, -80.0, 60.0, 150.0, 20.0])
def test_by_turns_it_goes_along_the_shore_straight_off_and_turns_off(heading_deg: float) -> None:
    heading = math.radians(heading_deg)
    along, off, back, turn = (drive for _, drive in tries(begun(), heading, 24.0)[:4])
    side = math.copysign(1.0, math.remainder(math.pi - heading, math.tau))  # where the water is
    assert along.throttle > 0.0
    assert back.throttle < 0.0
    assert math.copysign(1.0, off.throttle) == math.copysign(1.0, math.cos(math.pi - heading))
    assert turn == Drive(0.0, side)
    assert all(drive.steering * side > 0.0 for drive in (along, off, back))


def test_the_motors_rest_between_tries_and_longer_after_each_round() -> None:
    recovery = begun()
    starts = [at_s for at_s, _ in tries(recovery, math.pi / 2.0, 400.0)]
    gaps = [later - at_s for at_s, later in itertools.pairwise(starts)]
    assert min(gaps) > 5.0
    assert [round(gap) for gap in gaps[3:12:4]] == [19, 34, 64]  # a try of four seconds each
    assert recovery.is_ungrounding


def test_a_try_that_makes_way_goes_on_but_not_for_ever() -> None:
    starts = [at_s for at_s, _ in tries(begun(), math.pi / 2.0, 60.0, slide_m_s=0.3)]
    assert 20.0 < starts[1] - starts[0] < 27.0


def test_once_off_it_stands_off_and_then_ends() -> None:
    recovery, water = begun(), fence()
    intent = get_off(recovery, nav_at(-1.5, 0.0, 0.0), water, 1.0)
    assert isinstance(intent, HoldCourse)
    assert abs(intent.course_rad) == pytest.approx(math.pi, abs=1e-3)  # south
    assert recovery.is_ungrounding
    assert get_off(recovery, nav_at(-4.0, 0.0, 0.0), water, 3.0) == Stop()
    assert not recovery.is_ungrounding


def test_one_that_is_carried_back_rests_and_tries_again() -> None:
    recovery, water, back = begun(), fence(), nav_at(-0.5, 0.0, 0.0)
    get_off(recovery, nav_at(-1.5, 0.0, 0.0), water, 5.0)
    for tick in range(15):
        assert get_off(recovery, back, water, 6.0 + tick * DT) == Stop()
    assert isinstance(get_off(recovery, back, water, 7.6), Drive)


ASHORE = nav_at(-0.3, 0.0, 0.0)


def test_the_operator_is_told_when_a_round_of_tries_did_not_help() -> None:
    recovery, water, told = begun(), fence(), []
    for tick in range(400):
        step = recovery.update(ASHORE, water, CONFIG, 0.0, 0.0, tick * DT)
        if step.text:
            told.append((round(tick * DT), step.text))
    assert told == [(22, "Aground: motors rest before the next try")]


@pytest.mark.parametrize("water", [Fence(), fence()], ids=["no fence", "fence"])
def test_off_a_shore_that_only_the_rangers_saw_it_goes_straight_away_from_it(water: Fence) -> None:
    recovery, seen = begun(), Point(-99.5, 0.0)
    for tick in range(300):
        at = nav_at(-100.0, 0.0, math.pi)
        intent = recovery.update(at, water, CONFIG, 0.0, 0.0, tick * DT, seen).intent
        if isinstance(intent, Drive) and tick * DT > 8.0:
            break
    assert isinstance(intent, Drive)
    assert intent.throttle > 0.0, "the bow points south, off the shore"
    off = recovery.update(nav_at(-101.0, 0.0, math.pi), water, CONFIG, 0.0, 0.0, 30.0, seen).intent
    assert isinstance(off, HoldCourse)
    assert abs(off.course_rad) == pytest.approx(math.pi)
    clear = recovery.update(nav_at(-104.0, 0.0, math.pi), water, CONFIG, 0.0, 0.0, 31.0, None)
    assert not recovery.is_ungrounding
    assert clear.intent == Stop()
