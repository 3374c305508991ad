"""What the motor watch learns of a healthy boat, and what it compares to it."""

import math
from random import Random

import pytest

from companion.config.boat_config import BoatConfig
from companion.core.geo import LatLon
from companion.core.readings import BatteryReading, GnssFix
from companion.core.state import NavState
from companion.failsafe.motors.current import MotorCurrent
from companion.failsafe.motors.evidence import MotorEvidence
from companion.failsafe.motors.hypotheses import WEIGHT, EffectSize
from companion.failsafe.motors.motion_filter import MotionFilter

DT_S = 0.1
EVEN = (0.5, 0.5)


def driven(current: MotorCurrent, seconds: float, sigma_a: float, random: Random) -> None:
    """Both motors at half of their command, two amperes with an error."""
    for _ in range(round(seconds / DT_S)):
        current.compare(EVEN, [0.5, 0.5], 0.0, 2.0 + random.gauss(0.0, sigma_a))
        current.learn(DT_S, is_driven=True)


@pytest.mark.parametrize(("sigma_a", "expected_a"), [(0.1, 0.19), (0.6, 0.6)])
def test_readings_that_scatter_widely_are_believed_less(sigma_a: float, expected_a: float) -> None:
    """The scatter of this boat's readings is learned where it is larger than expected, never less.

    Expected: 0.16 A, and 5 % of some two amperes.
    """
    current, random = MotorCurrent(), Random(1)
    driven(current, 300.0, sigma_a, random)
    assert math.sqrt(current.variance) == pytest.approx(expected_a, rel=0.15)


@pytest.mark.parametrize("silent_a", [None, math.nan, math.inf])
def test_a_monitor_that_falls_silent_tells_nothing_until_it_reads_again(silent_a: float | None) -> None:
    evidence, tells = MotorEvidence(BoatConfig()), []
    nav = NavState(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.1, 0.1)
    for now_s, current_a in ((0.9, 0.5), (1.0, silent_a), (1.1, 0.6)):
        evidence.update(0.0, 0.0, nav, None, BatteryReading(now_s, 12.0, current_a), 1.0, DT_S)
        tells.append(evidence.has_current)
    evidence.update(0.0, 0.0, nav, None, None, 1.0, DT_S)
    assert [*tells, evidence.has_current] == [True, False, True, False]


@pytest.mark.parametrize("to_deg", [0.0, 90.0, 180.0, -60.0])
def test_the_speed_of_the_hull_is_that_through_the_water(to_deg: float) -> None:
    """A boat at rest in a current drifts with it: no motor has pushed it."""
    evidence = MotorEvidence(BoatConfig())
    north_m_s, east_m_s = math.cos(math.radians(to_deg)), math.sin(math.radians(to_deg))
    for tick in range(3000):  # the known current is averaged
        now_s = tick * DT_S
        nav = NavState(
            now_s, 0.0, 0.0, math.radians(to_deg), 0.0, north_m_s, east_m_s, 1.0, 0.0, 0.1, 0.1,
            current_north_m_s=north_m_s, current_east_m_s=east_m_s,
        )  # fmt: skip
        fix = GnssFix(now_s, LatLon(50.0, -1.2), 3, 12, 0.9, north_m_s, east_m_s)
        evidence.update(0.0, 0.0, nav, fix, None, 1.0, DT_S)
    assert evidence._speed._value == pytest.approx(0.0, abs=0.05)


def test_the_yaw_of_waves_accuses_no_motor() -> None:
    """0.5 rad/s at 3.5 rad/s, as waves of 0.3 m turn the lake boat at most, while it steers a little."""
    most = []
    for known in (0.0, 1.0):
        evidence = MotorEvidence(BoatConfig())
        nats = 0.0
        for tick in range(300):
            now_s = DT_S * tick
            wave_rad_s = 0.5 * math.sin(3.5 * now_s)
            nav = NavState(
                now_s, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.1, 0.1,
                gyro_rad_s=wave_rad_s, wave_rad_s=known * wave_rad_s,
            )  # fmt: skip
            steered = 0.1 if tick % 50 < 25 else -0.1
            evidence.update(0.6 + steered, 0.6 - steered, nav, None, None, 1.0, DT_S)
            nats = max(nats, *evidence.against)
        most.append(nats)
    assert most[0] > 8.0
    assert most[1] < 2.0


def test_a_push_and_each_change_of_it_leave_the_motion_in_doubt() -> None:
    """A fifth of its effect over a quarter of a second, and 0.07 s of delay."""
    doubts = []
    for pushes in ([0.0] * 5, [0.0, 1.0, 1.0, 1.0, 1.0], [1.0, 1.0, 1.0, 1.0, 1.0]):
        motion = MotionFilter(0, 2.0, 100.0, 0.0, 0.01, math.inf, 0.0)
        motion.correct(0.0, DT_S, is_learning=False)
        variances = []
        for push in pushes:
            before = motion._p00
            motion._p01 = motion._p11 = 0.0
            motion.predict(push, [], DT_S)
            variances.append(motion._p00 - before)
        doubts.append(variances)
    none, changed = doubts[0][4], doubts[1]
    assert none == 0.0
    assert changed[4] - none == pytest.approx(0.2**2 * 0.25 * DT_S * 2.0**2)
    assert changed[1] - changed[4] == pytest.approx((0.0707 * 2.0) ** 2, rel=0.01)
    assert changed[0] == 0.0
    assert doubts[2][1] == pytest.approx(changed[4])


def test_the_size_is_learned_from_what_is_measured() -> None:
    """Residuals half as large again as expected cost no more than the noise, once that is known."""
    size, random = EffectSize(1), Random(1)
    costs = [size.cost(0, 1.5 + random.gauss(0.0, 0.2), 1.0, 0.4, 0.04) for _ in range(2000)]
    assert sum(costs[100:]) / 1900 == pytest.approx(0.5, rel=0.1)
    assert size._theta[0] == pytest.approx(1.25, rel=0.03)
    assert size._variance[0] == pytest.approx(0.04 / WEIGHT / (2000 * 0.4**2), rel=0.1)


def test_each_hypothesis_learns_for_itself_until_it_forgets() -> None:
    size = EffectSize(2)
    first = [size.cost(at, 1.3, 1.0, 0.4, 0.04) for at in (0, 1)]
    size.cost(0, 1.3, 1.0, 0.4, 0.04)
    size.forget(0)
    assert first[0] == first[1] == size.cost(0, 1.3, 1.0, 0.4, 0.04)
    assert size.cost(1, 1.3, 1.0, 0.4, 0.04) < first[1]


def test_two_neighbouring_samples_count_for_one() -> None:
    """Their errors are alike: together they teach what one of an error of its own would."""
    size, spread, variance = EffectSize(1), 0.4, 0.04
    for _ in range(2):
        size.cost(0, 1.0, 1.0, spread, variance)
    assert 1.0 / size._variance[0] == pytest.approx(1.0 + spread**2 / variance)
