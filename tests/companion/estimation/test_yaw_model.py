"""The yaw model: what a gyro teaches of steering, and which part of its rate is that of waves."""

import math
import random
from collections.abc import Callable

import pytest

from companion.estimation.yaw_model import HullFit, WaveSpectrum, YawModel

TICK_S = 0.04


def test_a_gyro_is_smoothed_and_a_steady_turn_has_no_error() -> None:
    model, rng, errors = YawModel(0.6, 1.0), random.Random(2), []
    for tick in range(3000):
        model.update(0.5 + rng.gauss(0.0, 0.006))
        if tick % 2 == 0:
            model.advance(0.0, 0.0, 0.0, TICK_S)
        errors.append(model.rate_rad_s - 0.5)
    late = errors[500:]
    assert sum(late) / len(late) == pytest.approx(0.0, abs=1e-3)
    assert math.sqrt(sum(error * error for error in late) / len(late)) < 0.5 * 0.006


def test_the_gyro_teaches_what_turn_steering_gives() -> None:
    """The hull turns at 0.4 rad/s at full steering, in a wind that turns it by 0.05 rad/s."""
    hull, model, rng = YawModel(0.4 / 1.6, 1.6), YawModel(0.4, 1.0), random.Random(3)
    for tick in range(6000):
        steering = 0.5 if tick % 400 < 200 else -0.5
        for of in (hull, model):
            of.advance(steering, -steering, 0.0, 0.02)
        model.update(hull.rate_rad_s + 0.05 + rng.gauss(0.0, 0.006))
    assert model.hull.accel_rad_s2 == pytest.approx(0.4 / 1.6, rel=0.1)
    assert model.hull.damping_per_s == pytest.approx(1.0 / 1.6, rel=0.2)
    assert model.gain_rad_s == pytest.approx(model.hull.accel_rad_s2 * 1.0)
    assert model.rest_rad_s == pytest.approx(0.05, abs=0.15)


def test_what_is_learned_of_the_hull_is_trusted() -> None:
    fit = HullFit(0.4, 1.0)
    assert fit.misfit == 0.5
    for tick in range(1000):
        fit.update(0.0, 0.5 if tick % 100 < 50 else -0.5, 0.02, learns=tick < 500)
        if tick == 500:
            learned = fit.misfit
    assert fit.misfit == learned == pytest.approx(0.5 * math.sqrt(0.02 / fit._ee))
    assert learned < 0.2


def spectrum(
    rate: Callable[[float], float], turning: float = 0.0, dt_s: float = TICK_S, doubt: float = 0.0
) -> WaveSpectrum:
    """After 40 s of a rate, a function of time."""
    found = WaveSpectrum()
    for tick in range(round(40.0 / dt_s)):
        found.update(rate(tick * dt_s), turning, doubt, dt_s)
    return found


@pytest.mark.parametrize("omega", [3.3, 5.0])
def test_the_spectrum_tells_frequency_and_size_of_waves(omega: float) -> None:
    found = spectrum(lambda time_s: 0.2 * math.sin(omega * time_s) + 0.1)
    assert found.encounter_rad_s == pytest.approx(omega, rel=0.1)
    band = 1.0 / math.hypot(1.0, 0.7 / omega) / (1.0 + (omega / 8.0) ** 2)
    assert found.variance == pytest.approx(0.86 * 0.5 * (0.2 * band) ** 2, rel=0.07)  # the filter is discrete
    assert found.share > 0.8


def test_noise_and_slow_turns_are_no_waves() -> None:
    rng = random.Random(1)
    calm = spectrum(lambda time_s: rng.gauss(0.0, 0.006) + 0.1 * math.sin(0.4 * time_s))
    assert calm.share == calm.variance == 0.0
    assert spectrum(lambda time_s: 0.01 * math.sin(3.3 * time_s)).share == 0.0
    assert spectrum(lambda time_s: 0.03 * math.sin(3.2 * time_s)).share > 0.5


def test_the_heading_loop_answers_what_is_slower_than_itself() -> None:
    assert spectrum(lambda time_s: 0.3 * math.sin(1.5 * time_s)).share == 0.0
    assert spectrum(lambda time_s: 0.3 * math.sin(2.4 * time_s)).share == pytest.approx(0.5, abs=0.06)


def test_nothing_is_learned_of_waves_in_a_turn() -> None:
    def wave(time_s: float) -> float:
        return 0.2 * math.sin(3.3 * time_s) if time_s > 2.0 else 0.0

    assert spectrum(wave, turning=0.2).share == 0.0
    assert spectrum(wave, turning=-0.2).share == 0.0
    assert spectrum(wave, turning=-0.04).share > 0.9


def test_a_slow_loop_does_not_make_waves_of_nothing() -> None:
    found = spectrum(lambda time_s: 0.1 * math.sin(0.5 * time_s), dt_s=0.15)
    assert found.share == 0.0
    assert spectrum(lambda time_s: 0.2 * math.sin(3.3 * time_s), dt_s=0.15).share > 0.8


def test_the_swings_of_a_hull_that_steering_makes_are_no_waves() -> None:
    swings = 0.2 / math.sqrt(2.0) * 3.0  # of acceleration
    assert spectrum(lambda time_s: 0.2 * math.sin(3.3 * time_s), doubt=1.1 * swings).share == 0.0
    assert spectrum(lambda time_s: 0.2 * math.sin(3.3 * time_s), doubt=0.5 * swings).share > 0.5


def in_waves(
    steering: Callable[[float], float], size: float = 0.3, omega: float = 4.0
) -> list[tuple[float, float]]:
    """A hull in regular waves for 60 s: errors of rate and wave angle over the last 20 s."""
    hull, model, rng, errors = YawModel(0.6, 1.0), YawModel(0.6, 1.0), random.Random(4), []
    for tick in range(3000):
        time_s = 0.02 * tick
        wave = size * math.sin(omega * time_s)
        if tick % 2 == 0:
            side = steering(time_s) if time_s > 40.0 else 0.0
            for of in (hull, model):
                of.advance(side, -side, 0.0, TICK_S)
        model.update(hull.rate_rad_s + wave + rng.gauss(0.0, 0.006))
        if time_s > 40.0:
            errors.append(
                (model.rate_rad_s - hull.rate_rad_s, model.wave_rad + size / omega * math.cos(omega * time_s))
            )
    return errors


def rms(values: list[float]) -> float:
    return math.sqrt(sum(value * value for value in values) / len(values))


def test_the_rate_of_waves_is_kept_from_the_loops() -> None:
    errors = in_waves(lambda _: 0.0)
    assert rms([rate for rate, _ in errors]) < 0.1 * 0.3 / math.sqrt(2.0)
    assert rms([angle for _, angle in errors]) < 0.25 * 0.3 / 4.0 / math.sqrt(2.0)


def test_a_turn_among_waves_is_known_at_once() -> None:
    errors = in_waves(lambda time_s: 0.7 if time_s < 45.0 else 0.0)
    assert max(abs(rate) for rate, _ in errors) < 0.1


def test_a_wind_among_waves_is_found() -> None:
    model = YawModel(0.6, 1.0)
    for tick in range(3000):
        if tick % 2 == 0:
            model.advance(0.0, 0.0, 0.0, TICK_S)
        model.update(0.1 + 0.3 * math.sin(0.08 * tick))
    assert model.rest_rad_s == pytest.approx(0.1, abs=0.03)
    assert model.gain_rad_s == pytest.approx(0.6, rel=0.01)


def test_waves_are_forgotten_in_calm_water_and_without_a_gyro() -> None:
    model = YawModel(0.6, 1.0)
    for tick in range(6000):
        if tick % 2 == 0:
            model.advance(0.0, 0.0, 0.0, TICK_S)
        model.update(0.3 * math.sin(0.08 * tick) if tick < 3000 else 0.0)
        if tick == 2990:
            assert model.waves.share > 0.9
    assert model.waves.share == model.wave_rad == 0.0
    for tick in range(3000):
        if tick % 2 == 0:
            model.advance(0.0, 0.0, 0.0, TICK_S)
        model.update(0.3 * math.sin(0.08 * tick))
    for _ in range(500):
        model.advance(0.0, 0.0, 0.0, TICK_S)
    assert model.wave_rad == pytest.approx(0.0, abs=1e-3)


def test_readings_that_may_be_late_teach_no_gain() -> None:
    model = YawModel(0.6, 1.0)
    for tick in range(500):
        steering = 0.5 if tick % 200 < 100 else -0.5
        model.advance(steering, -steering, 0.0, 0.02)
        model.update(0.4 * model.turning, learns=False)
    assert model.gain_rad_s == 0.6
    assert model.rate_rad_s == pytest.approx(0.4 * model.turning, abs=0.02), "the rate follows all the same"
    model.update(0.5, learns=True)
    model.advance(0.5, -0.5, 0.0, 0.02)
    assert model.gain_rad_s != 0.6


def test_what_is_learned_of_a_hull_is_bounded_and_starts_as_configured() -> None:
    model = YawModel(0.6, 1.0)
    assert (model.hull.accel_rad_s2, model.hull.damping_per_s) == (0.6, 1.0)
    for tick in range(3000):  # held aground
        model.update(0.001 * (tick % 3))
        steering = 0.5 if tick % 400 < 200 else -0.5
        model.advance(steering, -steering, 0.0, 0.02)
    assert model.hull.accel_rad_s2 == 0.3
    assert 0.0 <= model.hull.damping_per_s <= 2.0


def test_waves_teach_nothing_of_the_hull() -> None:
    model, rng = YawModel(0.6, 1.0), random.Random(7)
    for tick in range(3000):
        wave = 0.3 * math.sin(0.08 * tick)
        steering = -0.3 * wave if tick < 1500 else 0.5 * math.sin(0.06 * tick)
        if tick % 2 == 0:
            model.advance(steering, -steering, 0.0, TICK_S)
        model.update(wave + rng.gauss(0.0, 0.006))
        if tick == 1500:
            before = model.hull.accel_rad_s2
            assert model.waves.share > 0.9
    assert model.hull.accel_rad_s2 == before


def test_a_steady_wind_teaches_nothing_of_the_hull() -> None:
    model = YawModel(0.6, 1.0)
    for _ in range(3000):
        model.update(0.05)
        model.advance(0.3, -0.3, 0.0, 0.02)
    assert model.hull.accel_rad_s2 == pytest.approx(0.6, rel=0.2)
