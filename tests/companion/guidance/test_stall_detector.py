"""Headway: a boat that gets nowhere, and whether the water is why."""

import pytest
from msgspec.structs import replace

from companion.config.boat_config import BoatConfig
from companion.core.state import STOPPED, Demand, MotorCommand, NavState
from companion.guidance.stall_detector import HELD_S, NOTICE_S, Headway, Verdict

CONFIG = BoatConfig()
DT = 0.02
FULL = MotorCommand(1.0, 1.0)
NORTH = Demand(0.0, 2.0)
STILL = NavState(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.1, 0.02)
UNDER_WAY = replace(STILL, north_m_s=2.0, surge_m_s=2.0)


def judged(
    headway: Headway, nav: NavState, seconds: float, command: MotorCommand = FULL, demand: Demand = NORTH
) -> Verdict:
    for _ in range(round(seconds / DT)):
        headway.update(demand, command, nav, CONFIG, DT)
    return headway.verdict


def test_a_boat_under_way_makes_way() -> None:
    assert judged(Headway(), UNDER_WAY, 60.0) is Verdict.MAKING_WAY


def test_full_throttle_without_way_in_still_water_is_stuck() -> None:
    headway = Headway()
    judged(headway, UNDER_WAY, 60.0)
    assert judged(headway, STILL, 0.9 * NOTICE_S) is Verdict.MAKING_WAY
    assert judged(headway, STILL, 0.2 * NOTICE_S) is Verdict.STUCK


def test_a_current_as_fast_as_the_boat_leaves_no_headway() -> None:
    headway = Headway()
    judged(headway, replace(UNDER_WAY, north_m_s=0.2, set_north_m_s=-2.9), 120.0)
    assert judged(headway, replace(STILL, set_north_m_s=-3.0), 1.1 * NOTICE_S) is Verdict.NO_HEADWAY


def test_a_set_learned_while_stuck_does_not_blame_the_water() -> None:
    headway = Headway()
    judged(headway, UNDER_WAY, 60.0)
    assert judged(headway, replace(STILL, set_north_m_s=-3.0), 60.0) is Verdict.STUCK


def test_way_made_good_clears_the_verdict() -> None:
    headway = Headway()
    assert judged(headway, STILL, 2.0 * NOTICE_S) is Verdict.STUCK
    assert judged(headway, UNDER_WAY, DT) is Verdict.MAKING_WAY


@pytest.mark.parametrize(
    ("command", "demand", "heading_rad"),
    [
        (MotorCommand(0.3, 0.3), NORTH, 0.0),
        (STOPPED, NORTH, 0.0),
        (FULL, Demand(0.0, 0.0), 0.0),
        (FULL, NORTH, 2.0),
    ],
    ids=["little thrust", "none", "nothing asked", "still turning"],
)
def test_who_does_not_try_is_not_judged(command: MotorCommand, demand: Demand, heading_rad: float) -> None:
    nav = replace(STILL, heading_rad=heading_rad)
    assert judged(Headway(), nav, 60.0, command, demand) is Verdict.MAKING_WAY


def test_opening_the_loops_begins_anew() -> None:
    headway = Headway()
    judged(headway, STILL, 0.9 * NOTICE_S)
    headway.update(None, STOPPED, STILL, CONFIG, DT)
    assert headway.stalled_s == 0.0


TURNING = MotorCommand(-1.0, 1.0)
NO_WAY = Demand(1.0, 0.0)


def held(
    headway: Headway, command: MotorCommand, seconds: float, turn_rad_s: float = 0.0, drift_m_s: float = 0.0
) -> Verdict:
    for tick in range(round(seconds / DT)):
        now_s = tick * DT
        nav = replace(STILL, heading_rad=turn_rad_s * now_s, east_m=drift_m_s * now_s)
        headway.update(NO_WAY, command, nav, CONFIG, DT, is_at_line=True)
    return headway.verdict


def test_steering_that_turns_nothing_at_the_shore_is_a_boat_aground() -> None:
    headway = Headway()
    assert held(headway, TURNING, 0.9 * HELD_S) is Verdict.MAKING_WAY
    assert headway.held_s > 5.0
    assert held(headway, TURNING, 0.2 * HELD_S) is Verdict.AGROUND


def test_thrust_that_moves_nothing_at_the_shore_is_a_boat_aground() -> None:
    assert held(Headway(), FULL, 1.1 * HELD_S) is Verdict.AGROUND


@pytest.mark.parametrize(("turn", "drift"), [(0.1, 0.0), (0.0, 0.3)])
def test_a_boat_that_turns_or_drifts_is_afloat(turn: float, drift: float) -> None:
    assert held(Headway(), TURNING, 60.0, turn, drift) is Verdict.MAKING_WAY


def test_a_boat_that_holds_its_place_with_little_thrust_is_afloat() -> None:
    assert held(Headway(), MotorCommand(0.1, 0.1), 60.0) is Verdict.MAKING_WAY


def test_away_from_every_line_nothing_is_said_of_the_shore() -> None:
    assert judged(Headway(), STILL, 60.0, TURNING, NO_WAY) is Verdict.MAKING_WAY
