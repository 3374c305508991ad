"""The hull against shore and movers: scraping, stopping, sticking, never through."""

import math
import random

import pytest
import shapely
from hull_energy import energy_j
from hypothesis import given
from hypothesis import strategies as st
from msgspec import structs

from sitl.scenarios.scenario import load_scenario
from sitl.world.contact import Touch, Velocity, apply_contact, crossing, overlap
from sitl.world.hull import Hull
from sitl.world.truth import Truth
from sitl.world.world import World

DT_S = 0.02
LAKE = load_scenario("open").hull
BASIN = (
    "map={water=[[-20.0, -20.0], [20.0, -20.0], [20.0, 20.0], [-20.0, 20.0]]}",
    "sensors.sonar.fitted=false",
)


def basin(*settings: str) -> World:
    return World(load_scenario("open", [*BASIN, *settings]))


def drive(water: World, left: float, right: float, for_s: float) -> Truth:
    water.hardware.motors.write(left, right)
    for _ in range(round(for_s / DT_S)):
        water.step(DT_S)
    return water.truth


def outline(truth: Truth, length_m: float = 1.0, beam_m: float = 0.35) -> shapely.Polygon:
    half, side = 0.5 * length_m, 0.5 * beam_m
    cos, sin = math.cos(truth.heading_rad), math.sin(truth.heading_rad)
    corners = [(half, 0.0), (0.0, side), (-half, 0.6 * side), (-half, -0.6 * side), (0.0, -side)]
    return shapely.Polygon(
        [(truth.east_m + x * sin + y * cos, truth.north_m + x * cos - y * sin) for x, y in corners]
    )


def test_friction_slows_a_hull_that_scrapes_along() -> None:
    free = drive(basin("boat.start=[-15.0, 0.0]", "boat.heading_deg=80"), 0.6, 0.6, 10.0)
    scraping = drive(basin("boat.start=[-15.0, 19.0]", "boat.heading_deg=80"), 0.6, 0.6, 10.0)
    assert scraping.grounded
    assert -14.0 < scraping.east_m < free.east_m - 0.5


@pytest.mark.parametrize("seed", range(2))
def test_no_corner_of_the_hull_ever_gets_out_of_the_basin(seed: int) -> None:
    helm = random.Random(seed)
    water = basin(
        "map.obstacles=[{name='pile', circle={centre=[0.0, 6.0], radius_m=0.2}}]",
        "environment.current_m_s=0.5", "environment.current_to_deg=30",
    )  # fmt: skip
    inside = water.scenario.chart.water.buffer(1e-9)
    for _ in range(40):
        truth = drive(water, helm.uniform(-1.0, 1.0), helm.uniform(-1.0, 1.0), 2.0)
        assert inside.contains(outline(truth))
    assert water.groundings > 0


def test_a_boat_that_starts_alongside_may_rub_as_it_casts_off() -> None:
    water = basin("boat.start=[0.0, 19.8]", "boat.heading_deg=90")
    drive(water, 0.4, -0.2, 3.0)
    assert abs(water.truth.heading_rad - math.radians(90.0)) > 0.1
    assert water.groundings == 0
    drive(water, 0.5, 0.5, 6.0)
    assert water.truth.north_m < 19.0
    assert water.groundings == 0


BOX = ((0.5, -0.2), (0.5, 0.2), (-0.5, 0.2), (-0.5, -0.2))  # ahead and starboard, clockwise


def test_a_touch_is_where_the_shore_or_a_mover_meets_the_outline() -> None:
    at_bow = crossing(BOX, (1.0, 0.1), (-0.7, 0.0), (0.3, 0.1))
    assert at_bow is not None
    assert at_bow[:2] == pytest.approx((0.5, 0.1))
    through = crossing(BOX, (0.3, -1.0), (0.0, 2.0), (0.3, 0.0))
    assert through == pytest.approx(Touch(0.3, 0.0, -1.0, 0.0))
    assert crossing(BOX, (0.6, -1.0), (0.0, 2.0), (0.6, 0.0)) is None
    aside = overlap(BOX, (0.3, -0.4), 0.25)
    assert aside == pytest.approx(Touch(0.3, -0.2, -0.6, 0.8))
    assert overlap(BOX, (0.3, -0.4), 0.19) is None
    assert overlap(BOX, (0.1, 0.1), 0.01) is not None, "a mover inside the hull"
    assert overlap(BOX, (0.7, -0.4), 0.25) is None, "off a corner"


PULL = st.floats(-3.0, 3.0)


@given(
    u=PULL, v=PULL, r=PULL, ahead_m=st.floats(-0.5, 0.5), starboard_m=st.floats(-0.2, 0.2),
    angle=st.floats(-math.pi, math.pi),
)  # fmt: skip
def test_a_blow_takes_the_speed_into_the_shore_and_never_adds_energy(
    u: float, v: float, r: float, ahead_m: float, starboard_m: float, angle: float
) -> None:
    body = Hull(LAKE)
    body.move(u, v, r)
    before_j = energy_j(body)
    normal = math.cos(angle), math.sin(angle)
    into = normal[0] * (u - r * starboard_m) + normal[1] * (v + r * ahead_m)
    apply_contact(body, Touch(ahead_m, starboard_m, *normal), Velocity(0.0, 0.0))
    assert energy_j(body) <= before_j * (1.0 + 1e-12) + 1e-12
    if into >= 0.0:
        assert energy_j(body) == before_j
    else:
        assert energy_j(body) < before_j or into > -1e-6


def test_what_slips_slowly_along_the_shore_sticks_to_it() -> None:
    body = Hull(structs.replace(LAKE, inertia_kg_m2=0.5))
    body.move(1.0, 0.05, 0.1)
    apply_contact(body, Touch(0.3, 0.0, -1.0, 0.0), Velocity(0.0, 0.0))
    assert (body.surge_m_s, body.sway_m_s + 0.3 * body.yaw_rate_rad_s) == pytest.approx((0.0, 0.0), abs=1e-9)
    assert body.yaw_rate_rad_s != 0.1


def test_a_hull_adrift_stops_at_the_shore_that_the_current_sets_it_on() -> None:
    body = Hull(LAKE, heading_rad=1.0)
    ahead, starboard = math.cos(1.0), -math.sin(1.0)  # of the current, in body axes
    apply_contact(body, Touch(0.0, 0.0, -ahead, -starboard), Velocity(1.0, 0.0))
    over_ground = body.surge_m_s + ahead, body.sway_m_s + starboard
    assert over_ground[0] * ahead + over_ground[1] * starboard == pytest.approx(0.0, abs=1e-9)


def test_a_soft_shore_holds_the_boat_until_the_pull_is_strong_enough() -> None:
    water = basin("boat.start=[0.0, 18.0]", "boat.heading_deg=0", "environment.shore_hold_n=3.0")
    stuck = drive(water, 0.6, 0.6, 10.0)
    assert (stuck.grounded, stuck.north_m_s, stuck.east_m_s, stuck.yaw_rate_rad_s) == (True, 0.0, 0.0, 0.0)
    weak = drive(water, -0.5, -0.5, 5.0)
    assert weak[1:4] == stuck[1:4]
    assert weak.grounded
    free = drive(water, -1.0, -1.0, 5.0)
    assert free.north_m < stuck.north_m - 1.0
    assert not free.grounded
    assert water.groundings == 1


def test_a_mover_that_comes_upon_a_lying_boat_counts_one_touch_and_passes() -> None:
    mover = "movers=[{start=[-5.0, 0.0], velocity_m_s=[1.0, 0.0], radius_m=0.5}]"
    water = basin(mover)
    touched_s: list[float] = []
    for _ in range(round(15.0 / DT_S)):
        truth = water.step(DT_S)
        if truth.grounded and not touched_s:
            touched_s.append(truth.time_s)
    # Its edge reaches the boat's side, 17.5 cm off the centre, after (5 − 0.5 − 0.175) m.
    assert touched_s == [pytest.approx(4.325, abs=0.05)]
    assert water.groundings == 1
    assert not water.truth.grounded
