"""The hull against closed forms, symmetries and conservation."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from msgspec import structs

from sitl.scenarios.scenario import load_scenario
from sitl.world.hull import Hull
from sitl.world.hull_settings import HullSettings

DT_S = 0.02
LAKE = load_scenario("open").hull
POOL = load_scenario("pool").hull


def sail(
    parameters: HullSettings,
    force_n: float,
    moment_nm: float,
    for_s: float,
    dt_s: float = DT_S,
    start: tuple[float, float, float] = (0.0, 0.0, 0.0),
    current: tuple[float, float] = (0.0, 0.0),
) -> Hull:
    body = Hull(parameters)
    body.move(*start)
    for _ in range(round(for_s / dt_s)):
        body.step(force_n, 0.0, moment_nm, *current, dt_s)
    return body


@pytest.mark.parametrize("hull", [LAKE, POOL])
@pytest.mark.parametrize("speed_m_s", [0.02, 0.05])
def test_steady_speed_balances_thrust_against_damping(hull: HullSettings, speed_m_s: float) -> None:
    thrust_n = hull.surge_linear * speed_m_s + hull.surge_quadratic * speed_m_s**2
    body = sail(hull, thrust_n, 0.0, for_s=300.0)
    assert body.surge_m_s == pytest.approx(speed_m_s, rel=1e-4)
    assert (body.sway_m_s, body.yaw_rate_rad_s, body.east_m) == (0.0, 0.0, 0.0)


def test_a_coasting_hull_slows_down_as_the_closed_form_says() -> None:
    # m u' = −(a + b u) u has the solution u = u0 e / (1 + b u0 (1 − e) / a), e = exp(−a t / m).
    mass, a, b = LAKE.mass_kg + LAKE.surge_added_kg, LAKE.surge_linear, LAKE.surge_quadratic
    for seconds in (1.0, 5.0, 20.0):
        e = math.exp(-a * seconds / mass)
        expected = 2.0 * e / (1.0 + b * 2.0 * (1.0 - e) / a)
        assert sail(LAKE, 0.0, 0.0, seconds, start=(2.0, 0.0, 0.0)).surge_m_s == pytest.approx(
            expected, rel=1e-5
        )


def test_a_pure_turn_settles_where_moment_and_yaw_damping_balance() -> None:
    strips = 0.25 * LAKE.sway_quadratic * (0.5 * LAKE.crossflow_length_m) ** 3
    body = sail(LAKE, 0.0, LAKE.yaw_linear * 0.7 + strips * 0.49, for_s=60.0)
    assert body.yaw_rate_rad_s == pytest.approx(0.7, rel=1e-6)
    assert (body.north_m, body.east_m) == (0.0, 0.0)


def test_a_clockwise_moment_turns_to_starboard_and_the_hull_slides_outward() -> None:
    body = sail(LAKE, 4.0, 0.3, for_s=3.0, start=(2.0, 0.0, 0.0))
    assert body.heading_rad > 0.3
    assert body.east_m > 0.0
    assert body.sway_m_s < -0.03  # to port, away from the turn's centre


@given(force_n=st.floats(-6.0, 6.0), moment_nm=st.floats(0.01, 0.8), speed_m_s=st.floats(-1.0, 3.0))
def test_port_and_starboard_turns_are_exact_mirror_images(
    force_n: float, moment_nm: float, speed_m_s: float
) -> None:
    right = sail(LAKE, force_n, moment_nm, 3.0, start=(speed_m_s, 0.0, 0.0))
    left = sail(LAKE, force_n, -moment_nm, 3.0, start=(speed_m_s, 0.0, 0.0))
    assert (left.north_m, left.surge_m_s) == (right.north_m, right.surge_m_s)
    assert (left.east_m, left.heading_rad) == (-right.east_m, -right.heading_rad)
    assert (left.sway_m_s, left.yaw_rate_rad_s) == (-right.sway_m_s, -right.yaw_rate_rad_s)


@pytest.mark.parametrize("hull", [LAKE, POOL])
@given(u=st.floats(-1.0, 1.0), v=st.floats(-1.0, 1.0), r=st.floats(-1.0, 1.0))
def test_an_unpowered_hull_never_gains_energy(hull: HullSettings, u: float, v: float, r: float) -> None:
    top = 3.0 if hull is LAKE else 0.07
    body = Hull(hull)
    body.move(u * top, v * top, r * 2.0)
    energy_j = body.energy_j
    for _ in range(500):
        body.step(0.0, 0.0, 0.0, 0.3, -0.2, DT_S)
        assert body.energy_j <= energy_j
        energy_j = body.energy_j


@given(
    force_n=st.floats(-4.0, 6.0),
    moment_nm=st.floats(-0.8, 0.8),
    north_m_s=st.floats(-1.0, 1.0),
    east_m_s=st.floats(-1.0, 1.0),
)
def test_a_current_only_carries_the_whole_motion_along(
    force_n: float, moment_nm: float, north_m_s: float, east_m_s: float
) -> None:
    still = sail(LAKE, force_n, moment_nm, 6.0)
    carried = sail(LAKE, force_n, moment_nm, 6.0, current=(north_m_s, east_m_s))
    assert carried.north_m - still.north_m == pytest.approx(6.0 * north_m_s, abs=1e-9)
    assert carried.east_m - still.east_m == pytest.approx(6.0 * east_m_s, abs=1e-9)
    assert carried.heading_rad == still.heading_rad
    assert carried.surge_m_s == still.surge_m_s


def test_halving_the_step_quarters_the_error() -> None:
    def end(dt_s: float) -> tuple[float, float, float]:
        body = sail(LAKE, 5.0, 0.4, 4.0, dt_s=dt_s)
        return body.north_m, body.east_m, body.heading_rad

    exact = end(0.0005)
    errors = [math.dist(end(dt_s), exact) for dt_s in (0.04, 0.02, 0.01)]
    assert errors[1] < 1e-3  # a millimetre after four seconds of hard turning, at the step that is used
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.15)
    assert errors[1] / errors[2] == pytest.approx(4.0, rel=0.15)


def test_a_hull_without_its_skeg_does_not_hold_its_course() -> None:
    bare = structs.replace(LAKE, skeg_lift_kg_m=0.0)
    swing = {
        hull: abs(sail(hull, 4.0, 0.0, 20.0, start=(2.0, 0.0, 0.01)).heading_rad) for hull in (LAKE, bare)
    }
    assert swing[LAKE] < 0.2
    assert swing[bare] > 1.0


def test_a_hull_wider_than_long_is_refused() -> None:
    with pytest.raises(ValueError, match="beam_m must not exceed length_m"):
        structs.replace(LAKE, beam_m=2.0).__post_init__()


def test_a_hull_too_light_for_its_damping_is_refused() -> None:
    with pytest.raises(ValueError, match="faster than a step"):
        structs.replace(POOL, surge_linear=20.0).__post_init__()
