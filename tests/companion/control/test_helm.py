"""The helm closes the loops it is asked to close, and forgets the others."""

import pytest
from msgspec.structs import replace

from companion.config.boat_config import BoatConfig, with_value
from companion.control.helm import Helm
from companion.core.intent import Drive, Stop
from companion.core.state import Demand, MotorState, MotorStates, NavState

CONFIG = BoatConfig()
STILL = NavState(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
CRUISING = replace(STILL, north_m_s=2.0, surge_m_s=2.0)


def test_the_operators_hand_goes_through_the_mixer() -> None:
    thrust = Helm().update(Drive(0.5, 0.2), None, CONFIG, 0.02)
    assert (thrust.left, thrust.right) == pytest.approx((0.7, 0.3))


@pytest.mark.parametrize("pause", [Stop(), Drive(0.2, 0.0)])
def test_open_loops_forget_what_they_learned(pause: Stop | Drive) -> None:
    helm = Helm()
    fresh = helm.update(Demand(0.05, 0.5), STILL, CONFIG, 0.02)
    for _ in range(200):
        learned = helm.update(Demand(0.05, 0.5), STILL, CONFIG, 0.02)
    assert learned != fresh
    helm.update(pause, STILL, CONFIG, 0.02)
    assert helm.heading_pid is None
    assert helm.speed_pid is None
    assert helm.update(Demand(0.05, 0.5), STILL, CONFIG, 0.02) == fresh


def test_the_loops_are_open_while_one_motor_steers() -> None:
    helm, failed = Helm(), MotorStates(left=MotorState.FAILED)
    fresh = helm.update(Demand(0.05, 0.5), STILL, CONFIG, 0.02)
    for _ in range(200):
        helm.update(Demand(0.05, 0.5), STILL, CONFIG, 0.02)
    helm.update(Demand(0.05, 0.5), STILL, CONFIG, 0.02, failed)
    assert helm.heading_pid is None, "telemetry must not repeat the last evaluation"
    assert helm.speed_pid is None
    assert helm.update(Demand(0.05, 0.5), STILL, CONFIG, 0.02) == fresh


def test_the_heading_gains_rise_toward_rest_and_are_level_beyond_cruise() -> None:
    config = with_value(CONFIG, "heading.slow_gain", 1.5)
    shares = []
    for speed in (0.0, 1.0, 2.0, 3.0):
        helm = Helm()
        helm.update(Demand(0.01, speed), replace(STILL, north_m_s=speed, surge_m_s=speed), config, 0.02)
        assert helm.heading_pid is not None
        shares.append(helm.heading_pid.p / (0.01 * config.heading.kp))
    assert shares == pytest.approx([1.5, 1.25, 1.0, 1.0])


def test_it_is_the_speed_through_the_water_that_counts() -> None:
    config = with_value(CONFIG, "heading.slow_gain", 1.5)
    helm = Helm()
    helm.update(Demand(0.01, 2.0), replace(CRUISING, current_north_m_s=2.0), config, 0.02)
    assert helm.heading_pid is not None
    assert helm.heading_pid.p == pytest.approx(1.5 * 0.01 * config.heading.kp)


def test_steering_comes_before_throttle() -> None:
    """What steering takes is not there for the throttle, so that neither side saturates."""
    helm = Helm()
    thrust = helm.update(Demand(0.2, 3.0), CRUISING, CONFIG, 0.02)
    assert helm.heading_pid is not None
    assert helm.speed_pid is not None
    steering = helm.heading_pid.total
    assert 0.1 < steering < 0.9
    assert helm.speed_pid.total == pytest.approx(1.0 - steering)
    assert (thrust.left, thrust.right) == pytest.approx((1.0, 1.0 - 2.0 * steering))


@pytest.mark.parametrize("heading_rad", [-0.05, 0.0, 0.05])
def test_without_braking_no_motor_turns_astern(heading_rad: float) -> None:
    demand = Demand(heading_rad, 0.4)
    braked = Helm().update(demand, CRUISING, CONFIG, 0.02)
    assert min(braked.left, braked.right) < -0.2
    eased = Helm().update(replace(demand, brakes=False), CRUISING, CONFIG, 0.02)
    assert min(eased.left, eased.right) == pytest.approx(0.0, abs=1e-9)
    assert eased.left - eased.right == pytest.approx(braked.left - braked.right)


def test_restraint_lowers_the_gains() -> None:
    parts = []
    for share in (0.0, 0.5, 1.0):
        helm = Helm()
        helm.update(Demand(0.01, 2.1), replace(CRUISING, restraint=share), CONFIG, 0.02)
        assert helm.heading_pid is not None
        assert helm.speed_pid is not None
        parts.append(
            (helm.heading_pid.p / (0.01 * CONFIG.heading.kp), helm.speed_pid.p / (0.1 * CONFIG.speed.kp))
        )
    assert parts == [pytest.approx(one) for one in ((1.0, 1.0), (0.7, 0.65), (0.4, 0.3))]
