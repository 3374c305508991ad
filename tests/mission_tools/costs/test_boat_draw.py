"""What a boat draws at a speed through the water: the pairs that its owner measured, and between them."""

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.config.boat_config import decode_config
from companion.core.errors import ConfigError
from mission_tools.costs.boat import Boat, load_boat

PAIRS = [[1.0, 1.1], [2.0, 2.7], [2.5, 4.6]]


def boat(**battery: object) -> Boat:
    return Boat.of(decode_config({"battery": {"idle_a": 0.6, **battery}}, "boat.toml"))


def drawn_a(of: Boat, through_m_s: float) -> float:
    return float(of.drawn_a(np.array([through_m_s]))[0])


def test_the_boat_draws_what_was_measured_at_the_measured_speeds() -> None:
    measured = boat(draw=PAIRS)
    assert [drawn_a(measured, speed) for speed, _ in PAIRS] == pytest.approx([1.1, 2.7, 4.6])
    assert measured.knows_its_draw


@pytest.mark.parametrize(("handling_m_s", "top_m_s"), [(2.5, 2.5), (2.9, 2.5), (3.0, 3.0), (2.2, 2.5)])
def test_the_last_pair_is_the_top_speed_on_a_course_if_it_is_of_full_throttle(
    handling_m_s: float, top_m_s: float
) -> None:
    tree = {"battery": {"draw": PAIRS}, "handling": {"top_speed_m_s": handling_m_s}}
    assert Boat.of(decode_config(tree, "boat.toml")).top_m_s == top_m_s
    slow = {**tree, "battery": {"cruise_a": 3.0}, "speed": {"cruise_m_s": 2.0}}
    assert Boat.of(decode_config(slow, "boat.toml")).top_m_s == handling_m_s


def test_between_two_pairs_the_motors_draw_follows_a_power_of_the_speed() -> None:
    exponent = math.log((2.7 - 0.6) / (1.1 - 0.6)) / math.log(2.0)
    assert drawn_a(boat(draw=PAIRS), 1.5) == pytest.approx(0.6 + 0.5 * 1.5**exponent)


@pytest.mark.parametrize(("driver", "below", "above"), [("l298n", 2.1, 2.7), ("esc", 1.4, 1.95)])
def test_beyond_the_pairs_brushed_and_brushless_motors_have_exponents_of_their_own(
    driver: str, below: float, above: float
) -> None:
    tree = {"battery": {"idle_a": 0.6, "cruise_a": 3.6}, "parts": {"motors": {"driver": driver}}}
    known = Boat.of(decode_config(tree, "boat.toml"))
    motors_a = 1.08 * 3.0  # a route takes 8 % more than a straight line
    assert drawn_a(known, 1.0) == pytest.approx(0.6 + motors_a * 0.5**below)
    assert drawn_a(known, 2.6) == pytest.approx(0.6 + motors_a * 1.3**above)
    assert known.top_m_s == 3.0, "a single pair is no top speed"


@given(st.lists(st.floats(0.0, 4.0), min_size=2, max_size=20))
def test_a_faster_boat_never_draws_less(speeds: list[float]) -> None:
    drawn = boat(draw=PAIRS).drawn_a(np.array(sorted(speeds)))
    assert (np.diff(drawn) >= -1e-12).all()
    assert (drawn >= 0.6).all()


def test_without_a_draw_the_charge_is_not_known() -> None:
    unknown = boat()
    assert not unknown.knows_its_draw
    assert math.isnan(drawn_a(unknown, 1.0))
    assert math.isnan(unknown.held_a())


@pytest.mark.parametrize(
    ("pairs", "wrong"),
    [
        ([[1.0, 0.5]], r"draw: \[1, 0.5\]: expected more than 0 m/s and 0.6 A"),
        ([[1.0, 1.0], [1.0, 2.0]], r"draw: \[1, 2\]: expected more than 1 m/s and 1 A"),
        ([[1.0, 2.0], [2.0, 1.5]], r"draw: \[2, 1.5\]: expected more than 1 m/s and 2 A"),
        ([[1.0]], "battery.draw"),
        ([[-1.0, 2.0]], "battery.draw"),
        ([[1.0, math.inf]], r"draw: \[1, inf\]"),
        ("much", "battery.draw"),
    ],
)
def test_pairs_that_are_no_curve_are_refused_by_name(pairs: object, wrong: str) -> None:
    with pytest.raises(ConfigError, match=wrong):
        boat(draw=pairs)


@pytest.mark.parametrize("name", ["kit", "lake", "catamaran", "rudder", "pool"])
def test_every_emulated_boat_states_what_it_draws(name: str) -> None:
    known = load_boat(name)
    assert len(known.draw) > 3
    assert known.draw[0][0] < known.cruise_m_s < known.top_m_s == known.draw[-1][0]
    assert Path("sitl/boats", f"{name}.toml").is_file()
