"""Headway: a boat that gets nowhere, and whether the water is why."""

import pytest
from msgspec.structs import replace

from companion.config.boat_config import BoatConfig
from companion.core.state import STOPPED, Demand, MotorCommand, NavState
from companion.guidance.stall_detector import HELD_S, STALL_S, StallDetector, StallVerdict

CONFIG = BoatConfig()
DT = 0.02
FULL = MotorCommand(1.0, 1.0)
NORTH = Demand(0.0, 2.0)
STILL = NavState(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.1, 0.02)
UNDER_WAY = replace(STILL, north_m_s=2.0, surge_m_s=2.0)


def judged(
    headway: StallDetector,
    nav: NavState,
    seconds: float,
    command: MotorCommand = FULL,
    demand: Demand = NORTH,
) -> StallVerdict:
    for _ in range(round(seconds / DT)):
        headway.update(demand, command, nav, CONFIG, DT)
    return headway.verdict


def test_a_boat_under_way_makes_way() -> None:
    assert judged(StallDetector(), UNDER_WAY, 60.0) is StallVerdict.MAKING_WAY


def test_full_throttle_without_way_in_still_water_is_stuck() -> None:
    headway = StallDetector()
    judged(headway, UNDER_WAY, 60.0)
    assert judged(headway, STILL, 0.9 * STALL_S) is StallVerdict.MAKING_WAY
    assert judged(headway, STILL, 0.2 * STALL_S) is StallVerdict.STUCK


def test_a_current_as_fast_as_the_boat_leaves_no_headway() -> None:
    headway = StallDetector()
    judged(headway, replace(UNDER_WAY, north_m_s=0.2, current_north_m_s=-2.9), 120.0)
    assert judged(headway, replace(STILL, current_north_m_s=-3.0), 1.1 * STALL_S) is StallVerdict.NO_HEADWAY


def test_a_set_learned_while_stuck_does_not_blame_the_water() -> None:
    headway = StallDetector()
    judged(headway, UNDER_WAY, 60.0)
    assert judged(headway, replace(STILL, current_north_m_s=-3.0), 60.0) is StallVerdict.STUCK


def test_way_made_good_clears_the_verdict() -> None:
    headway = StallDetector()
    assert judged(headway, STILL, 2.0 * STALL_S) is StallVerdict.STUCK
    assert judged(headway, UNDER_WAY, DT) is StallVerdict.MAKING_WAY


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
    assert judged(StallDetector(), nav, 60.0, command, demand) is StallVerdict.MAKING_WAY


def test_opening_the_loops_begins_anew() -> None:
    headway = StallDetector()
    judged(headway, STILL, 0.9 * STALL_S)
    headway.update(None, STOPPED, STILL, CONFIG, DT)
    assert headway.stalled_s == 0.0


TURNING = MotorCommand(-1.0, 1.0)
NO_WAY = Demand(1.0, 0.0)


def held(
    headway: StallDetector,
    command: MotorCommand,
    seconds: float,
    turn_rad_s: float = 0.0,
    drift_m_s: float = 0.0,
) -> StallVerdict:
    for tick in range(round(seconds / DT)):
        now_s = tick * DT
        nav = replace(STILL, heading_rad=turn_rad_s * now_s, east_m=drift_m_s * now_s)
        headway.update(NO_WAY, command, nav, CONFIG, DT, is_at_line=True)
    return headway.verdict


def test_steering_that_turns_nothing_at_the_shore_is_a_boat_aground() -> None:
    headway = StallDetector()
    assert held(headway, TURNING, 0.9 * HELD_S) is StallVerdict.MAKING_WAY
    assert headway.held_s > 5.0
    assert held(headway, TURNING, 0.2 * HELD_S) is StallVerdict.AGROUND


def test_thrust_that_moves_nothing_at_the_shore_is_a_boat_aground() -> None:
    assert held(StallDetector(), FULL, 1.1 * HELD_S) is StallVerdict.AGROUND


@pytest.mark.parametrize(("turn", "drift"), [(0.1, 0.0), (0.0, 0.3)])
def test_a_boat_that_turns_or_drifts_is_afloat(turn: float, drift: float) -> None:
    assert held(StallDetector(), TURNING, 60.0, turn, drift) is StallVerdict.MAKING_WAY


def test_a_boat_that_holds_its_place_with_little_thrust_is_afloat() -> None:
    assert held(StallDetector(), MotorCommand(0.1, 0.1), 60.0) is StallVerdict.MAKING_WAY


def test_away_from_every_line_nothing_is_said_of_the_shore() -> None:
    assert judged(StallDetector(), STILL, 60.0, TURNING, NO_WAY) is StallVerdict.MAKING_WAY
