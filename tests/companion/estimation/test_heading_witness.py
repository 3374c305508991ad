"""Compass and gyro part: which of the two is believed?"""

import cmath
import math
import random

import pytest

from companion.estimation.heading import HeadingFilter
from companion.estimation.heading_consistency import HeadingConsistencyMonitor, HeadingVerdict

TICK_S = 0.02
SET_M_S = complex(0.4, -0.3)


class Passage:
    """A boat on a steady course, its heading filter, and the witness beside it."""

    def __init__(self, speed_m_s: float = 2.0) -> None:
        self.filter, self.witness = HeadingFilter(0.26), HeadingConsistencyMonitor()
        self.verdict, self.told_s, self.told_rad = HeadingVerdict.NOTHING, math.inf, 0.0
        self._speed_m_s = speed_m_s
        self._rng = random.Random(4)
        self._tick = 0
        self._heading_rad = 0.5

    def sail(self, seconds: float, compass_rad_s: float = 0.0, gyro_rad_s: float = 0.0) -> HeadingVerdict:
        """Go on, turning to and fro a little; the compass drifts and the gyro is off by so much."""
        rng, heading = self._rng, self.filter
        begun = self._tick
        for self._tick in range(begun + 1, begun + 1 + round(seconds / TICK_S)):
            now_s = TICK_S * self._tick
            rate = 0.1 * math.sin(0.5 * now_s)
            self._heading_rad += rate * TICK_S
            lie_rad = compass_rad_s * TICK_S * (self._tick - begun)
            heard_rad = self._heading_rad + lie_rad + rng.gauss(0.0, 0.014)
            heading.update(
                now_s, math.remainder(heard_rad, math.tau), rate + 0.002 + gyro_rad_s + rng.gauss(0.0, 0.005)
            )
            if self._tick % 10 == 0:
                self._hear(now_s)
            if self.verdict is not HeadingVerdict.NOTHING:
                break
        return self.verdict

    def _hear(self, now_s: float) -> None:
        witness, heading = self.witness, self.filter
        witness.update(heading.corrected_rad, heading.bias_rad_s, 0.2)
        if not witness.is_disagreeing:
            witness.record(SET_M_S, 1 + 0j, 0.2)
            return
        noise = complex(self._rng.gauss(0.0, 0.05), self._rng.gauss(0.0, 0.05))
        ground = SET_M_S + cmath.rect(self._speed_m_s, self._heading_rad) + noise
        self.verdict = witness.judge(ground, cmath.rect(self._speed_m_s, heading.heading_rad), 0.2)
        self.told_s = now_s
        believed = heading.heading_rad + witness.gap_rad
        self.told_rad = abs(math.remainder(believed - self._heading_rad, math.tau))


def test_who_is_well_does_not_quarrel() -> None:
    passage = Passage()
    passage.sail(300.0)
    assert not passage.witness.is_disagreeing


@pytest.mark.parametrize("deg_s", [-4.0, -2.0, 1.0, 2.0, 10.0])
def test_a_compass_that_turns_away_is_found_out_and_the_heading_known_all_the_same(deg_s: float) -> None:
    passage = Passage()
    passage.sail(40.0)
    assert passage.sail(20.0, compass_rad_s=math.radians(deg_s)) is HeadingVerdict.COMPASS
    assert passage.told_s < 40.0 + 15.0
    assert passage.told_rad < math.radians(5.0)


def test_a_compass_that_turns_away_soon_after_boot_is_found_out_too() -> None:
    passage = Passage()
    passage.sail(8.0)
    assert passage.sail(20.0, compass_rad_s=math.radians(2.0)) is HeadingVerdict.COMPASS


@pytest.mark.parametrize("deg_s", [-5.0, 3.0, 5.0])
def test_a_gyro_with_another_bias_is_not_taken_for_a_lying_compass(deg_s: float) -> None:
    passage = Passage()
    passage.sail(40.0)
    assert passage.sail(60.0, gyro_rad_s=math.radians(deg_s)) is HeadingVerdict.GYRO


def test_without_way_there_is_no_verdict() -> None:
    passage = Passage(speed_m_s=0.05)
    passage.sail(40.0)
    assert passage.sail(60.0, compass_rad_s=math.radians(2.0)) is HeadingVerdict.NOTHING


def test_a_compass_that_was_found_out_has_to_agree_for_a_while() -> None:
    heading = HeadingFilter(0.26)
    tick = 0

    def sail(seconds: float, off_rad: float) -> None:
        nonlocal tick
        for _ in range(round(seconds / TICK_S)):
            tick += 1
            heading.update(TICK_S * tick, off_rad, 0.0)

    heading.is_idle = False
    sail(20.0, 0.0)
    heading.reject_offset(0.0, 0.0)
    sail(15.0, 0.0)
    assert heading.is_off
    sail(2.0, 0.5)
    sail(15.0, 0.0)
    assert heading.is_off
    sail(10.0, 0.0)
    assert not heading.is_off
