"""Sensors that are late, and the model of turning that stands in for them."""

import cmath
import math
import random

import pytest

from companion.config.boat_config import Speed
from companion.config.estimation import Estimation
from companion.core.state import EstimateFault, MotorCommand
from companion.estimation.latency import PAUSE_S, LatencyEstimator
from companion.estimation.model import Model
from companion.estimation.yaw_model import YawRateModel
from companion.sensors.readings import HeadingReading

TICK_S = 0.02


def swing(time_s: float) -> complex:
    """A boat that goes about now and then."""
    return cmath.rect(2.0, math.sin(0.7 * time_s) + 0.5 * math.sin(0.23 * time_s))


def watched(
    late_s: float, paused_s: float, seconds: float = 60.0, noise: float = 0.1, scale: float = 1.0
) -> LatencyEstimator:
    """A watch over readings that become late_s late after 20 s, with a pause of paused_s."""
    watch, rng, heard_s = LatencyEstimator(0.2), random.Random(5), 0.0
    for tick in range(round(seconds / 0.1)):
        now_s = 0.1 * tick
        if watch.is_due(now_s):
            watch.add_expected(now_s, swing(now_s))
        if tick % 2 or 20.0 <= now_s < 20.0 + paused_s:
            continue
        if now_s - heard_s > PAUSE_S:
            watch.note_gap(now_s, now_s - heard_s)
        heard_s = now_s
        late = late_s if now_s >= 20.0 else 0.0
        noisy = complex(rng.gauss(0.0, noise), rng.gauss(0.0, noise))
        watch.compare(now_s, scale * swing(now_s - late) + complex(0.5, -0.3) + noisy)
    return watch


@pytest.mark.parametrize("late_s", [0.6, 1.0, 2.0, 2.8])
def test_readings_that_have_become_late_say_by_how_much(late_s: float) -> None:
    assert watched(late_s, late_s).lag_s == pytest.approx(late_s, abs=0.21)


def test_readings_in_time_are_never_called_late() -> None:
    assert watched(0.0, 0.0).lag_s == 0.0
    assert watched(0.0, 2.0).lag_s == 0.0
    assert watched(0.0, 2.0, scale=0.6).lag_s == 0.0


def test_what_has_not_paused_cannot_have_become_late() -> None:
    assert watched(2.0, 0.0).lag_s == 0.0


def test_readings_that_are_in_time_again_are_believed_again() -> None:
    watch = LatencyEstimator(0.2)
    lags = []
    for tick in range(900):
        now_s = 0.1 * tick
        if watch.is_due(now_s):
            watch.add_expected(now_s, swing(now_s))
        if 20.0 <= now_s < 22.0:
            continue
        if now_s == 22.0:
            watch.note_gap(now_s, 2.0)
        late_s = 2.0 if 20.0 <= now_s < 50.0 else 0.0
        watch.compare(now_s, swing(now_s - late_s))
        lags.append(watch.lag_s)
    assert max(lags) == pytest.approx(2.0, abs=0.21)
    assert lags[-1] == 0.0


def test_a_sensor_that_is_slow_as_a_rule_is_not_doubted_for_it() -> None:
    watch = LatencyEstimator(0.2)
    for second in range(1, 60):
        watch.note_gap(float(second), 1.0)
    assert not watch.is_uncertain(60.0)
    watch.note_gap(63.0, 3.0)
    assert watch.is_uncertain(63.5)


def turned(model: YawRateModel, seconds: float, gain_rad_s: float = 0.9, trim_rad_s: float = 0.1) -> None:
    """Steer to and fro in a hull that turns as the model has it."""
    for tick in range(round(seconds / 0.04)):
        side = 0.8 if (tick // 80) % 2 else -0.6
        model.advance(0.04 * (tick + 1), side, -side)
        if tick % 5 == 0:
            model.learn(gain_rad_s * model.turning + trim_rad_s, model.turning, 0.2)


def test_how_steering_turns_the_hull_is_learned() -> None:
    model = YawRateModel()
    turned(model, 30.0)
    assert model.rate_of(1.0) - model.rate_of(0.0) == pytest.approx(0.9, abs=0.05)
    assert model.rate_of(0.0) == pytest.approx(0.1, abs=0.03)


def test_the_way_turned_is_remembered_for_some_seconds() -> None:
    model = YawRateModel()
    turned(model, 20.0)
    before_rad, then_s = model.turned_rad, model.time_s
    for tick in range(25):
        model.advance(then_s + 0.04 * (tick + 1), 1.0, -1.0)
    assert model.at(then_s)[0] == pytest.approx(before_rad)
    assert model.at(model.time_s)[0] == pytest.approx(model.turned_rad)
    assert model.turned_rad > before_rad


class Swinging:
    """A hull that is steered to and fro, its compass and its model."""

    def __init__(self) -> None:
        self.model = Model(Speed(), Estimation())
        self.hull = YawRateModel()
        turned(self.hull, 30.0, trim_rad_s=0.0)
        self._began_s = self.hull.time_s
        self.headings: list[float] = []

    def sail(self, seconds: float, every: int = 1, late_s: float = 0.0) -> float:
        """The largest error of the heading, in rad. every: a reading each so many ticks."""
        worst_rad = 0.0
        for _ in range(round(seconds / TICK_S)):
            tick = len(self.headings)
            now_s = TICK_S * (tick + 1)
            side = 0.7 if math.sin(0.8 * now_s) > 0.0 else -0.7
            self.hull.advance(self._began_s + now_s, side, -side)
            self.headings.append(self.hull.turned_rad)
            then = max(tick - round(late_s / TICK_S), 0)
            rate = (self.headings[then] - self.headings[max(then - 1, 0)]) / TICK_S
            reading = None
            if tick % every == 0:
                heading = math.remainder(self.headings[then], math.tau)
                reading = HeadingReading(time_s=now_s, heading_rad=heading, yaw_rate_rad_s=rate)
            yaw = self.model.advance(reading, now_s, MotorCommand(side, -side))
            self.model.propagation.learn(now_s, TICK_S)
            worst_rad = max(worst_rad, abs(math.remainder(yaw - self.headings[-1], math.tau)))
        return worst_rad


def test_between_readings_a_second_apart_steering_tells_the_heading() -> None:
    boat = Swinging()
    boat.sail(30.0)
    boat.sail(5.0, every=50)
    assert boat.sail(20.0, every=50) < math.radians(4.0)
    assert boat.model.faults() & EstimateFault.COMPASS_LATE


def test_a_compass_in_time_is_not_called_late() -> None:
    boat = Swinging()
    assert boat.sail(30.0) < math.radians(2.0)
    assert boat.model.faults() == 0


def test_the_yaw_model_turns_by_the_rudder_as_by_the_motors() -> None:
    by_motors, by_rudder = YawRateModel(), YawRateModel()
    for tick in range(1, 100):
        by_motors.advance(0.02 * tick, 0.6, -0.6)
        by_rudder.advance(0.02 * tick, 0.5, 0.5, 0.36)  # the mean of 0.6 |0.6| on either side
    # The motors' lag is before the square, the rudder's behind it
    assert by_rudder.turned_rad == pytest.approx(by_motors.turned_rad, rel=0.15)
    assert by_rudder.rate_rad_s == pytest.approx(by_motors.rate_rad_s, rel=0.1)
