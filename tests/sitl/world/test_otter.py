"""A boat with published coefficients: the Maritime Robotics Otter, 2.0 m and 55 kg, two fixed propellers.

Figures: T. I. Fossen's public model of it (MSS toolbox and Python Vehicle Simulator, after *Handbook of
Marine Craft Hydrodynamics and Motion Control*, 2021): top speed 6 knots at a bollard pull of 24.4 kgf,
0.02216 N s²/rad² for both propellers ahead, 0.395 m from the centre line, time constants of 1 s in sway and
yaw, quadratic yaw damping of ten times the linear one, added masses 0.1 m, 1.5 m and 1.7 Iz. There the
payload of 25 kg puts the centre of gravity ahead of amidships; here it lies amidships, without payload.

An independent model stands beside: Fossen's matrices in NumPy, strips by quadrature, integrated by SciPy.
"""

import math

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp

from sitl.world.hull import Hull
from sitl.world.hull_settings import HullSettings

MASS_KG, LENGTH_M, BEAM_M, GRAVITY = 55.0, 2.0, 1.08, 9.81
TOP_M_S = 6.0 * 0.5144
PULL_N = 24.4 * GRAVITY
ARM_M = 0.395
PER_SHAFT = 0.02216 / 2.0  # N per (rad/s)²
INERTIA = MASS_KG * (0.25 * LENGTH_M) ** 2
M11, M22, M33 = 1.1 * MASS_KG, 2.5 * MASS_KG, 2.7 * INERTIA
DRAUGHT_M, SECTION_DRAG = 0.134, 0.8  # of either hull; the drag of a section twice as wide as deep (Hoerner)
OTTER = HullSettings(
    mass_kg=MASS_KG,
    length_m=LENGTH_M,
    beam_m=BEAM_M,
    inertia_kg_m2=INERTIA,
    surge_added_kg=0.1 * MASS_KG,
    sway_added_kg=1.5 * MASS_KG,
    yaw_added_kg_m2=1.7 * INERTIA,
    surge_linear=PULL_N / TOP_M_S,
    surge_quadratic=0.0,
    sway_linear=M22 / 1.0,
    sway_quadratic=0.5 * 1025.0 * DRAUGHT_M * SECTION_DRAG * LENGTH_M,
    crossflow_length_m=LENGTH_M,
    yaw_linear=M33 / 1.0,
    yaw_quadratic=10.0 * M33 / 1.0,
)
DT_S = 0.02


def forces(left_rad_s: float, right_rad_s: float) -> tuple[float, float]:
    """Surge force and yaw moment of two shaft speeds ahead."""
    left_n, right_n = PER_SHAFT * left_rad_s**2, PER_SHAFT * right_rad_s**2
    return left_n + right_n, ARM_M * (left_n - right_n)


def run(surge_n: float, yaw_nm: float, for_s: float, body: Hull | None = None) -> Hull:
    body = body or Hull(OTTER)
    for _ in range(round(for_s / DT_S)):
        body.step(surge_n, 0.0, yaw_nm, 0.0, 0.0, DT_S)
    return body


def reference(surge_n: float, yaw_nm: float, for_s: float, start: tuple[float, float, float]) -> list[float]:
    """North, east, heading, u, v, r by textbook matrices, without a closed form."""
    mass = np.diag([M11, M22, M33])
    damping = np.diag([PULL_N / TOP_M_S, M22, M33])
    per_m = 0.5 * 1025.0 * DRAUGHT_M * SECTION_DRAG

    def rate(_: float, state: list[float]) -> list[float]:
        psi, (u, v, r) = state[2], state[3:]
        coriolis = np.array([[0, 0, -M22 * v], [0, 0, M11 * u], [M22 * v, -M11 * u, 0]])
        kink = [-v / r] if r and abs(v / r) < 1.0 else None
        sway = quad(lambda x: per_m * abs(v + x * r) * (v + x * r), -1.0, 1.0, points=kink)[0]
        yaw = quad(lambda x: per_m * x * abs(v + x * r) * (v + x * r), -1.0, 1.0, points=kink)[0]
        tau = np.array([surge_n, -sway, yaw_nm - yaw - 10.0 * M33 * abs(r) * r])
        nu = np.array([u, v, r])
        dot = np.linalg.solve(mass, tau - coriolis @ nu - damping @ nu)
        way = [u * math.cos(psi) - v * math.sin(psi), u * math.sin(psi) + v * math.cos(psi), r]
        return [*way, *dot.tolist()]

    solution = solve_ivp(rate, (0.0, for_s), [0.0, 0.0, 0.0, *start], rtol=1e-9, atol=1e-10)
    return [float(row[-1]) for row in solution.y]


def state(body: Hull) -> list[float]:
    return [
        body.north_m, body.east_m, body.heading_rad,
        body.surge_m_s, body.sway_m_s, body.yaw_rate_rad_s,
    ]  # fmt: skip


def test_full_ahead_gives_the_published_six_knots() -> None:
    full_rad_s = math.sqrt(0.5 * PULL_N / PER_SHAFT)
    assert full_rad_s == pytest.approx(103.9, abs=0.1)
    force_n, moment_nm = forces(full_rad_s, full_rad_s)
    assert run(force_n, moment_nm, 30.0).surge_m_s == pytest.approx(TOP_M_S, rel=1e-6)


def test_it_stops_from_full_speed_within_the_way_of_the_closed_form() -> None:
    # m11 u' = −X u, so the way until rest is m11 U / X = 2.4 m, and the time constant m11 / X = 0.78 s.
    body = Hull(OTTER)
    body.move(TOP_M_S, 0.0, 0.0)
    run(0.0, 0.0, 20.0, body)
    assert body.north_m == pytest.approx(M11 * TOP_M_S**2 / PULL_N, rel=1e-3)
    assert body.north_m == pytest.approx(2.41, abs=0.01)


@pytest.mark.parametrize(
    ("left", "right", "start"),
    [(100.0, 80.0, (0.0, 0.0, 0.0)), (60.0, 100.0, (2.5, 0.0, 0.0)), (0.0, 0.0, (2.0, -1.0, 1.5))],
    ids=["from rest", "turning at speed", "spinning down"],
)
def test_the_closed_form_sails_as_textbook_matrices_and_quadrature_do(
    left: float, right: float, start: tuple[float, float, float]
) -> None:
    force_n, moment_nm = forces(left, right)
    body = Hull(OTTER)
    body.move(*start)
    run(force_n, moment_nm, 10.0, body)
    assert state(body) == pytest.approx(reference(force_n, moment_nm, 10.0, start), abs=3e-3, rel=1e-3)


def test_the_turning_circle_is_that_of_its_steady_balance() -> None:
    """100 against 80 rad/s: after 40 s all accelerations are gone, and the circle closes on itself."""
    force_n, moment_nm = forces(100.0, 80.0)
    body = run(force_n, moment_nm, 40.0)
    u, v, r = body.surge_m_s, body.sway_m_s, body.yaw_rate_rad_s
    assert OTTER.surge_linear * u == pytest.approx(force_n + M22 * v * r, rel=1e-6)
    radius_m = math.hypot(u, v) / r
    before = body.north_m, body.east_m
    around_s = 2.0 * math.pi / r
    run(force_n, moment_nm, around_s, body)
    assert math.dist(before, (body.north_m, body.east_m)) < 0.05 * radius_m
    assert v < 0.0  # it slides outward
    assert 5.0 * LENGTH_M < 2.0 * radius_m < 30.0 * LENGTH_M


def zigzag(limit_rad: float, steer_nm: float, force_n: float) -> list[float]:
    """Kempf's manoeuvre: the moment is reversed whenever the heading passes the limit. Overshoots in rad."""
    body = run(force_n, 0.0, 20.0)
    side, overshoots, peak = 1.0, [], 0.0
    for _ in range(round(120.0 / DT_S)):
        body.step(force_n, 0.0, side * steer_nm, 0.0, 0.0, DT_S)
        peak = max(peak, -side * body.heading_rad)
        if side * body.heading_rad >= limit_rad:
            overshoots.append(peak - limit_rad)
            side, peak = -side, 0.0
    return overshoots[3:]  # the first ones still lose speed


def test_a_zigzag_is_symmetrical_and_overshoots_by_what_its_yaw_time_constant_allows() -> None:
    overshoots = zigzag(math.radians(20.0), 10.0, 120.0)
    assert len(overshoots) > 6
    assert max(overshoots) - min(overshoots) < 0.003
    # The rate dies within a second and is turned over by the moment: less than rate × time constant.
    assert 0.0 < overshoots[-1] < math.radians(10.0)
