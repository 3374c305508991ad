"""A ranger that talks nonsense."""

from random import Random

import pytest

from companion.obstacles.perception.sonar_noise import SonarNoiseMonitor


def test_random_ranges_are_found_out_within_four_seconds_and_forgiven_once_they_end() -> None:
    babble, random = SonarNoiseMonitor(), Random(7)
    for _ in range(65):
        babble.update(random.uniform(0.02, 4.0), 4.0)
    assert babble.is_noisy
    for _ in range(60):
        babble.update(None, 4.0)
    assert not babble.is_noisy


@pytest.mark.parametrize(("leap_m", "is_noisy"), [(0.45, False), (0.55, True)])
def test_leaps_of_more_than_an_eighth_of_the_reach_are_noise(leap_m: float, is_noisy: bool) -> None:
    monitor = SonarNoiseMonitor()
    for number in range(100):
        monitor.update(1.0 + (leap_m if number % 2 else 0.0), 4.0)
    assert monitor.is_noisy is is_noisy
