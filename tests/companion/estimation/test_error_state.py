"""The filter on a hull that is its model, with noise that is known exactly."""

import cmath
import math
import random
import statistics
from dataclasses import dataclass, field

import msgspec
import pytest
from fix_errors import scatter

from companion.config.tuning import Estimation, Speed
from companion.core.state import MotorCommand
from companion.core.units import wrap_pi
from companion.estimation.covariance import CURRENT_NORTH, HEADING, NORTH, SURGE
from companion.estimation.error_state import ErrorStateFilter, InnovationPair
from companion.estimation.fix_error import VELOCITY_M_S
from companion.estimation.hull_model import SurgeModel
from companion.estimation.innovation import GATE_2

TICK_S = 0.02
SIGMA_M = 0.2  # of a position, 0.8 of it slow
PRECISE_M = 0.01


@dataclass
class Voyage:
    """A boat that sails a zigzag, its sensors and the filter.

    late_s: age of a fix on arrival, as stamped; delay_s: more of it, which the driver does not know.
    """

    seed: int = 1
    current_m_s: complex = 0.4 - 0.3j
    gain: float = 1.0
    bias_rad_s: float = 0.01
    offset_rad: float = 0.03
    sigma_m: float = SIGMA_M
    doppler_m_s: float = VELOCITY_M_S
    late_s: float = 0.0
    delay_s: float = 0.0
    has_gyro: bool = True
    now_s: float = 0.0
    heading_rad: float = 0.3
    rate_rad_s: float = 0.0
    surge_m_s: float = 0.0
    at_m: complex = 0j
    velocity_m_s: complex = 0j
    nees: list[float] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.rng = random.Random(self.seed)
        self.state = ErrorStateFilter(Speed(), Estimation())
        self._surge = SurgeModel(2.0, 0.6, 3.0)
        self._wander = 0.8 * self.sigma_m * complex(self.rng.gauss(0.0, 1.0), self.rng.gauss(0.0, 1.0))
        self._fixes: list[tuple[float, float, complex, complex]] = []  # arrival, stamp, position, velocity
        self._residuals: list[float] = []
        self.is_turning, self.throttle = True, 0.6

    def _pair(self, sigma: float) -> complex:
        return complex(self.rng.gauss(0.0, sigma), self.rng.gauss(0.0, sigma))

    def sail(self, seconds: float) -> None:
        """Go on."""
        for _ in range(round(seconds / TICK_S)):
            self._tick(round(self.now_s / TICK_S) + 1)

    def _tick(self, tick: int) -> None:
        state, self.now_s = self.state, TICK_S * tick
        phase = self.now_s % 24.0
        wanted = (0.5 if phase < 3.0 else -0.5 if 12.0 <= phase < 15.0 else 0.0) if self.is_turning else 0.0
        self.rate_rad_s += TICK_S / 0.5 * (wanted - self.rate_rad_s)
        self.heading_rad += self.rate_rad_s * TICK_S
        throttle = self.throttle
        before = self.surge_m_s
        self.surge_m_s = self._surge.advance(
            before, self.rate_rad_s, throttle, throttle, self.gain, TICK_S
        ) + self.rng.gauss(0.0, 0.004)
        through = complex(self.surge_m_s, self._surge.sway_m_s) * cmath.rect(1.0, self.heading_rad)
        self.velocity_m_s = through + self.current_m_s
        self.at_m += self.velocity_m_s * TICK_S
        gyro = self.rate_rad_s + self.bias_rad_s + self.rng.gauss(0.0, 0.005)
        state.turn(self.now_s, gyro if self.has_gyro else None)
        compass = self.heading_rad + self.offset_rad + self.rng.gauss(0.0, 0.014)
        if not state.has_heading:
            state.start_heading(compass)
        self._residuals.append(wrap_pi(compass - state.offset_rad - state.heading_rad))
        if tick % 2 == 0:
            state.move(self.now_s, MotorCommand(throttle, throttle))
        if tick % 10 == 0:
            self._measure()
        while self._fixes and self._fixes[0][0] <= self.now_s + 1e-9:
            self._ingest(*self._fixes.pop(0)[1:])

    def _measure(self) -> None:
        keep = math.exp(-0.2 / 60.0)
        slow, white = 0.8 * self.sigma_m, 0.6 * self.sigma_m
        self._wander = keep * self._wander + self._pair(slow * math.sqrt(1.0 - keep * keep))
        at = self.at_m + self._wander + self._pair(white)
        stamp_s = self.now_s + self.delay_s
        self._fixes.append(
            (stamp_s + self.late_s, stamp_s, at, self.velocity_m_s + self._pair(self.doppler_m_s))
        )
        self.state.update_compass(sum(self._residuals) / len(self._residuals), len(self._residuals))
        self.state.commit()
        self._residuals.clear()

    def _ingest(self, stamp_s: float, at: complex, velocity: complex) -> None:
        state = self.state
        if self.now_s < 0.5:
            state.start_position(at.real, at.imag, scatter(self.sigma_m))
            return
        north_m, east_m, heading_rad, before = state.at(stamp_s - state.delay_s)
        state.predict_velocity(heading_rad, before, velocity, scatter(self.sigma_m)).adapt()
        state.predict_position(complex(north_m, east_m), before, at, scatter(self.sigma_m))
        state.commit()
        off = complex(state.north_m, state.east_m) - self.at_m
        self.nees.append(0.5 * abs(off) ** 2 / state.covariance.variance(NORTH))

    @property
    def error_m(self) -> float:
        """Of the position now."""
        return abs(complex(self.state.north_m, self.state.east_m) - self.at_m)


def test_current_offset_and_bias_are_known_after_some_legs() -> None:
    voyage = Voyage()
    voyage.sail(120.0)
    state = voyage.state
    assert state.current_m_s == pytest.approx(voyage.current_m_s, abs=0.08)
    assert state.bias_rad_s == pytest.approx(0.01, abs=0.003)
    assert state.offset_rad == pytest.approx(0.03, abs=math.radians(1.5))
    assert wrap_pi(state.heading_rad - voyage.heading_rad) == pytest.approx(0.0, abs=math.radians(1.5))
    assert state.surge_m_s == pytest.approx(voyage.surge_m_s, abs=0.1)


def test_position_and_heading_errors_are_as_large_as_their_variances_say() -> None:
    nees, headings = [], []
    for seed in range(1, 11):
        voyage = Voyage(seed, offset_rad=random.Random(seed).gauss(0.0, 0.035))
        voyage.sail(60.0)
        nees.append(sum(voyage.nees[50:]) / len(voyage.nees[50:]))
        state = voyage.state
        headings.append(
            wrap_pi(state.heading_rad - voyage.heading_rad) ** 2 / state.covariance.variance(HEADING)
        )
    # 10 voyages, in each a wander of a minute: χ² of about 20 degrees of freedom, 99 % bounds
    assert 0.37 < sum(nees) / len(nees) < 2.0
    assert sum(headings) / len(headings) < 2.1


def test_fixes_that_arrive_late_say_what_they_would_have_said_in_time() -> None:
    in_time, late = Voyage(seed=5), Voyage(seed=5, late_s=0.6)
    in_time.sail(60.0)
    late.sail(60.0)
    assert abs(in_time.state.north_m - late.state.north_m) < 0.12
    assert abs(in_time.state.current_m_s - late.state.current_m_s) < 0.05
    assert abs(wrap_pi(in_time.state.heading_rad - late.state.heading_rad)) < math.radians(1.0)


def test_an_unknown_delay_is_learned_from_a_precise_receiver() -> None:
    voyage = Voyage(sigma_m=PRECISE_M, delay_s=0.06)
    voyage.sail(120.0)
    assert voyage.state.delay_s == pytest.approx(0.06, abs=0.03)
    assert voyage.error_m < 0.1


def test_a_position_beyond_the_gate_is_seen_and_changes_nothing_unless_it_is_applied() -> None:
    voyage = Voyage()
    voyage.sail(60.0)
    state = voyage.state
    before = state.north_m, state.covariance.rows
    here, way = complex(state.north_m, state.east_m), voyage.velocity_m_s
    wrong = state.predict_position(here, way, voyage.at_m + 10.0, scatter(SIGMA_M))
    assert wrong.nis > GATE_2
    state.withdraw(wrong)
    assert not wrong.north.is_accepted
    state.commit()
    assert (state.north_m, state.covariance.rows) == before
    assert state.predict_position(here, way, voyage.at_m, scatter(SIGMA_M)).nis < GATE_2


def test_uncertainty_grows_without_measurements_and_a_stall_adds_to_it() -> None:
    voyage = Voyage()
    voyage.sail(60.0)
    state, now_s = voyage.state, voyage.now_s
    before = state.covariance.variance(NORTH)
    for tick in range(1, 501):
        state.turn(now_s + 0.02 * tick, voyage.bias_rad_s)
        state.keep_covariance()
    drifted = state.covariance.variance(NORTH)
    assert drifted > 4.0 * before
    state.turn(now_s + 15.0, voyage.bias_rad_s)
    state.move(now_s + 15.0, None)
    state.keep_covariance()
    assert state.covariance.variance(NORTH) > drifted + 4.0**2
    assert abs(state.north_m - voyage.at_m.real) < 3.0, "the motion of a stalled loop is not made up"


def test_without_compass_and_gyro_the_heading_becomes_unknown_and_no_more_than_that() -> None:
    voyage = Voyage()
    voyage.sail(20.0)
    state, spreads = voyage.state, []
    for tick in range(1, 1500):
        state.turn(voyage.now_s + 0.1 * tick, None)
        state.keep_covariance()
        spreads.append(state.covariance.variance(HEADING))
    assert spreads[0] < 0.01
    assert max(spreads) == pytest.approx(1.0), "a deviation beyond a radian has no meaning"


def test_a_sideways_motion_that_the_model_does_not_know_is_estimated_and_fades() -> None:
    voyage = Voyage(current_m_s=0j)
    voyage.is_turning = False
    voyage.sail(60.0)
    state, aside = voyage.state, cmath.rect(0.3, voyage.heading_rad + 0.5 * math.pi)
    before = state.sway_m_s
    for _ in range(3):
        here = complex(state.north_m, state.east_m)
        _, _, heading_rad, way = state.at(voyage.now_s)
        state.predict_velocity(heading_rad, way, voyage.velocity_m_s + aside, scatter(SIGMA_M))
        state.commit()
    assert here == pytest.approx(complex(state.north_m, state.east_m), abs=0.3)
    gust = state.sway_m_s - before
    assert gust > 0.03
    assert state.at(voyage.now_s)[3] == pytest.approx(
        state.through_water(state.heading_rad) + state.current_m_s
    )
    for tick in range(1, 100):
        state.move(voyage.now_s + 0.06 * tick, MotorCommand(0.6, 0.6))
    assert abs(state.side_m_s) < 0.3 * gust


def test_the_history_knows_where_the_boat_was_by_what_is_known_now() -> None:
    voyage = Voyage(sigma_m=PRECISE_M)
    voyage.is_turning = False
    voyage.sail(40.0)
    state = voyage.state
    north_m, east_m, heading_rad, velocity = state.at(voyage.now_s - 0.5)
    moved = complex(state.north_m - north_m, state.east_m - east_m)
    assert moved == pytest.approx(0.5 * voyage.velocity_m_s, abs=0.03)
    assert heading_rad == pytest.approx(state.heading_rad, abs=0.02)
    assert velocity == pytest.approx(voyage.velocity_m_s, abs=0.1)
    oldest = state.at(0.0)
    assert abs(complex(oldest[0], oldest[1]) - complex(state.north_m, state.east_m)) < 6.0 * abs(velocity)


@pytest.mark.parametrize("lasts", [0.0, 0.5, 0.8])
def test_a_velocity_whose_error_lasts_corrects_less_and_is_judged_by_its_own_size(lasts: float) -> None:
    """By hand: prior variance of the velocity ahead p, of the noise r; density (1 + ρ) / (1 − ρ)."""
    state = ErrorStateFilter(Speed(), Estimation())
    p = sum(state.covariance.variance(one) for one in (SURGE, CURRENT_NORTH))
    error = msgspec.structs.replace(scatter(SIGMA_M), lasts=lasts)
    pair = state.predict_velocity(0.0, 0j, 0.3 + 0j, error)
    r = VELOCITY_M_S**2
    assert pair.north.variance == pytest.approx(p + r)
    state.commit()
    assert state.surge_m_s + state.current_north_m_s == pytest.approx(
        0.3 * p / (p + r * (1.0 + lasts) / (1.0 - lasts))
    )


@pytest.mark.parametrize("lasts", [0.0, 0.5, 0.8])
def test_noise_is_learned_from_what_of_it_changes(lasts: float) -> None:
    rng, pair, sigma = random.Random(2), InnovationPair(), 0.3
    value, learned = 0j, []
    for tick in range(4000):
        step = sigma * math.sqrt(1.0 - lasts * lasts)
        value = lasts * value + complex(rng.gauss(0.0, step), rng.gauss(0.0, step))
        variance = 0.01 * pair.noise
        pair.next(0.2 * tick, (value.real, variance), (value.imag, variance), value)
        pair.adapt(lasts)
        learned.append(pair.noise)
    assert statistics.mean(learned[400:]) == pytest.approx(sigma * sigma / 0.01, rel=0.15)


@pytest.mark.parametrize(("speed_m_s", "tells"), [(0.14, False), (0.16, True)])
def test_the_course_tells_the_heading_from_three_deviations_of_the_velocity_on(
    speed_m_s: float, tells: bool
) -> None:
    state = ErrorStateFilter(Speed(), Estimation())
    before = state.covariance.variance(HEADING)
    state.predict_velocity(0.0, complex(speed_m_s, 0.0), complex(speed_m_s, 0.01), scatter(SIGMA_M))
    state.commit()
    assert (state.covariance.variance(HEADING) < before) is tells


def scattered(steps_m: list[float], stated_m2: float = 1.0) -> float:
    """The noise after rejected positions whose innovations change by this much to and fro."""
    pair, value = InnovationPair(), 0j
    for step_m in steps_m:
        value += step_m
        pair.next(0.0, (value.real, 0.01), (value.imag, 0.01), value)
        pair.adapt_rejected(stated_m2)
    return pair.noise


def test_noise_that_grows_is_followed_through_rejected_positions() -> None:
    assert scattered([1.0, -1.0]) == pytest.approx(2.2**2), (
        "by at most 25 times the variance, a twentieth each"
    )
    assert scattered([0.3]) == pytest.approx(1.0 + 0.05 * (0.25 * 0.09 / 0.01 - 1.0))


def test_rejected_positions_that_agree_lower_no_noise() -> None:
    assert scattered([1.0, 0.0, 0.0, 0.0]) == pytest.approx(2.2)


def test_a_step_beyond_five_deviations_of_the_stated_error_is_a_lie_and_no_noise() -> None:
    assert scattered([9.99]) == pytest.approx(2.2)
    assert scattered([10.01]) == 1.0
    assert scattered([20.0, 1.0]) == pytest.approx(2.2), "the next one counts from there"
