"""How long a receiver waits before it asks again: RFC 6298, worked by hand."""

import pytest

from companion.mavlink.repeat_interval import RepeatInterval


def test_the_first_measurement_counts_as_mean_and_half_of_it_as_variation() -> None:
    interval = RepeatInterval(0.5)
    interval.measure(0.4)
    assert interval.seconds == pytest.approx(0.4 + 4.0 * 0.2)
    interval.measure(0.2)  # variation 0.2 + (0.2 - 0.2) / 4, mean 0.4 - 0.2 / 8
    assert interval.seconds == pytest.approx(0.375 + 4.0 * 0.2)


@pytest.mark.parametrize("round_trip_s", [0.02, 0.35, 0.6, 1.0])
def test_a_steady_station_has_a_quarter_of_a_second_to_spare(round_trip_s: float) -> None:
    interval = RepeatInterval(0.5)
    for _ in range(50):
        interval.measure(round_trip_s)
    assert interval.seconds == pytest.approx(round_trip_s + 0.25)


def test_an_answer_to_a_repeated_request_lengthens_the_interval_until_one_is_measured() -> None:
    interval = RepeatInterval(0.5)
    interval.lengthen()
    interval.lengthen()
    assert interval.seconds == pytest.approx(0.5 * 1.3 * 1.3)
    interval.measure(0.1)
    assert interval.seconds == pytest.approx(0.1 + 0.25)


def test_no_line_makes_the_boat_wait_longer_than_a_station_is_patient() -> None:
    interval = RepeatInterval(0.5)
    interval.measure(20.0)
    assert interval.seconds == pytest.approx(1.4)
    for _ in range(20):
        interval.lengthen()
    assert interval.seconds == pytest.approx(1.4)
