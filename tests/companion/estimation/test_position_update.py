"""Which fixes are accepted, and when the position is lost."""

import math
import random

import pytest
from fix_errors import scatter

from companion.config.tuning import Estimation, Speed
from companion.core.readings import HeadingReading
from companion.core.state import EstimateFault, MotorCommand
from companion.estimation.covariance import HEADING
from companion.estimation.error_state import ErrorStateFilter
from companion.estimation.heading_update import HeadingUpdate
from companion.estimation.innovation import DISAGREES_S
from companion.estimation.position_update import PositionUpdate

FIX_S = 0.2
TICK_S = 0.02
SCATTER = scatter(0.2)
CRUISE_M_S = Speed().cruise_m_s


class Boat:
    """A filter with its updates; the boat goes north, and the receiver's velocities are right."""

    def __init__(self, speed_m_s: float = 0.0, throttle: float = 0.0) -> None:
        self.state = ErrorStateFilter(Speed(), Estimation())
        self.state.surge_m_s = speed_m_s
        self.heading = HeadingUpdate(self.state, Estimation())
        self.fixing = PositionUpdate(self.state, self.heading, Estimation())
        self.now_s, self.speed_m_s, self._throttle = 0.0, speed_m_s, throttle
        self.state.surge_m_s = speed_m_s
        self._ticks, self.has_velocity = 0, True

    def sail(
        self, seconds: float, off_m: complex | None = 0j, reset_counter: int = 0, late_s: float = 0.0
    ) -> int:
        """Go on; off_m: error of the positions, None for no fixes. Returns the faults at the end."""
        for _ in range(round(seconds / TICK_S)):
            self._ticks += 1
            self.now_s = now_s = TICK_S * self._ticks
            noise_rad = 0.001 * (self._ticks % 3)
            reading = HeadingReading(now_s, noise_rad, 0.0001 * (self._ticks % 2))
            self.heading.advance(reading, now_s, ends_block=False)
            self.state.move(now_s, MotorCommand(self._throttle, self._throttle))
            if self._ticks % 10 == 0 and off_m is not None:
                at = self.speed_m_s * (now_s - late_s) + off_m + 0.001 * (self._ticks % 20)
                velocity = complex(self.speed_m_s, 0.0001 * (self._ticks % 20)) if self.has_velocity else None
                self.fixing.update(now_s, at, velocity, SCATTER, reset_counter)
            self.state.commit()
            if self._ticks % 5 == 0:
                self.fixing.add_expected(now_s)
        return self.fixing.faults(self.now_s)

    @property
    def error_m(self) -> float:
        """Distance of the estimate from the truth."""
        return abs(complex(self.state.north_m - self.speed_m_s * self.now_s, self.state.east_m))


def test_a_source_that_has_restarted_is_believed_at_once() -> None:
    boat = Boat()
    boat.sail(10.0)
    boat.sail(0.2, off_m=40.0 + 0j)
    assert boat.error_m < 0.1
    boat.sail(0.2, off_m=40.0 + 0j, reset_counter=1)
    assert boat.state.north_m == pytest.approx(40.0, abs=0.01)


@pytest.mark.parametrize(("jump_m", "least_s", "most_s"), [(3.0, 6.0, 16.0), (10.0, 30.0, 55.0)])
def test_under_way_a_jump_that_lasts_is_accepted_the_later_the_farther_it_is(
    jump_m: float, least_s: float, most_s: float
) -> None:
    boat = Boat(CRUISE_M_S, Speed().cruise_throttle)
    boat.sail(40.0)
    assert boat.sail(1.2, off_m=1j * jump_m) & EstimateFault.GNSS_JUMPING
    waited_s = 1.2
    while boat.error_m < 0.7 * jump_m and waited_s < most_s:
        boat.sail(0.2, off_m=1j * jump_m)
        waited_s += 0.2
    assert least_s < waited_s < most_s


def test_a_fix_that_repeats_bit_by_bit_under_way_is_frozen_after_a_second() -> None:
    boat = Boat(CRUISE_M_S, Speed().cruise_throttle)
    boat.sail(20.0)
    at, velocity = complex(20.0 * CRUISE_M_S, 0.0), complex(CRUISE_M_S, 0.0)
    frozen_s = math.inf
    for tick in range(10):
        now_s = 20.2 + FIX_S * tick
        boat.fixing.update(now_s, at, velocity, SCATTER, 0)
        boat.state.commit()
        if boat.fixing.faults(now_s) & EstimateFault.GNSS_FROZEN:
            frozen_s = min(frozen_s, FIX_S * tick)
    assert frozen_s == pytest.approx(1.0, abs=0.21)


def test_a_receiver_that_freezes_as_the_boat_starts_tells_nothing_of_its_thrust() -> None:
    """Each repeat says that the boat is at rest, while both motors drive it ahead."""
    boat = Boat()
    boat.sail(20.0)
    boat._throttle = Speed().cruise_throttle
    for tick in range(50):
        now_s = 20.0 + TICK_S * (tick + 1)
        boat.heading.advance(
            HeadingReading(now_s, 0.001 * (tick % 3), 0.0001 * (tick % 2)), now_s, ends_block=False
        )
        boat.state.move(now_s, MotorCommand(boat._throttle, boat._throttle))
        if tick % 10 == 9:
            boat.fixing.update(now_s, 0.02 + 0j, complex(0.0, 0.002), SCATTER, 0)
        boat.state.commit()
    assert not boat.fixing.faults(now_s) & EstimateFault.GNSS_LOST
    assert boat.state.gain > 0.9
    expected = ErrorStateFilter(Speed(), Estimation())
    expected.has_heading = True
    for tick in range(50):
        expected.move(TICK_S * (tick + 1), MotorCommand(boat._throttle, boat._throttle))
    assert boat.state.surge_m_s == pytest.approx(expected.surge_m_s, abs=0.1)


def test_on_a_straight_line_a_receiver_that_comes_back_late_is_known_within_a_second() -> None:
    boat = Boat(CRUISE_M_S, Speed().cruise_throttle)
    boat.sail(60.0)
    boat.sail(1.6, off_m=None)
    assert not boat.fixing.faults(boat.now_s) & EstimateFault.GNSS_LATE
    assert boat.sail(1.0, late_s=1.6) & EstimateFault.GNSS_LATE
    assert boat.fixing.latency.delay_s == pytest.approx(1.6, abs=0.21)
    assert boat.error_m < 0.6
    boat.sail(20.0, late_s=1.6)
    assert boat.error_m < 0.6


def test_dead_reckoning_ends_after_a_minute_and_at_once_without_a_heading() -> None:
    boat = Boat(CRUISE_M_S, Speed().cruise_throttle)
    boat.sail(60.0)
    assert boat.sail(2.0, off_m=None) == EstimateFault.GNSS_LOST
    assert not boat.sail(56.0, off_m=None) & EstimateFault.POSITION_LOST
    assert boat.sail(4.0, off_m=None) & EstimateFault.POSITION_LOST
    other = Boat(CRUISE_M_S, Speed().cruise_throttle)
    other.sail(60.0)
    other.sail(2.0, off_m=None)
    other.state.covariance.reset(HEADING, 0.6**2)
    assert other.fixing.faults(other.now_s) & EstimateFault.POSITION_LOST


def test_a_compass_that_disagreed_is_believed_after_it_has_agreed_for_a_while() -> None:
    """One good reading between bad ones is chance."""
    boat, heard = Boat(), []
    boat.sail(20.0)
    for tick in range(1, 300):
        now_s = boat.now_s + TICK_S * tick
        lie_rad = 0.6 if tick < 100 else 0.0
        reading = HeadingReading(now_s, lie_rad + 0.001 * (tick % 3), 0.0001 * (tick % 2))
        boat.heading.advance(reading, now_s, ends_block=False)
        boat.state.move(now_s, MotorCommand(0.0, 0.0))
        boat.state.commit()
        heard.append(boat.heading.is_off)
    assert heard[98]
    assert abs(boat.state.heading_rad) < 0.02, "the gyro holds the heading"
    again = heard.index(False, 98) - 98
    assert DISAGREES_S - 0.3 < TICK_S * again < DISAGREES_S + 0.6


def test_another_place_without_velocities_is_accepted_once_an_idle_boat_has_seen_it_steadily() -> None:
    boat = Boat()
    boat.has_velocity = False
    boat.sail(20.0)
    boat.sail(9.0, 98.0 + 0j)
    assert boat.error_m < 1.0
    boat.sail(3.0, 98.0 + 0j)
    assert boat.error_m == pytest.approx(98.0, abs=1.0)


def test_no_fix_from_before_the_end_of_a_stall_tells_how_far_the_boat_went() -> None:
    boat = Boat(CRUISE_M_S, 0.5)
    boat.sail(20.0)
    state, before_s = boat.state, boat.now_s
    state.turn(before_s + 2.0, 0.0)
    for late_s in (0.0, 0.2, 0.4):
        boat.fixing.update(before_s + late_s, CRUISE_M_S * (before_s + late_s), CRUISE_M_S + 0j, SCATTER, 0)
        state.commit()
        assert boat.fixing.sigma_m > 0.9 * CRUISE_M_S
    boat.fixing.update(before_s + 2.2, CRUISE_M_S * before_s + 0j, CRUISE_M_S + 0j, SCATTER, 0)
    state.commit()
    assert boat.fixing.accepted_s == before_s + 2.2
    assert boat.fixing.sigma_m < 0.3


def test_a_new_calibration_of_the_compass_takes_away_the_learned_offset() -> None:
    boat = Boat()
    boat.sail(20.0)
    boat.state.restore(0.0, -0.1, 0.0, 0j)
    boat.state.covariance.add(HEADING, 0.04)
    assert boat.state.offset_rad == pytest.approx(-0.1, abs=0.01)
    boat.heading.forget_offset()
    boat.sail(5.0)
    assert boat.state.heading_rad == pytest.approx(0.0, abs=0.03)
    assert boat.heading.faults(boat.now_s) == 0


def test_a_compass_that_comes_and_goes_is_named_beside_what_else_it_does() -> None:
    boat = Boat()
    boat.sail(20.0)
    boat.heading._compass.intermittent_until_s = boat.now_s + 1.0
    assert boat.heading.faults(boat.now_s) == EstimateFault.COMPASS_INTERMITTENT
    boat.heading._compass.is_stuck = True
    both = EstimateFault.COMPASS_INTERMITTENT | EstimateFault.COMPASS_FROZEN
    assert boat.heading.faults(boat.now_s) == both


def test_a_receiver_without_a_statement_whose_noise_grows_is_noisy_and_weighed_less() -> None:
    boat = Boat(CRUISE_M_S, Speed().cruise_throttle)
    boat.sail(20.0)
    faults, numbers = 0, random.Random(1)
    for step in range(40):  # to 2 m within 8 s, where it states 0.2 m
        off_m = 0.05 * step * complex(numbers.gauss(0.0, 1.0), numbers.gauss(0.0, 1.0))
        faults |= boat.sail(0.2, off_m=off_m)
    assert faults == EstimateFault.GNSS_NOISY
    assert boat.error_m < 0.5


@pytest.mark.parametrize(("noise", "faults"), [(1.99, EstimateFault(0)), (2.01, EstimateFault.GNSS_NOISY)])
def test_a_receiver_is_noisy_beyond_twice_the_variance_of_its_class(
    noise: float, faults: EstimateFault
) -> None:
    boat = Boat()
    boat.sail(2.0)
    boat.state.position.noise = noise
    assert boat.fixing.faults(boat.now_s) == faults
