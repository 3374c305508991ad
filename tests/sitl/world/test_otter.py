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
