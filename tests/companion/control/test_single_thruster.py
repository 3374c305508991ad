"""One motor of two: it swings the bow to and fro about the heading."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.control.allocation import pair_thrust
from companion.control.single_thruster import SingleThrusterController
from companion.core.state import Demand, MotorState, MotorStates, NavState, Thrust

LEFT_WORKS = MotorStates(right=MotorState.FAILED)
RIGHT_WORKS = MotorStates(left=MotorState.FAILED)
DT_S = 0.02


def nav_at(heading: float = 0.0, current_m_s: tuple[float, float] = (0.0, 0.0)) -> NavState:
    return NavState(
        0.0, 0.0, 0.0, heading, 0.0, 0.0, 0.0, 0.0, 0.0, 0.1, 0.1,
        current_north_m_s=current_m_s[0], current_east_m_s=current_m_s[1],
    )  # fmt: skip


def thrust_of(
    controller: SingleThrusterController, demand: Demand, nav: NavState, motors: MotorStates, most: float
) -> Thrust:
    return pair_thrust(*controller.update(demand, nav, motors, most, DT_S), motors)


@given(st.floats(-math.pi, math.pi), st.floats(-math.pi, math.pi), st.floats(-2.0, 2.0), st.booleans())
def test_only_the_working_motor_runs_at_full_throttle_or_not_at_all(
    heading: float, wanted: float, speed: float, is_left: bool
) -> None:
    motors = LEFT_WORKS if is_left else RIGHT_WORKS
    thrust = thrust_of(SingleThrusterController(), Demand(wanted, speed), nav_at(heading), motors, 0.8)
    working, failed = (thrust.left, thrust.right) if is_left else (thrust.right, thrust.left)
    assert failed == 0.0
    assert abs(working) in (0.0, 0.8)


@given(st.floats(-math.pi, math.pi), st.floats(0.0, 1.0))
def test_the_effort_lies_in_what_the_working_motor_can_do(heading: float, most: float) -> None:
    surge, yaw = SingleThrusterController().update(Demand(0.0, 1.0), nav_at(heading), LEFT_WORKS, most, DT_S)
    assert surge == yaw  # thrust on the left side alone turns to starboard
    surge, yaw = SingleThrusterController().update(Demand(0.0, 1.0), nav_at(heading), RIGHT_WORKS, most, DT_S)
    assert surge == -yaw


@pytest.mark.parametrize(("motors", "side"), [(LEFT_WORKS, 1.0), (RIGHT_WORKS, -1.0)])
@pytest.mark.parametrize("wanted", [0.0, 3.0])
def test_the_bow_swings_to_and_fro_about_the_heading(motors: MotorStates, side: float, wanted: float) -> None:
    controller, demand = SingleThrusterController(), Demand(wanted, 1.0)
    efforts = [
        controller.update(demand, nav_at(wanted + side * past), motors, 1.0, DT_S)[0]
        for past in (0.0, 0.7, 0.9, 0.0, -0.7, -0.9, 0.0)
    ]
    assert efforts == [0.5, 0.5, -0.5, -0.5, -0.5, 0.5, 0.5]


@pytest.mark.parametrize(("motors", "side"), [(LEFT_WORKS, 1.0), (RIGHT_WORKS, -1.0)])
def test_a_speed_astern_is_made_with_the_bow_the_other_way(motors: MotorStates, side: float) -> None:
    controller, demand = SingleThrusterController(), Demand(0.0, -1.0)
    efforts = [
        controller.update(demand, nav_at(math.pi + side * past), motors, 1.0, DT_S)[0]
        for past in (0.0, 0.9, -0.7, -0.9)
    ]
    assert efforts == [0.5, -0.5, -0.5, 0.5]


@pytest.mark.parametrize(
    ("speed_m_s", "runs"), [(0.3, False), (0.34, False), (0.26, False), (0.36, True), (0.24, True)]
)
def test_the_motor_rests_where_the_current_alone_gives_the_speed(speed_m_s: float, runs: bool) -> None:
    effort = SingleThrusterController().update(
        Demand(0.0, speed_m_s), nav_at(current_m_s=(0.3, 0.0)), LEFT_WORKS, 1.0, DT_S
    )
    assert (effort != (0.0, 0.0)) is runs


def test_the_bow_swings_about_the_mean_of_a_demand_that_swings_with_it() -> None:
    controller = SingleThrusterController()
    for step in range(1400):  # a swing takes 16 s, and ends one radian to port
        demand = Demand(math.sin(math.tau * step / 800.0), 1.0)
        controller.update(demand, nav_at(0.0), LEFT_WORKS, 1.0, DT_S)
    assert controller.update(demand, nav_at(0.4), LEFT_WORKS, 1.0, DT_S)[0] == 0.5
    assert controller.update(demand, nav_at(1.0), LEFT_WORKS, 1.0, DT_S)[0] == -0.5


def test_a_motor_that_has_rested_starts_with_the_new_heading() -> None:
    controller = SingleThrusterController()
    for demand in (Demand(0.0, 1.0), Demand(0.0, 0.0), Demand(2.0, 1.0)):
        surge, _ = controller.update(demand, nav_at(1.2), LEFT_WORKS, 1.0, DT_S)
    assert surge < 0.0  # it runs astern since the first: the bow has not swung back past the new heading
    surge, _ = controller.update(Demand(2.0, 1.0), nav_at(1.1), LEFT_WORKS, 1.0, DT_S)
    assert surge > 0.0
