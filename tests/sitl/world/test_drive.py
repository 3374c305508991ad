"""The drive: dead band, lag, reverse, load, energy, faults."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from msgspec import structs

from sitl.scenarios.scenario import load_scenario
from sitl.world.drive.propeller import Propeller, PropellerSettings
from sitl.world.drive.settings import ThrusterSettings
from sitl.world.drive.thruster import Thruster, Thrusters

LAKE = load_scenario("open").thrusters
POOL = load_scenario("pool").thrusters
COASTING = structs.replace(LAKE, bridge=structs.replace(LAKE.bridge, brake=False))
DRIVES = pytest.mark.parametrize("drive", [LAKE, POOL, COASTING], ids=["lake", "pool", "coasting"])
SHARE = st.floats(-1.0, 1.0)
PACK_V = 12.0
DT_S = 0.02


def settled(
    drive: ThrusterSettings, command: float, supply_v: float = PACK_V, advance_m_s: float = 0.0
) -> Thruster:
    thruster = Thruster(drive)
    for _ in range(300):
        thruster.step(command, supply_v, advance_m_s, DT_S)
    return thruster


def torque_nm(drive: ThrusterSettings, shaft: Thruster, advance_m_s: float) -> float:
    """What the propeller takes from the shaft as it turns now."""
    speed, propeller = shaft.speed_rad_s, Propeller(drive.propeller)
    return shaft.grip * abs(speed) * (propeller.torque_nn * speed - propeller.torque_nu * advance_m_s)


@DRIVES
@pytest.mark.parametrize("command", [1.0, -0.8])
def test_a_settled_shaft_balances_motor_against_propeller_and_friction(
    drive: ThrusterSettings, command: float
) -> None:
    shaft = settled(drive, command)
    motor, speed = drive.motor, abs(shaft.speed_rad_s)
    load_nm = (
        abs(torque_nm(drive, shaft, 0.0)) + motor.churning * speed**2 + motor.back_emf_v_s * motor.no_load_a
    )
    assert motor.back_emf_v_s * shaft.motor_a == pytest.approx(load_nm, rel=1e-6)
    inside_v = shaft.motor_a * (motor.resistance_ohm + drive.bridge.resistance_ohm)
    emf_v = motor.back_emf_v_s * speed
    if drive.bridge.brake:
        assert abs(command) * PACK_V == pytest.approx(drive.bridge.drop_v + inside_v + emf_v, rel=1e-9)
    else:
        assert abs(command) * (PACK_V - emf_v) == pytest.approx(inside_v, rel=1e-9)


def test_thrust_follows_the_open_water_characteristic() -> None:
    propeller = LAKE.propeller
    shaft = settled(LAKE, 1.0, advance_m_s=2.0)
    turns = shaft.speed_rad_s / (2.0 * math.pi)
    advance = 2.0 / (turns * propeller.diameter_m)
    coefficient = propeller.thrust_coefficient * (1.0 - advance / propeller.zero_thrust_advance)
    assert shaft.thrust_n == pytest.approx(1000.0 * propeller.diameter_m**4 * coefficient * turns**2)


@pytest.mark.parametrize(("drive", "dead"), [(LAKE, 0.045), (POOL, 0.12)])
def test_a_command_inside_the_deadband_moves_nothing(drive: ThrusterSettings, dead: float) -> None:
    for command in (0.0, 0.9 * dead, -0.9 * dead):
        assert settled(drive, command, 12.6).thrust_n == 0.0
    assert settled(drive, 1.1 * dead, 12.6).thrust_n > 0.0
    assert settled(drive, -1.1 * dead, 12.6).thrust_n < 0.0


@DRIVES
@given(one=SHARE, other=SHARE)
def test_more_command_never_gives_less_thrust(drive: ThrusterSettings, one: float, other: float) -> None:
    low, high = sorted((one, other))
    assert settled(drive, low).thrust_n <= settled(drive, high).thrust_n + 1e-12


@DRIVES
def test_a_stopped_motor_runs_down_to_exactly_nothing(drive: ThrusterSettings) -> None:
    shaft = settled(drive, 1.0)
    for _ in range(600):
        shaft.step(0.0, PACK_V, 0.0, DT_S)
    assert (shaft.speed_rad_s, shaft.thrust_n, shaft.current_a) == (0.0, 0.0, 0.0)


@DRIVES
@given(
    commands=st.lists(SHARE, min_size=1, max_size=6),
    advance_m_s=st.floats(-2.0, 4.0),
    supply_v=st.floats(6.0, 12.6),
)
def test_the_pack_always_gives_more_than_the_shaft_takes(
    drive: ThrusterSettings, commands: list[float], advance_m_s: float, supply_v: float
) -> None:
    """Over any while: work from the pack ≥ work on the water + what the shaft has stored."""
    shaft = Thruster(drive)
    inertia, dt_s = drive.motor.inertia_kg_m2, 0.002
    given_j = taken_j = 0.0
    for command in commands:
        for _ in range(100):
            before = shaft.speed_rad_s
            shaft.step(command, supply_v, advance_m_s, dt_s)
            given_j += supply_v * shaft.current_a * dt_s
            taken_j += torque_nm(drive, shaft, advance_m_s) * 0.5 * (before + shaft.speed_rad_s) * dt_s
    stored_j = 0.5 * inertia * shaft.speed_rad_s**2
    assert given_j >= taken_j + stored_j - 0.02 * (given_j + abs(taken_j) + stored_j) - 1e-9


@DRIVES
@given(command=SHARE, advance_m_s=st.floats(-3.0, 6.0))
def test_the_water_never_gets_more_power_than_the_shaft_gives(
    drive: ThrusterSettings, command: float, advance_m_s: float
) -> None:
    shaft = Thruster(drive)
    for _ in range(100):
        shaft.step(command, PACK_V, advance_m_s, DT_S)
        if command > 0.0:
            assert (
                shaft.thrust_n * advance_m_s
                <= torque_nm(drive, shaft, advance_m_s) * shaft.speed_rad_s + 1e-9
            )


def test_a_propeller_that_gives_more_than_it_takes_is_refused() -> None:
    with pytest.raises(ValueError, match="gives more power than it takes"):
        PropellerSettings(
            diameter_m=0.03,
            thrust_coefficient=0.4,
            torque_coefficient=0.02,
            zero_thrust_advance=2.0,
            zero_torque_advance=2.5,
        )


def test_a_dead_motor_does_nothing_and_a_reversed_one_the_opposite() -> None:
    dead, reversed_ = Thruster(LAKE), Thruster(LAKE)
    dead.gain, reversed_.gain = 0.0, -1.0
    for _ in range(300):
        dead.step(0.8, PACK_V, 0.0, DT_S)
        reversed_.step(0.8, PACK_V, 0.0, DT_S)
    assert (dead.thrust_n, dead.current_a) == (0.0, 0.0)
    assert reversed_.thrust_n == pytest.approx(settled(LAKE, -0.8).thrust_n)


def test_weed_takes_thrust_and_draws_current_until_the_motor_stalls() -> None:
    clean = settled(LAKE, 1.0)
    shafts = []
    for weed in (0.2, 0.5, 1.0):
        shaft = Thruster(LAKE)
        shaft.weed = weed
        for _ in range(300):
            shaft.step(1.0, PACK_V, 0.0, DT_S)
        shafts.append(shaft)
    assert clean.thrust_n > shafts[0].thrust_n > shafts[1].thrust_n > shafts[2].thrust_n == 0.0
    assert clean.current_a < shafts[0].current_a < shafts[1].current_a < shafts[2].current_a
    assert shafts[2].current_a == pytest.approx(PACK_V / 1.85)


def test_a_propeller_that_sucks_air_races_and_pulls_less() -> None:
    deep, airy = settled(LAKE, 0.8), Thruster(LAKE)
    airy.grip = 0.4
    for _ in range(300):
        airy.step(0.8, PACK_V, 0.0, DT_S)
    assert airy.speed_rad_s > 1.1 * deep.speed_rad_s
    assert airy.thrust_n < 0.7 * deep.thrust_n
    assert airy.current_a < deep.current_a


def test_a_motor_that_turns_faster_than_its_command_is_held_back_by_the_bridge() -> None:
    shaft, motor, bridge = Thruster(POOL), POOL.motor, POOL.bridge
    shaft.speed_rad_s = 2.0 * PACK_V / motor.back_emf_v_s
    shaft.step(0.1, PACK_V, 0.0, DT_S)
    over_v = 0.1 * PACK_V + bridge.drop_v - 2.0 * PACK_V
    assert shaft.motor_a == pytest.approx(over_v / (motor.resistance_ohm + bridge.resistance_ohm))
    assert shaft.current_a == 0.0


def test_the_propellers_grip_by_how_deep_they_are() -> None:
    pair, propeller = Thrusters(LAKE), LAKE.propeller
    for up_m, grip in ((0.0, 1.0 / 2.3), (-propeller.diameter_m, 0.0), (propeller.diameter_m, 1.0)):
        pair.set_immersion(up_m - propeller.depth_m)
        assert (pair.left.grip, pair.right.grip) == pytest.approx((grip, grip))


def test_the_left_thruster_alone_turns_clockwise() -> None:
    pair = Thrusters(LAKE)
    for _ in range(300):
        force_n, moment_nm = pair.step(1.0, 0.0, PACK_V, 0.0, 0.0, DT_S)
    assert force_n == pytest.approx(settled(LAKE, 1.0).thrust_n)
    assert moment_nm == pytest.approx(force_n * 0.15)


@given(left=SHARE, right=SHARE)
def test_swapping_the_sides_mirrors_the_moment_and_keeps_the_force(left: float, right: float) -> None:
    one, other = Thrusters(LAKE), Thrusters(LAKE)
    for _ in range(20):
        force_n, moment_nm = one.step(left, right, PACK_V, 1.0, 0.3, DT_S)
        assert other.step(right, left, PACK_V, 1.0, -0.3, DT_S) == (force_n, -moment_nm)
    assert one.current_a == pytest.approx(other.current_a)
