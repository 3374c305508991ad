"""A turn rate as a heading that moves ahead of the bow."""

import math

import pytest

from companion.core.state import NavState
from companion.guidance.pilot import Turning


def nav_at(heading: float) -> NavState:
    return NavState(0.0, 0.0, 0.0, heading, 0.0, 0.0, 0.0, 0.0, 0.0, 0.1, 0.1)


def test_the_heading_moves_at_the_rate_from_the_bow_on() -> None:
    turning = Turning()
    headings = [turning.update(0.5, nav_at(2.0), 0.1) for _ in range(3)]
    assert headings == pytest.approx([2.05, 2.10, 2.15])
    assert turning.update(-0.5, nav_at(2.0), 0.1) == pytest.approx(2.10)


def test_at_rate_zero_the_heading_stands_while_the_bow_swings() -> None:
    turning = Turning()
    turning.update(0.5, nav_at(0.0), 0.2)
    assert turning.update(0.0, nav_at(0.3), 0.1) == pytest.approx(0.1)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_bow_that_does_not_keep_up_is_led_by_a_radian_at_most(side: float) -> None:
    turning = Turning()
    for _ in range(100):
        heading = turning.update(side * 0.5, nav_at(0.2), 0.1)
    assert heading == pytest.approx(0.2 + side)


def test_the_heading_is_wrapped() -> None:
    assert Turning().update(1.0, nav_at(math.pi - 0.1), 0.3) == pytest.approx(-math.pi + 0.2)


def test_after_a_reset_it_begins_at_the_bow() -> None:
    turning = Turning()
    turning.update(1.0, nav_at(0.0), 0.5)
    turning.reset()
    assert turning.update(0.0, nav_at(1.5), 0.1) == 1.5
