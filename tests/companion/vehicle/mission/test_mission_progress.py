import math

import pytest
from boat_rig import FRAME, nav_at, place
from hypothesis import given
from hypothesis import strategies as st

from companion.config.boat_config import BoatConfig
from companion.core.geo import Point
from companion.core.intent import FollowCircle, FollowLeg, Intent, KeepStation
from companion.vehicle.mission.left_leg import LeftLeg
from companion.vehicle.mission.progress import MissionProgress
from companion.vehicle.mission.steps import (
    AfterDelay,
    GoRound,
    HandOver,
    Home,
    Jump,
    LimitHandOver,
    MoveHome,
    Offset,
    ReturnHome,
    Sailed,
    SetSpeed,
    Skip,
    Step,
    Turn,
    Wait,
    Waypoint,
    WithinDistance,
)

A, B, C = Waypoint(place(50.0, 0.0)), Waypoint(place(50.0, 50.0)), Waypoint(place(0.0, 50.0))
PLACES = {"A": (50.0, 0.0), "B": (50.0, 50.0), "C": (0.0, 50.0)}
CONFIG = BoatConfig()
CRUISE_M_S = CONFIG.speed.cruise_m_s


def begun(*steps: Step) -> MissionProgress:
    progress = MissionProgress()
    progress.replace((Home(), *steps))
    return progress


def at(progress: MissionProgress, north_m: float, east_m: float, now_s: float = 0.0) -> Intent:
    return progress.update(nav_at(north_m, east_m), FRAME, CONFIG, now_s)


def leg_at(progress: MissionProgress, north_m: float, east_m: float, now_s: float = 0.0) -> FollowLeg:
    intent = at(progress, north_m, east_m, now_s)
    assert isinstance(intent, FollowLeg)
    return intent


def test_a_mission_of_one_waypoint_is_sailed_at_once() -> None:
    progress = MissionProgress()
    progress.replace((A,))
    assert leg_at(progress, 0.0, 0.0).end == pytest.approx(PLACES["A"], abs=1e-3)


def test_the_next_leg_begins_at_the_waypoint_not_at_the_boat() -> None:
    progress = begun(A, B)
    leg_at(progress, 0.0, 0.0)
    assert leg_at(progress, 48.5, 0.5).end == pytest.approx(PLACES["A"], abs=1e-3)  # nearer to the old leg
    leg = leg_at(progress, 49.5, 0.6)
    assert leg.start == pytest.approx(PLACES["A"], abs=1e-3)
    assert leg.end == pytest.approx(PLACES["B"], abs=1e-3)
    assert leg.next_end is None
    assert progress.take_reached() == [1]
    assert progress.take_reached() == []


def visit(progress: MissionProgress, limit: int = 100) -> list[int]:
    """Put the boat on the end of each leg until the mission is over; the sequences that it reports."""
    here = (0.0, 0.0)
    for now_s in range(limit):
        intent = at(progress, *here, float(now_s))
        if progress.finished:
            break
        if isinstance(intent, FollowLeg):
            here = (intent.end.north_m, intent.end.east_m)
    return progress.take_reached()


@pytest.mark.parametrize(("times", "reached"), [(0, [1, 2]), (1, [1, 2, 1, 2]), (2, [1, 2, 1, 2, 1, 2])])
def test_a_jump_is_taken_as_often_as_it_says(times: int, reached: list[int]) -> None:
    assert visit(begun(A, B, Jump(1, times))) == reached


def test_a_jump_for_ever_goes_on_for_ever() -> None:
    progress = begun(A, B, Jump(1, -1))
    assert len(visit(progress, 500)) > 400
    assert not progress.finished


@pytest.mark.parametrize("steps", [(Jump(1, -1),), (SetSpeed(1.0), Jump(1, -1)), (A, Jump(1, -1))])
def test_a_loop_with_nothing_to_sail_neither_hangs_the_boat_nor_floods_the_stations(
    steps: tuple[Step, ...],
) -> None:
    progress = begun(*steps)
    for tick in range(50):
        assert isinstance(at(progress, 50.0, 0.0, tick * 0.02), KeepStation)
    assert len(progress.take_reached()) <= 100


def test_an_interrupted_leg_goes_on_from_where_the_boat_is() -> None:
    progress = begun(A, B)
    leg_at(progress, 0.0, 0.0)
    progress.resume()
    leg = leg_at(progress, 20.0, 7.0)
    assert leg.start == (20.0, 7.0)
    assert progress.current_seq == 1


steps = st.one_of(
    st.sampled_from([A, B, C, ReturnHome(), Home(), Skip(), MoveHome(None), HandOver(False)]),
    st.builds(GoRound, st.just(A.position), st.floats(0.1, 3.0), st.floats(0.0, 30.0), st.booleans()),
    st.builds(Waypoint, st.builds(Offset, st.floats(-9.0, 9.0), st.floats(-9.0, 9.0))),
    st.builds(Turn, st.floats(-7.0, 7.0), st.booleans()),
    st.builds(AfterDelay, st.floats(0.0, 3.0)),
    st.builds(WithinDistance, st.floats(0.0, 30.0)),
    st.builds(Wait, st.floats(0.0, 3.0)),
    st.builds(SetSpeed, st.floats(0.0, 3.0)),
    st.builds(Jump, st.integers(1, 8), st.integers(-1, 3)),
)


@given(st.lists(steps, min_size=8, max_size=8))
def test_any_mission_stays_within_itself_and_reports_only_its_own_items(mission: list[Step]) -> None:
    progress = begun(*mission)
    reached = visit(progress, 60)
    assert 0 <= progress.current_seq <= progress.last_seq == 8
    assert all(isinstance(progress.mission[seq], Sailed) for seq in reached)
    if not any(isinstance(step, Jump) for step in mission):
        assert reached == sorted(set(reached))


def test_what_waits_for_a_condition_is_done_in_the_course_of_the_leg_and_dropped_at_its_end() -> None:
    progress = begun(A, WithinDistance(20.0), SetSpeed(1.0), AfterDelay(9.0), SetSpeed(0.5), B)
    leg_at(progress, 50.0, 0.0)
    assert progress.current_seq == 6
    assert leg_at(progress, 50.0, 20.0, 5.0).speed_m_s == CRUISE_M_S
    leg_at(progress, 50.0, 31.0, 10.0)
    assert leg_at(progress, 50.0, 32.0, 11.0).speed_m_s == 1.0
    at(progress, 50.0, 50.0, 12.0)
    assert progress.finished
    assert progress.speed_m_s == 1.0


def test_a_new_mission_goes_on_only_where_the_way_to_here_is_the_same() -> None:
    progress = begun(A, B, C)
    leg_at(progress, 0.0, 0.0)
    leg = leg_at(progress, 50.0, 0.0)
    assert leg.next_end == pytest.approx(PLACES["C"], abs=1e-3)
    assert progress.replace((Home(), A, B))
    leg = leg_at(progress, 50.0, 5.0)
    assert leg.start == pytest.approx(PLACES["A"], abs=1e-3)
    assert leg.next_end is None
    assert not progress.replace((Home(), B, A))
    assert progress.current_seq == 1
    assert leg_at(progress, 50.0, 5.0).start == (50.0, 5.0)
    assert not progress.replace(())
    assert progress.finished is False
    assert progress.current_seq == 0


# Taking a voyage up again, and what is kept between items


def test_a_voyage_is_taken_up_at_its_item_on_its_leg() -> None:
    progress = begun(A, B, C)
    assert progress.restore(2, LeftLeg(place(50.0, 10.0), None), 0.7, {3: 1})
    assert (progress.current_seq, progress.has_started, progress.speed_m_s) == (2, True, 0.7)
    assert progress.jumps == {3: 1}
    leg = leg_at(progress, 48.0, 30.0)
    assert leg.start == pytest.approx((50.0, 10.0), abs=1e-3)
    assert leg.speed_m_s == 0.7
    assert progress.loose_leg is None, "it begins where the plan says"
    assert progress.restore(2, None, None, {})
    assert leg_at(progress, 48.0, 30.0).start == (48.0, 30.0)
    assert progress.loose_leg is not None


def test_a_leg_that_the_charge_ended_is_gone_on_with_where_the_boat_left_it() -> None:
    progress = begun(A, B, C)
    at(progress, 0.0, 0.0)
    progress.leave_leg(Point(20.0, 3.0), FRAME)
    assert progress.left is None, "the first leg began wherever the boat was: it begins anew"
    at(progress, 50.0, 0.0)
    progress.leave_leg(Point(52.0, 30.0), FRAME)
    progress.resume()
    back = leg_at(progress, 0.0, 0.0)
    assert back.start == (0.0, 0.0)
    assert back.end == pytest.approx((50.0, 30.0), abs=1e-3)
    assert progress.loose_leg is not None, "its line may lead over land"
    progress.leave_leg(Point(10.0, 10.0), FRAME)
    progress.resume()
    assert leg_at(progress, 20.0, 0.0).end == pytest.approx((50.0, 30.0), abs=1e-3), "called home once more"
    rest = leg_at(progress, 49.5, 30.0)
    assert rest.start == pytest.approx(PLACES["A"], abs=1e-3)
    assert rest.end == pytest.approx(PLACES["B"], abs=1e-3)
    progress.leave_leg(Point(50.0, -9.0), FRAME)
    progress.resume()
    assert leg_at(progress, 0.0, 0.0).end == pytest.approx(PLACES["A"], abs=1e-3), "not before its beginning"
    progress.set_current(3)
    assert leg_at(progress, 0.0, 0.0).end == pytest.approx(PLACES["C"], abs=1e-3)


@pytest.mark.parametrize(("seq", "is_there"), [(-1, False), (0, True), (2, True), (3, False)])
def test_only_an_item_of_the_mission_can_be_made_current(seq: int, is_there: bool) -> None:
    progress = begun(A, B)
    assert progress.set_current(seq) is is_there
    assert progress.current_seq == (seq if is_there else 1)
    assert MissionProgress().set_current(0)
    assert not MissionProgress().set_current(1)


def test_the_line_of_the_leg_is_from_where_it_begins_to_its_waypoint() -> None:
    progress = begun(A, B)
    leg_at(progress, 3.0, 4.0)
    line = progress.leg_line()
    assert line is not None
    assert line.start == (3.0, 4.0)
    assert line.end == pytest.approx(PLACES["A"], abs=1e-3)
    assert progress.loose_leg is not None, "it begins wherever the boat was"
    leg_at(progress, 49.9, 0.6)
    line = progress.leg_line()
    assert line is not None
    assert line.end == pytest.approx(PLACES["B"], abs=1e-3)


@pytest.mark.parametrize("command", [SetSpeed(1.0), AfterDelay(5.0), Wait(0.0), Jump(2, 1)])
def test_a_command_before_the_first_waypoint_leaves_its_leg_loose(command: Step) -> None:
    progress = begun(command, A, B)
    leg_at(progress, 3.0, 4.0)
    assert progress.loose_leg is not None
    leg_at(progress, 49.9, 0.6)
    assert progress.loose_leg is None


def test_a_leg_after_a_turn_on_the_spot_is_loose() -> None:
    progress = begun(A, Turn(0.0), B)
    leg_at(progress, 3.0, 4.0)
    assert leg_at(progress, 49.9, 0.6).start == (49.9, 0.6)
    assert progress.loose_leg is not None


def test_after_the_last_item_the_boat_stays_where_that_was() -> None:
    progress = begun(A)
    leg_at(progress, 0.0, 0.0)
    for north_m in (49.0, 60.0):
        intent = at(progress, north_m, 0.0)
        assert isinstance(intent, KeepStation)
        assert intent.point == pytest.approx(PLACES["A"], abs=1e-3)
    empty = MissionProgress()
    assert at(empty, 5.0, 6.0) == KeepStation(Point(5.0, 6.0))
    assert at(empty, 9.0, 9.0) == KeepStation(Point(5.0, 6.0))


def test_a_hand_over_is_told_while_it_lasts_and_the_next_leg_begins_at_the_boat() -> None:
    progress = begun(LimitHandOver(10.0, 0.0), HandOver(True), A)
    at(progress, 0.0, 0.0, 100.0)
    assert progress.is_handed_over
    assert leg_at(progress, 7.0, 3.0, 110.0).start == (7.0, 3.0)
    assert not progress.is_handed_over


def test_a_restart_forgets_speed_limits_and_jumps() -> None:
    progress = begun(SetSpeed(0.5), LimitHandOver(10.0, 0.0), A, Jump(3, 1), HandOver(True), B)
    leg_at(progress, 0.0, 0.0)
    progress.jumps[4] = 1
    progress.finished = progress.go_home = True
    progress.restart()
    assert (progress.speed_m_s, progress.jumps, progress.current_seq) == (None, {}, 1)
    assert (progress.finished, progress.go_home, progress.has_started) == (False, False, False)
    progress.set_current(5)
    at(progress, 0.0, 0.0, 0.0)
    at(progress, 0.0, 0.0, 1000.0)
    assert progress.is_handed_over, "the limit is forgotten"


# Commands and stops, as literal sequences


def test_what_waits_for_a_time_is_done_while_the_boat_stays_at_a_waypoint() -> None:
    progress = begun(AfterDelay(5.0), SetSpeed(1.0), Waypoint(place(50.0, 0.0), hold_s=20.0), B)
    at(progress, 0.0, 0.0, 0.0)
    for now_s, speed_m_s in ((1.0, None), (4.9, None), (5.1, 1.0), (20.9, 1.0)):
        station = at(progress, 49.0, 0.0, now_s)
        assert isinstance(station, KeepStation)
        assert station.point == pytest.approx((50.0, 0.0), abs=1e-3)
        assert progress.speed_m_s == speed_m_s
        assert progress.current_seq == 3
    leg = at(progress, 49.0, 0.0, 21.1)
    assert isinstance(leg, FollowLeg)
    assert (progress.current_seq, leg.speed_m_s) == (4, 1.0)
    assert leg.end == pytest.approx((50.0, 50.0), abs=1e-3)


def test_a_wait_keeps_its_station_and_the_next_leg_begins_where_the_last_one_ended() -> None:
    progress = begun(A, Wait(10.0), B)
    at(progress, 0.0, 0.0, 0.0)
    for now_s in (30.0, 39.9):
        station = at(progress, 49.0, 0.5, now_s)
        assert isinstance(station, KeepStation)
        assert station.point == pytest.approx((50.0, 0.0), abs=1e-3)
    assert progress.take_reached() == [1]
    leg = at(progress, 49.0, 0.5, 40.1)
    assert isinstance(leg, FollowLeg)
    assert leg.start == pytest.approx((50.0, 0.0), abs=1e-3)
    assert progress.take_reached() == [2]


@pytest.mark.parametrize("clockwise", [True, False])
@pytest.mark.parametrize(("radius_m", "expected_m"), [(6.0, 6.0), (0.0, 10.0)])
def test_a_circle_is_left_after_its_turns_and_the_next_leg_begins_at_the_boat(
    clockwise: bool, radius_m: float, expected_m: float
) -> None:
    progress = begun(GoRound(Point(20.0, 0.0), 1.5, radius_m, clockwise), A)
    side = 1.0 if clockwise else -1.0
    for degrees in range(0, 540, 15):
        bearing = side * math.radians(degrees)
        north, east = 20.0 + expected_m * math.cos(bearing), expected_m * math.sin(bearing)
        assert at(progress, north, east, 0.0) == FollowCircle(Point(20.0, 0.0), expected_m, clockwise, 2.0)
    assert progress.take_reached() == []
    bearing = side * math.radians(545.0)
    leg = at(progress, 20.0 + expected_m * math.cos(bearing), expected_m * math.sin(bearing), 0.0)
    assert isinstance(leg, FollowLeg)
    assert leg.start == pytest.approx((20.0 + expected_m * math.cos(bearing), expected_m * math.sin(bearing)))
    assert progress.take_reached() == [1]


def test_commands_are_done_in_their_order_as_the_next_leg_begins() -> None:
    home = place(7.0, 8.0)
    progress = begun(MoveHome(home), SetSpeed(0.7), A, MoveHome(None), SetSpeed(0.0), B, ReturnHome())
    leg = at(progress, 0.0, 0.0, 0.0)
    assert isinstance(leg, FollowLeg)
    assert (progress.current_seq, leg.speed_m_s, progress.take_homes()) == (3, 0.7, [home])
    leg = at(progress, 50.0, 0.0, 1.0)
    assert isinstance(leg, FollowLeg)
    assert (progress.current_seq, leg.speed_m_s, progress.take_homes()) == (6, 2.0, [None])
    assert not progress.go_home
    station = at(progress, 50.0, 50.0, 2.0)
    assert isinstance(station, KeepStation)
    assert (progress.go_home, progress.finished, progress.take_reached()) == (True, True, [3, 6])
    assert progress.set_current(1)
    assert (progress.go_home, progress.finished) == (False, False)


def test_what_waits_for_a_condition_is_dropped_with_a_jump_to_another_item() -> None:
    progress = begun(AfterDelay(5.0), SetSpeed(1.0), A, B)
    leg_at(progress, 0.0, 0.0, 0.0)
    progress.set_current(4)
    for now_s in (10.0, 11.0):
        assert leg_at(progress, 0.0, 0.0, now_s).speed_m_s == CRUISE_M_S
