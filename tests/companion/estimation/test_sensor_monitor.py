"""Sensors that repeat a value."""

import math

import pytest

from companion.estimation.monitor import STUCK_S, SensorMonitor


def changing(seconds: float, every_s: float = 0.1, repeats: int = 0) -> tuple[SensorMonitor, float]:
    """A sensor that has changed for a while, with so many repetitions of each value."""
    monitor, now_s, value = SensorMonitor(), 0.0, 0.0
    while now_s < seconds:
        value += 0.1
        for _ in range(1 + repeats):
            assert monitor.update(value, now_s, 0.0)
            now_s += every_s
    return monitor, now_s - every_s


def repeat(monitor: SensorMonitor, since_s: float, seconds: float, moved: float = 0.0) -> float:
    """How long the last value is repeated until it is a fault; infinite if it is none."""
    value, steps = monitor._value, round(seconds / 0.1)
    for step in range(1, steps + 1):
        if not monitor.update(value, since_s + 0.1 * step, moved):
            return 0.1 * step
    return math.inf


def test_a_noisy_sensor_that_repeats_its_value_is_stuck_after_a_second() -> None:
    monitor, now_s = changing(10.0)
    assert repeat(monitor, now_s, 3.0) == pytest.approx(STUCK_S)
    assert monitor.is_stuck
    assert monitor.update(0.5, now_s + 4.0, 0.0), "and good as soon as it changes"


def test_a_sensor_that_repeats_itself_as_a_rule_is_stuck_after_four_times_its_longest_run() -> None:
    monitor, now_s = changing(20.0, repeats=4)  # runs of 0.4 s
    assert repeat(monitor, now_s - 0.4, 3.0) == pytest.approx(1.7)


@pytest.mark.parametrize(("changes", "stuck_s"), [(19, math.inf), (20, STUCK_S)])
def test_a_run_is_judged_by_the_longest_one_after_twenty_changes(changes: int, stuck_s: float) -> None:
    monitor = SensorMonitor()
    for number in range(changes):
        monitor.update(float(number), 0.1 * number, 0.0)
    assert repeat(monitor, 0.1 * (changes - 1), 10.0) == pytest.approx(stuck_s)


def test_a_value_that_stays_while_it_should_have_changed_is_stuck() -> None:
    monitor = SensorMonitor()
    monitor.update(1.0, 0.0, 0.0)
    assert repeat(monitor, 0.0, 10.0, moved=0.021) == pytest.approx(4.8)  # 48 times, just more than all of it


def test_a_run_that_was_a_fault_teaches_no_habit() -> None:
    monitor, now_s = changing(10.0)
    repeat(monitor, now_s, 5.0)
    for step in range(3):
        monitor.update(10.0 + step, now_s + 6.0 + 0.1 * step, 0.0)
    assert repeat(monitor, now_s + 6.2, 3.0) == pytest.approx(STUCK_S)


def with_gaps(every_s: float, silent_s: float, count: int) -> tuple[SensorMonitor, list[int]]:
    """Ten readings a second with so many gaps; at the end of which ones the sensor counts as intermittent."""
    monitor, value, told = SensorMonitor(), 0.0, list[int]()
    for gap in range(count + 1):
        for step in range(round((every_s - silent_s) / 0.1)):
            value += 0.1
            now_s = gap * every_s + 0.1 * step
            monitor.update(value, now_s, 0.0)
            if step == 0 and now_s < monitor.intermittent_until_s:
                told.append(gap)
    return monitor, told


@pytest.mark.parametrize(
    ("every_s", "silent_s", "first"),
    [(2.0, 1.0, 2), (6.0, 3.0, 3), (10.0, 0.6, 3), (14.0, 1.0, 11), (16.0, 3.0, None), (2.0, 0.3, None)],
)
def test_gaps_that_come_more_often_than_by_chance_are_a_loose_contact(
    every_s: float, silent_s: float, first: int | None
) -> None:
    _, told = with_gaps(every_s, silent_s, 12)
    assert (told[0] if told else None) == first
    assert told == list(range(first or 0, 13 if first else 0)), "and it stays one"


def test_a_loose_contact_is_over_24_seconds_after_its_last_gap() -> None:
    monitor, _ = with_gaps(2.0, 1.0, 5)
    assert monitor.intermittent_until_s == pytest.approx(10.0 + 24.0)


def test_a_sensor_that_reports_seldom_has_no_gaps() -> None:
    monitor = SensorMonitor()
    for second in range(100):
        monitor.update(float(second), float(second), 0.0)
    assert monitor.intermittent_until_s == -math.inf
