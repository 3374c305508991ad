"""The emulated rudder and speed controller against formulas and figures from outside."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from msgspec import structs

from sitl.scenarios.scenario import load_scenario
from sitl.world.drive.rudder import STALLED_SHARE, STALLING_RAD, Rudder, RudderSettings
from sitl.world.drive.thruster import Thruster
from sitl.world.world import World

DT_S = 0.02
DISC_M2 = 0.25 * math.pi * 0.035**2
BLADE = RudderSettings(area_m2=0.0024, arm_m=0.48, aspect=2.0, washed=0.5, stall_deg=30.0, servo_deg_s=150.0)
BARE = structs.replace(BLADE, washed=0.0)


def at_angle(degrees: float, settings: RudderSettings = BARE) -> Rudder:
    rudder = Rudder(settings, DISC_M2)
    rudder.angle_rad = math.radians(degrees)
    return rudder


def force(
    rudder: Rudder, *, thrust_n: float = 0.0, u: float = 1.0, v: float = 0.0, r: float = 0.0
) -> tuple[float, float, float]:
    share = rudder.angle_rad / math.radians(BLADE.max_deg)
    return rudder.step(share, thrust_n, u, v, r, DT_S)


def test_the_lift_slope_is_that_of_a_low_aspect_blade() -> None:
    # Molland and Turnock 2007: dC_L/dα = 1.95 π / (1 + 3/Λ) per rad; NACA 0020 of Λ = 2: 0.043 per degree
    _, starboard_n, yaw_nm = force(at_angle(10.0))
    lift = -starboard_n / (0.5 * 1000.0 * 0.0024)
    assert lift == pytest.approx(0.43, abs=0.02)
    assert yaw_nm == pytest.approx(-0.48 * starboard_n)
    assert yaw_nm > 0.0


def test_beyond_the_stall_the_lift_falls_off() -> None:
    peak = force(at_angle(30.0))[2]
    assert force(at_angle(29.0))[2] < peak
    falling = 1.0 - (1.0 - STALLED_SHARE) * math.radians(3.0) / STALLING_RAD
    assert force(at_angle(33.0))[2] == pytest.approx(
        falling * peak * math.cos(math.radians(33.0)) / math.cos(math.radians(30.0))
    )
    assert force(at_angle(40.0))[2] == pytest.approx(
        STALLED_SHARE * peak * math.cos(math.radians(40.0)) / math.cos(math.radians(30.0))
    )


def test_the_wash_is_that_of_an_actuator_disc() -> None:
    thrust_n = 2.0
    far_m_s = math.sqrt(2.0 * thrust_n / (1000.0 * DISC_M2))
    rudder = at_angle(15.0, structs.replace(BLADE, washed=1.0))
    inside = force(rudder, thrust_n=thrust_n, u=0.0)[2]
    assert inside == pytest.approx(force(at_angle(15.0), u=0.9 * far_m_s)[2])
    assert force(rudder, thrust_n=-thrust_n, u=0.0)[2] == 0.0


def test_going_astern_it_turns_the_other_way_with_less() -> None:
    ahead, astern = force(at_angle(15.0), u=1.0)[2], force(at_angle(15.0), u=-1.0)[2]
    assert -0.6 * ahead < astern < -0.4 * ahead


@given(
    st.floats(-60.0, 60.0),
    st.floats(-3.0, 3.0),
    st.floats(-1.0, 1.0),
    st.floats(-1.5, 1.5),
)
def test_without_wash_it_takes_energy_and_gives_none(angle: float, u: float, v: float, r: float) -> None:
    rudder = at_angle(angle)
    rudder.is_stuck = True
    ahead_n, starboard_n, yaw_nm = rudder.step(0.0, 0.0, u, v, r, DT_S)
    assert ahead_n * u + starboard_n * v + yaw_nm * r <= 1e-9


@given(st.floats(-30.0, 30.0), st.floats(-3.0, 3.0), st.floats(-1.0, 1.0), st.floats(-1.5, 1.5))
def test_a_mirrored_flow_gives_mirrored_forces(angle: float, u: float, v: float, r: float) -> None:
    one, other = force(at_angle(angle), u=u, v=v, r=r), force(at_angle(-angle), u=u, v=-v, r=-r)
    assert one == pytest.approx((other[0], -other[1], -other[2]), abs=1e-12)


def test_the_servo_takes_its_time() -> None:
    rudder = Rudder(BLADE, DISC_M2)
    for tick in range(1, 20):
        rudder.step(1.0, 0.0, 1.0, 0.0, 0.0, DT_S)
        assert math.degrees(rudder.angle_rad) == pytest.approx(min(150.0 * DT_S * tick, 35.0))


def boat(*settings: str) -> World:
    return World(load_scenario("open", ("boat.model=rudder", *settings)))


def turned_deg(world: World, rudder: float, seconds: float = 12.0, throttle: float = 0.6) -> float:
    """How far the boat has turned, after it has got under way."""
    assert world.hardware.rudder is not None
    world.hardware.motors.write(throttle, throttle)
    for tick in range(round(seconds / DT_S)):
        if tick == round(6.0 / DT_S):
            world.hardware.rudder.write(rudder)
        world.step(DT_S)
    return math.degrees(world.truth.heading_rad)


@pytest.mark.parametrize(
    ("kind", "low", "high"), [("off", -2.0, 2.0), ("stuck", -2.0, 2.0), ("wrong", 20.0, 180.0)]
)
def test_faults_of_the_rudder(kind: str, low: float, high: float) -> None:
    world = boat(f'faults=[{{what="rudder",kind="{kind}"}}]')
    assert low < turned_deg(world, 0.0 if kind == "wrong" else 0.4) < high


DRIVE = load_scenario("open", ("boat.model=catamaran",)).thrusters


def settled(command: float, supply_v: float = 11.1) -> Thruster:
    thruster = Thruster(DRIVE)
    for _ in range(300):
        thruster.step(command, supply_v, 0.0, DT_S)
    return thruster


@pytest.mark.parametrize("command", [0.06, -0.06])
def test_a_speed_controller_does_nothing_about_neutral(command: float) -> None:
    thruster = settled(command)
    assert (thruster.speed_rad_s, thruster.current_a) == (0.0, 0.0)


@pytest.mark.parametrize("command", [0.3, 1.0])
def test_beyond_its_dead_band_it_is_a_voltage_source(command: float) -> None:
    thruster, motor = settled(command), DRIVE.motor
    assert DRIVE.esc is not None
    inside_v = thruster.motor_a * (motor.resistance_ohm + DRIVE.esc.resistance_ohm)
    volts = motor.back_emf_v_s * thruster.speed_rad_s + inside_v
    assert volts == pytest.approx(11.1 * (command - 0.0625) / 0.9375, rel=1e-9)
