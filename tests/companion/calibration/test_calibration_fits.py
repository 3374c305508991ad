"""What trials make of their measurements: regressions, the bow's model, the relay."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from twins.lines import known

from companion.calibration.heading import RelayFeedback, gains
from companion.calibration.routine import CalibrationError
from companion.calibration.yaw_model import SAMPLE_S, FittedYawModel, YawFit, yaw_model
from companion.core.fitting import Fit
from sitl.world.sampling import generator

COEFFICIENTS = st.floats(-100.0, 100.0)


@given(COEFFICIENTS, COEFFICIENTS, COEFFICIENTS)
def test_a_fit_finds_the_coefficients_of_what_is_exact(a: float, b: float, c: float) -> None:
    fit = Fit(3)
    for t in range(-5, 6):
        fit.add((1.0, t, t * t), a + b * t + c * t * t, weight=1.0 + abs(t))
    solved = known(fit.solve())
    assert solved[0] == pytest.approx([a, b, c], abs=1e-6)
    assert solved[1] == pytest.approx(0.0, abs=1e-3)


def test_a_fit_says_how_sure_it_is_of_its_first_coefficient() -> None:
    random, values = generator(1, "test/fit"), []
    for _ in range(200):
        fit = Fit(2)
        for t in range(50):
            fit.add((1.0, t), 3.0 + 0.1 * t + random.gauss(0.0, 0.5))
        solved = known(fit.solve())
        values.append((solved[0][0], solved[1]))
    spread = math.sqrt(sum((value - 3.0) ** 2 for value, _ in values) / len(values))
    claimed = sum(sigma for _, sigma in values) / len(values)
    assert claimed == pytest.approx(spread, rel=0.2)


def swung(
    model: FittedYawModel, hysteresis_rad: float, load: float = 0.0, seed: int = 1
) -> tuple[RelayFeedback, YawFit]:
    """A bow that answers exactly as a model says, swung by the relay for a minute."""
    swing, fit, random = RelayFeedback(0.3, hysteresis_rad, 0.0, 0.0), YawFit(), generator(seed, "test/swing")
    heading = rate = 0.0
    waiting = [0.0] * round(model.delay_s / SAMPLE_S)
    for tick in range(3000):
        swing.update(heading, tick * SAMPLE_S)
        steering = swing.steering
        waiting.append(steering)
        for _ in range(10):
            rate += SAMPLE_S / 10 * (model.gain_rad_s * (waiting[0] + load) - rate) / model.time_s
            heading += SAMPLE_S / 10 * rate
        waiting.pop(0)
        fit.add(steering, rate + random.gauss(0.0, model.noise_rad_s))
    return swing, fit


@pytest.mark.parametrize(
    "model",
    [
        FittedYawModel(1.3, 1.5, 0.1, 0.005),
        FittedYawModel(0.3, 4.0, 0.3, 0.002),
    ],
)
def test_two_swings_tell_gain_lag_delay_and_noise(model: FittedYawModel) -> None:
    swings = [swung(model, hysteresis, load=0.05) for hysteresis in (0.02, 0.08)]
    found = known(yaw_model([fit for _, fit in swings]))
    assert found.gain_rad_s / found.time_s == pytest.approx(model.gain_rad_s / model.time_s, rel=0.05)
    assert found.time_s == pytest.approx(model.time_s, rel=0.15)
    assert found.delay_s == pytest.approx(model.delay_s, abs=0.041)
    assert found.noise_rad_s == pytest.approx(model.noise_rad_s, rel=0.3)
    assert swings[0][0].periods_s[-1] < swings[1][0].periods_s[-1]


def test_the_throw_moves_to_meet_what_turns_the_boat_aside() -> None:
    swing, _ = swung(FittedYawModel(1.3, 1.5, 0.1), 0.02, load=0.1)
    assert swing.offset == pytest.approx(-0.1, abs=0.02)


@pytest.mark.parametrize(("halves_s", "offset"), [((3.0, 0.1), 0.21), ((0.1, 3.0), -0.21)])
def test_the_throw_never_moves_by_more_than_leaves_it_both_signs(
    halves_s: tuple[float, float], offset: float
) -> None:
    swing, now_s = RelayFeedback(0.3, 0.02, 0.0, 0.0), 0.0
    for _ in range(20):
        for half_s, off_rad in zip(halves_s, (0.03, -0.03), strict=True):
            now_s += half_s
            swing.update(off_rad, now_s)
    assert swing.offset == pytest.approx(offset)


def test_a_bow_that_does_not_come_back_is_not_swung_on() -> None:
    swing = RelayFeedback(0.3, 0.02, 0.0, 0.0)
    swing.update(0.03, 1.0)
    with pytest.raises(CalibrationError, match="does not swing"):
        swing.update(1.1, 1.02)
    swing = RelayFeedback(0.3, 0.02, 0.0, 0.0)
    with pytest.raises(CalibrationError, match="does not swing"):
        swing.update(0.0, 60.0)


@given(st.floats(0.1, 3.0), st.floats(0.3, 6.0), st.floats(0.0, 0.4), st.floats(0.0, 0.02))
def test_gains_are_positive_and_leave_the_gyros_noise_out_of_the_motors(
    gain: float, time_s: float, delay_s: float, noise: float
) -> None:
    found = {one.name: one.value for one in gains(FittedYawModel(gain, time_s, delay_s, noise), 4.0)}
    assert all(value > 0.0 for value in found.values())
    assert found["HDG_KD"] * noise <= 0.015 * (1.0 + 1e-9)


def test_gains_of_a_known_bow_are_those_of_the_rule() -> None:
    found = {one.name: one.value for one in gains(FittedYawModel(1.0, 2.0, 0.4), 2.4)}
    assert found["HDG_KD"] == pytest.approx(2.0 / 0.8)
    assert found["HDG_KP"] == pytest.approx((1.0 + 2.0 / 3.2) / 0.8)
    assert found["HDG_KI"] == pytest.approx(found["HDG_KP"] / (4.0 * 2.4))
