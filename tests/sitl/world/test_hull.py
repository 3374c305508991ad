"""The hull against closed forms, symmetries and conservation."""

import math

import pytest
from hull_energy import energy_j
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


def test_a_coasting_hull_slows_down_as_the_closed_form_says() -> None:
    # m u' = −(a + b u) u has the solution u = u0 e / (1 + b u0 (1 − e) / a), e = exp(−a t / m).
    mass, a, b = LAKE.mass_kg + LAKE.surge_added_kg, LAKE.surge_linear, LAKE.surge_quadratic
    for seconds in (1.0, 5.0, 20.0):
        e = math.exp(-a * seconds / mass)
        expected = 2.0 * e / (1.0 + b * 2.0 * (1.0 - e) / a)
        assert sail(LAKE, 0.0, 0.0, seconds, start=(2.0, 0.0, 0.0)).surge_m_s == pytest.approx(
            expected, rel=1e-5
        )


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
    before_j = energy_j(body)
    for _ in range(500):
        body.step(0.0, 0.0, 0.0, 0.3, -0.2, DT_S)
        assert energy_j(body) <= before_j
        before_j = energy_j(body)


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
