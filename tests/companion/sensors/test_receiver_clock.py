"""The time of a fix's measurement, from the receiver's time of day and the moments of arrival."""

import math
import random

import pytest

from companion.sensors.receiver_clock import AGREE, DAY_S, ReceiverClock

ASSUMED_S = 0.1


def dated(
    delays_s: list[float], apart_s: float = 0.2, began_s: float = 40_000.0, drift: float = 0.0
) -> list[float]:
    """By how much each measurement is dated later than it was made.

    delays_s: of each fix; began_s: the receiver's time of day when the boat's clock shows 0; drift: by how
    much the receiver's clock runs fast.
    """
    clock = ReceiverClock(ASSUMED_S)
    errors_s = []
    for number, delay_s in enumerate(delays_s):
        made_s = number * apart_s
        told_s = (began_s + made_s * (1.0 + drift)) % DAY_S
        errors_s.append(clock.measured_s(round(told_s, 3), made_s + delay_s) - made_s)
    return errors_s


def test_midnight_is_no_leap() -> None:
    errors_s = dated([0.1, 0.2] * 20, began_s=DAY_S - 2.0)
    assert errors_s == pytest.approx([0.0] * 40, abs=1e-3)


@pytest.mark.parametrize("drift", [50e-6, -50e-6])
def test_clocks_that_part_are_followed(drift: float) -> None:
    errors_s = dated([0.1, 0.3] * 1500, drift=drift)
    assert max(abs(error_s) for error_s in errors_s) < 0.008  # two windows of a minute, 50 ppm, 2 ms


@pytest.mark.parametrize("leap_s", [18.0, -18.0, 3600.0])
def test_a_receiver_that_sets_its_clock_is_followed_and_meanwhile_arrival_counts(leap_s: float) -> None:
    clock = ReceiverClock(ASSUMED_S)
    errors_s = []
    for number in range(100):
        made_s, delay_s = 0.2 * number, 0.1 if number % 2 else 0.2
        told_s = 40_000.0 + made_s + (leap_s if number >= 50 else 0.0)
        errors_s.append(clock.measured_s(told_s, made_s + delay_s) - made_s)
    assert max(abs(error_s) for error_s in errors_s) <= 0.1 + 1e-6
    assert errors_s[50 + 2 * AGREE :] == pytest.approx([0.0] * (50 - 2 * AGREE), abs=1e-6)


def test_nothing_is_measured_after_its_arrival() -> None:
    draw = random.Random(2)
    clock, arrival_s = ReceiverClock(0.0), 0.0
    for _ in range(2000):
        arrival_s += draw.uniform(0.0, 0.5)
        measured_s = clock.measured_s(draw.uniform(0.0, DAY_S), arrival_s)
        assert math.isfinite(measured_s)
        assert measured_s <= arrival_s


def tracked() -> ReceiverClock:
    """After ten seconds of fixes that took 0.1 s."""
    clock = ReceiverClock(ASSUMED_S)
    for number in range(50):
        clock.measured_s(40_000.0 + 0.2 * number, 0.2 * number + 0.1)
    return clock


@pytest.mark.parametrize(
    ("delay_s", "error_s"),
    [
        (0.6, 0.0),
        (3.0, 0.0),  # a line that was stuffed
        (3.2, 3.1),  # no line takes so long: nothing but the arrival is known
        (-0.85, -0.95),  # the shortest delay so far
        (-1.0, -1.1),
    ],
)
def test_a_delay_of_seconds_is_believed_as_far_as_a_line_can_be_stuffed(
    delay_s: float, error_s: float
) -> None:
    assert tracked().measured_s(40_010.0, 10.0 + delay_s) - 10.0 == pytest.approx(error_s, abs=1e-6)


def test_fixes_that_all_are_late_by_the_same_tell_of_a_clock_that_was_set() -> None:
    clock = tracked()
    errors_s = [clock.measured_s(40_010.0 + 0.2 * n, 12.1 + 0.2 * n) - 12.0 - 0.2 * n for n in range(20)]
    assert errors_s == pytest.approx([-2.0] * 9 + [0.0] * 11, abs=1e-6)


def test_delays_that_vary_are_no_clock_that_was_set() -> None:
    clock = tracked()
    for n in range(40):
        delay_s = 1.0 + 0.3 * (n % 3)
        assert clock.measured_s(40_010.0 + n, 10.0 + n + delay_s) - 10.0 - n == pytest.approx(0.0, abs=1e-6)


def test_a_delay_is_forgotten_after_two_windows() -> None:
    clock, last_s = tracked(), 0.0
    for n in range(700):
        last_s = clock.measured_s(40_010.0 + 0.2 * n, 10.3 + 0.2 * n) - 10.0 - 0.2 * n
        if n < 250:
            assert last_s == pytest.approx(0.0, abs=1e-6)
    assert last_s == pytest.approx(0.2, abs=1e-6)
