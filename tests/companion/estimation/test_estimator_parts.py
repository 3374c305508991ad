"""The estimator's parts, each against what is known exactly."""

import cmath
import math
import random
from unittest import mock

import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.config.boat_config import Speed
from companion.config.estimation import Estimation
from companion.core.state import EstimateFault
from companion.estimation.current import CurrentFilter
from companion.estimation.gnss_integrity import GnssIntegrityMonitor
from companion.estimation.gnss_update import GnssUpdate
from companion.estimation.model import Model
from companion.estimation.sensor_timeout import SensorTimeoutMonitor
from companion.estimation.state_history import LENGTH, StateHistory
from companion.estimation.stuck_value import StuckValueDetector
from companion.estimation.water_speed import WaterSpeed
from companion.sensors.readings import HeadingReading

DT = 0.2


def learned(
    headings_rad: list[float],
    current_m_s: complex,
    gain: complex,
    speed_m_s: float = 2.0,
    each_s: float = 30.0,
) -> CurrentFilter:
    """A filter that has sailed these courses one after the other."""
    current, rng = CurrentFilter(2.0, 0.035), random.Random(3)
    for heading in headings_rad:
        through = cmath.rect(speed_m_s, heading)
        for _ in range(round(each_s / DT)):
            noise = complex(rng.gauss(0.0, 0.05), rng.gauss(0.0, 0.05))
            current.update(gain * through + current_m_s + noise, through, 0.01, DT)
    return current


def test_set_gain_and_compass_offset_are_told_apart_once_two_courses_have_been_sailed() -> None:
    true_set, true_gain = complex(0.4, -0.3), cmath.rect(0.9, math.radians(3.0))
    current = learned([0.0, math.pi / 2.0, math.pi, -math.pi / 2.0], true_set, true_gain)
    assert current.current_m_s == pytest.approx(true_set, abs=0.04)
    assert abs(current.gain) == pytest.approx(0.9, abs=0.02)
    assert math.degrees(current.turn_rad) == pytest.approx(3.0, abs=0.8)


def test_on_one_course_the_velocity_is_known_and_its_parts_stay_in_doubt() -> None:
    true_set, true_gain = complex(0.5, 0.0), 1.1 + 0j
    current = learned([0.0], true_set, true_gain)
    through = 2.0 + 0j
    assert current.velocity_m_s(through) == pytest.approx(true_gain * through + true_set, abs=0.03)
    assert current.variance(through) < 0.1 * current.current_variance()


def test_a_boat_adrift_learns_the_set_at_once() -> None:
    current = CurrentFilter(2.0, 0.035)
    for _ in range(10):
        current.update(complex(0.0, 1.0), 0j, 0.01, DT)
    assert current.current_m_s == pytest.approx(1j, abs=0.05)
    assert current.gain == 1 + 0j


def test_one_absurd_velocity_teaches_nothing_and_a_lasting_one_does() -> None:
    current = learned([0.0, 1.5], 0j, 1 + 0j)
    before = current.current_m_s
    assert current.update(complex(9.0, 9.0), 2.0 + 0j, 0.01, DT) == 0j
    assert current.current_m_s == before
    for _ in range(300):
        current.update(complex(2.0, 1.5), 2.0 + 0j, 0.01, DT)
    assert current.velocity_m_s(2.0 + 0j) == pytest.approx(complex(2.0, 1.5), abs=0.1)


vectors = st.complex_numbers(max_magnitude=5.0, allow_nan=False, allow_infinity=False)


@given(st.lists(st.tuples(vectors, vectors), max_size=60))
def test_variances_stay_positive_for_any_samples(samples: list[tuple[complex, complex]]) -> None:
    current = CurrentFilter(2.0, 0.035)
    for over_ground, through in samples:
        current.update(over_ground, through, 0.01, DT)
        assert current.current_variance() > 0.0
        assert current.variance(through) > -1e-9
        assert 0.29 < abs(current.gain) < 3.01


def test_cruise_throttle_leads_to_cruise_speed_and_a_turn_slows_and_slides() -> None:
    water = WaterSpeed()
    for _ in range(3000):
        water.update(0.6, 0.6, 0.0, 2.0, 0.6, 3.0, 0.02)
    assert water.surge_m_s == pytest.approx(2.0, abs=0.01)
    assert water.sway_m_s == 0.0
    for _ in range(100):
        water.update(0.6, 0.6, 0.5, 2.0, 0.6, 3.0, 0.02)
    assert water.surge_m_s < 1.9
    assert -0.6 < water.sway_m_s < -0.1, "to starboard turned, to port slid"


@given(
    st.lists(st.tuples(*[st.floats(-1.0, 1.0)] * 2, st.floats(-3.0, 3.0), st.floats(0.001, 5.0)), max_size=50)
)
def test_water_speed_stays_within_reason(steps: list[tuple[float, float, float, float]]) -> None:
    water = WaterSpeed()
    for left, right, rate, dt in steps:
        water.update(left, right, rate, 2.0, 0.05, 0.1, dt)
        assert math.hypot(water.surge_m_s, water.sway_m_s) <= 12.0


def test_the_wake_knows_where_the_boat_was_between_two_ticks() -> None:
    wake = StateHistory()
    for tick in range(1, 3 * LENGTH):
        wake.advance(0.02 * tick, 1.5 + 0.5j)
    now = wake.time_s
    way, velocity = wake.at(now - 0.113)
    assert wake.displacement_m - way == pytest.approx(0.113 * (1.5 + 0.5j))
    assert velocity == 1.5 + 0.5j
    oldest, _ = wake.at(0.0)
    assert abs(wake.displacement_m - oldest) < 0.02 * LENGTH * 2.0


def test_a_habit_of_repeating_is_no_fault_and_a_new_one_is() -> None:
    repetition, now = StuckValueDetector(), 0.0
    for _ in range(30):
        repetition.change(now)
        for _ in range(4):
            now += 0.1
            repetition.repeat(now)
        assert not repetition.is_unusual(0.3)
        now += 0.1
    repetition.change(now)
    repetition.repeat(now + 1.5)
    assert not repetition.is_unusual(0.3)
    repetition.repeat(now + 1.7)
    assert repetition.is_unusual(0.3)


def test_dead_and_wild_sensors_are_told_from_noisy_ones() -> None:
    rng, good, dead, wild = random.Random(1), *[SensorTimeoutMonitor(0.15, 3.0, 0.5) for _ in range(3)]
    for tick in range(200):
        now, value = 0.02 * tick, rng.gauss(0.3, 0.01)
        good.update(value, now)
        dead.update(value if tick < 100 else 0.3, now)
        wild.update(value if tick < 100 else rng.uniform(-1.0, 1.0), now)
    assert (good.is_good, dead.is_good, wild.is_good) == (True, False, False)
    for tick in range(200, 300):
        value = rng.gauss(0.3, 0.01)
        dead.update(value, 0.02 * tick)
        wild.update(value, 0.02 * tick)
    assert dead.is_good
    assert wild.is_good


def test_a_story_of_fixes_is_consistent_frozen_or_creeping() -> None:
    watch = GnssIntegrityMonitor()
    for fix in range(40):
        watch.update(DT * fix, complex(2.0 * DT * fix, 0.0), 2.0 + 0j, 0.1)
    assert watch.is_consistent()
    assert watch.creep_m() == 0.0
    assert not watch.is_frozen(2.0, 0.2)
    for fix in range(40, 47):
        watch.update(DT * fix, complex(15.6, 0.0), 2.0 + 0j, 0.1)
    assert watch.is_frozen(0.0, 0.2)
    assert not watch.is_consistent()
    creeping = GnssIntegrityMonitor()
    for fix in range(200):
        creeping.update(DT * fix, complex(2.1 * DT * fix, 0.0), 2.0 + 0j, 0.1)
    assert creeping.is_consistent()
    assert creeping.creep_m() == pytest.approx(3.0, abs=0.2)


def fixed() -> GnssUpdate:
    """A boat at rest whose position is known well."""
    fixing = GnssUpdate(Model(Speed(), Estimation()), Estimation())
    for fix in range(50):
        fixing.update(DT * fix, 0j, 0j + 0.001 * (fix % 2), 0.1, 0)
    return fixing


def test_a_velocity_weighs_less_the_worse_its_stated_accuracy_is() -> None:
    def variance(stated_m_s: float | None, sigma_m: float = 1.0) -> float:
        fixing = GnssUpdate(Model(Speed(), Estimation()), Estimation())
        with mock.patch.object(fixing.position, "update_velocity") as update:
            for fix in range(2):
                fixing.update(DT * fix, 0j, 0.3 + 0j, sigma_m, 0, stated_m_s)
        return float(update.call_args.args[1])

    assert variance(None) == variance(0.1) == variance(0.25) == pytest.approx(0.05**2)
    assert variance(0.5) == pytest.approx(0.1**2)
    assert variance(2.0) == pytest.approx(0.4**2)
    assert variance(0.25, sigma_m=0.01) == pytest.approx(0.05**2)  # an RTK position has no better Doppler


def test_a_source_that_says_it_has_begun_anew_is_believed_at_once() -> None:
    fixing = fixed()
    fixing.update(10.0, 40.0 + 0j, 0j, 0.1, 0)
    assert abs(fixing.position.position_m) < 0.1
    fixing.update(10.2, 40.0 + 0j, 0j, 0.1, 1)
    assert fixing.position.position_m == pytest.approx(40.0, abs=0.01)
    assert fixing.resets == 1


def test_a_boat_that_has_no_thrust_takes_a_leap_for_the_truth_in_the_end() -> None:
    fixing = fixed()
    for fix in range(50, 120):
        fixing.update(DT * fix, 40.0 + 0.001j * (fix % 2), 0j, 0.1, 0)
        if fix == 60:
            assert fixing.faults(DT * fix) & EstimateFault.GNSS_JUMPING
    assert fixing.resets == 1
    assert fixing.position.position_m == pytest.approx(40.0, abs=0.1)


def test_a_heading_is_lost_when_it_is_known_badly_and_found_when_it_is_known_well() -> None:
    model = Model(Speed(), Estimation())
    model.advance(HeadingReading(0.02, 0.3, 0.0), 0.02, None)
    lost = []
    for sigma_rad in (0.1, 0.5, 0.69, 0.71, 0.5, 0.41, 0.39, 0.5, 0.69, 0.75):
        model.heading.sigma_rad = sigma_rad
        lost.append(bool(model.faults() & EstimateFault.HEADING_LOST))
        assert model.is_blind() is (lost[-1] or sigma_rad > 0.45)
    assert lost == [False, False, False, True, True, True, False, False, False, True]
