"""Headway: a boat that gets nowhere, and whether the water is why."""

import math

import pytest
from msgspec.structs import replace

from companion.config.boat_config import BoatConfig, decode_config
from companion.core.state import STOPPED, Demand, MotorCommand, NavState
from companion.guidance.stall_detector import HELD_S, STALL_S, StallDetector, StallVerdict

CONFIG = BoatConfig()
DT = 0.02
FULL = MotorCommand(1.0, 1.0)
NORTH = Demand(0.0, 2.0)
STILL = NavState(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.1, 0.02)


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
    assert headway.update(NO_WAY, TURNING, STILL, CONFIG, DT, is_at_line=True) is StallVerdict.AGROUND


@pytest.mark.parametrize("heading_deg", [0, 120])
@pytest.mark.parametrize(
    ("seconds", "verdict"), [(43.0, StallVerdict.STUCK), (48.0, StallVerdict.NO_HEADWAY)]
)
def test_the_current_is_averaged_over_twenty_seconds_in_every_direction(
    heading_deg: int, seconds: float, verdict: StallVerdict
) -> None:
    # 2.9 (1 - exp(-t / 20 s)) m/s are known after t; 2.6 m/s leave steerage way at 3 m/s: after 45.4 s
    c, s = math.cos(math.radians(heading_deg)), math.sin(math.radians(heading_deg))
    against = replace(
        STILL, heading_rad=math.radians(heading_deg), current_north_m_s=-2.9 * c, current_east_m_s=-2.9 * s
    )
    demand, headway = Demand(math.radians(heading_deg), 2.0), StallDetector()
    judged(headway, replace(against, north_m_s=0.1 * c, east_m_s=0.1 * s), seconds, demand=demand)
    assert judged(headway, against, 10.1, demand=demand) is verdict


@pytest.mark.parametrize(
    ("speed_m_s", "throttle", "way_m_s", "off_rad", "is_stuck"),
    [
        (0.21, 0.76, 0.0, 0.0, True),
        (0.19, 0.76, 0.0, 0.0, False),  # half of steerage way is asked for
        (0.21, 0.74, 0.0, 0.0, False),  # three quarters of the throttle
        (2.0, 1.0, 0.039, 0.0, True),
        (2.0, 1.0, 0.041, 0.0, False),  # a tenth of steerage way
        (2.0, 1.0, 0.0, 0.79, True),
        (2.0, 1.0, 0.0, -0.79, True),
        (2.0, 1.0, 0.0, 0.81, False),
        (2.0, 1.0, 0.0, -0.81, False),
        (2.0, 1.0, -0.5, 0.0, True),  # carried astern
    ],
)
def test_an_attempt_is_enough_speed_asked_for_enough_thrust_and_the_bow_on_it(
    speed_m_s: float, throttle: float, way_m_s: float, off_rad: float, is_stuck: bool
) -> None:
    nav = replace(STILL, north_m_s=way_m_s, heading_rad=off_rad)
    verdict = judged(StallDetector(), nav, 12.0, MotorCommand(throttle, throttle), Demand(0.0, speed_m_s))
    assert verdict is (StallVerdict.STUCK if is_stuck else StallVerdict.MAKING_WAY)


def test_ten_seconds_of_trying_are_needed_and_pauses_between_do_not_count() -> None:
    headway = StallDetector()
    judged(headway, STILL, 5.0)
    judged(headway, STILL, 30.0, MotorCommand(0.1, 0.1))
    assert headway.stalled_s == pytest.approx(5.0)
    assert judged(headway, STILL, 4.9) is StallVerdict.MAKING_WAY
    assert judged(headway, STILL, 0.2) is StallVerdict.STUCK


@pytest.mark.parametrize(
    ("command", "is_driven"),
    [
        (MotorCommand(-0.51, 0.51), True),
        (MotorCommand(0.49, -0.49), False),
        (MotorCommand(0.51, -0.51), True),
        (MotorCommand(0.21, 0.21), True),  # 0.63 m/s ahead of 3 m/s
        (MotorCommand(0.19, 0.19), False),
        (MotorCommand(-0.21, -0.21), True),
        (MotorCommand(-0.19, -0.19), False),
    ],
)
def test_a_boat_is_driven_by_steering_of_one_or_six_tenths_of_a_metre_a_second(
    command: MotorCommand, is_driven: bool
) -> None:
    assert (held(StallDetector(), command, 6.1) is StallVerdict.AGROUND) is is_driven


@pytest.mark.parametrize("heading_deg", [0, -135])
@pytest.mark.parametrize(("along_m_s", "is_driven"), [(-0.4, False), (0.4, True), (-1.6, True)])
def test_the_known_current_counts_with_the_thrust(
    heading_deg: int, along_m_s: float, is_driven: bool
) -> None:
    heading = math.radians(heading_deg)
    c, s = math.cos(heading), math.sin(heading)
    headway, demand = StallDetector(), Demand(heading, 0.0)
    nav = replace(STILL, heading_rad=heading, current_north_m_s=along_m_s * c, current_east_m_s=along_m_s * s)
    judged(headway, replace(nav, north_m_s=c, east_m_s=s), 150.0, demand=demand)
    command = MotorCommand(0.3, 0.3)  # 0.9 m/s through the water
    for _ in range(305):
        headway.update(demand, command, nav, CONFIG, DT, is_at_line=True)
    assert (headway.verdict is StallVerdict.AGROUND) is is_driven


@pytest.mark.parametrize(("leap", "is_held"), [(0.9, True), (1.1, False)])
@pytest.mark.parametrize("axis", ["north_m", "east_m"])
def test_a_boat_within_a_metre_of_where_it_was_is_in_its_place(axis: str, leap: float, is_held: bool) -> None:
    headway, moved = StallDetector(), replace(STILL, **{axis: leap})
    for tick in range(305):
        headway.update(NO_WAY, TURNING, moved if tick % 2 else STILL, CONFIG, DT, is_at_line=True)
    assert (headway.verdict is StallVerdict.AGROUND) is is_held


@pytest.mark.parametrize(("leap", "is_held"), [(0.24, True), (-0.24, True), (0.26, False), (-0.26, False)])
def test_a_boat_within_a_quarter_of_a_radian_has_not_turned(leap: float, is_held: bool) -> None:
    headway = StallDetector()
    for tick in range(305):
        nav = replace(STILL, heading_rad=math.remainder(math.pi + leap * (tick % 2), math.tau))
        headway.update(NO_WAY, TURNING, nav, CONFIG, DT, is_at_line=True)
    assert (headway.verdict is StallVerdict.AGROUND) is is_held


def test_time_without_drive_is_taken_off_and_leaving_the_line_begins_anew() -> None:
    headway = StallDetector()
    held(headway, TURNING, 5.0)
    held(headway, MotorCommand(0.0, 0.0), 2.0)
    assert headway.held_s == pytest.approx(3.0)
    held(headway, MotorCommand(0.0, 0.0), 9.0)
    assert headway.held_s == pytest.approx(0.0)
    held(headway, TURNING, 5.0)
    headway.update(NO_WAY, TURNING, STILL, CONFIG, DT)
    assert headway.held_s == 0.0
    held(headway, TURNING, 5.0)
    headway.update(None, TURNING, STILL, CONFIG, DT, is_at_line=True)
    assert headway.held_s == 0.0


def test_open_loops_are_judged_to_make_way() -> None:
    headway = StallDetector()
    assert judged(headway, STILL, 2.0 * STALL_S) is StallVerdict.STUCK
    assert headway.update(None, STOPPED, STILL, CONFIG, DT) is StallVerdict.MAKING_WAY
    assert headway.stalled_s == 0.0
    assert headway.update(NORTH, FULL, None, CONFIG, DT) is StallVerdict.MAKING_WAY


def test_one_motor_without_thrust_is_found_though_the_estimate_shows_some_way() -> None:
    """A dead motor's estimated speed: 0.1 to 0.3 m/s, from thrust that is not there."""
    one = decode_config({"drive": {"layout": "rudder"}}, "test")
    verdicts = {}
    for config in (CONFIG, one):
        headway = StallDetector()
        for tick in range(1500):
            nav = replace(STILL, north_m_s=0.2 + 0.1 * math.sin(0.1 * tick))
            headway.update(NORTH, FULL, nav, config, DT)
        verdicts[config.drive.layout] = headway.verdict
    assert verdicts == {"differential": StallVerdict.MAKING_WAY, "rudder": StallVerdict.STUCK}


def test_one_motor_that_makes_way_against_a_current_is_not_stalled() -> None:
    one, headway = decode_config({"drive": {"layout": "rudder"}}, "test"), StallDetector()
    for _ in range(3000):
        headway.update(NORTH, FULL, replace(STILL, north_m_s=0.3), one, DT)
    assert headway.verdict is StallVerdict.MAKING_WAY
