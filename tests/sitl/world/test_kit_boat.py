"""The emulated kit boat is the boat of docs/hardware.md, and its parts bear the currents in it."""

import re
from functools import cache
from pathlib import Path

import pytest
from msgspec import structs

from companion.config.boat_config import load_config
from companion.hal.motors.bridges import PLANS
from sitl.scenarios.scenario import load_scenario
from sitl.world.drive.thruster import Thruster
from sitl.world.scenario import Scenario
from sitl.world.world import World

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[3]
GUIDE = (ROOT / "docs" / "hardware.md").read_text(encoding="utf-8")
DT_S = 0.02
DROP_V = {
    1.0: (1.8, 3.2),
    2.0: (2.8, 4.9),
}  # ST's data sheet, V_CEsat in all: from typical values to the most


@cache
def kit() -> Scenario:
    return load_scenario("open", ("boat.model=kit",))


def stated(pattern: str) -> float:
    """A figure of the page's list of parts."""
    (figure,) = re.findall(pattern, GUIDE)
    return float(figure.replace(",", ""))


BRIDGE_A = stated(r"drives both motors \| (\d+) A per motor")
STALL_A = stated(r"stall current below (\d+) A each")
FUSE_A = stated(r"a (\d+) A fuse beside it")
SHUNT_A = stated(r"up to ([\d.]+) A with its 0.1 Ω shunt")


def full_pack_v() -> float:
    return 4.2 * kit().battery.cells


def stalled_a() -> float:
    """What one motor takes from a full pack when its shaft is held."""
    shaft = Thruster(kit().thrusters)
    shaft.weed = 1.0
    for _ in range(500):
        shaft.step(1.0, full_pack_v(), 0.0, DT_S)
    assert shaft.speed_rad_s == 0.0
    return shaft.current_a


def at(throttle: float, seconds: float = 60.0) -> tuple[float, float]:
    """Speed and pack current, straight ahead in still water."""
    world = World(kit())
    world.hardware.motors.write(throttle, throttle)
    for _ in range(round(seconds / DT_S)):
        world.step(DT_S)
    return world.truth.surge_m_s, world.truth.current_a


def test_the_parts_of_the_page_bear_stalled_motors() -> None:
    battery, volts = kit().battery, stated(r"\| (\d) V step-down converter")
    assert battery.cells == stated(r"\| (\d)S LiPo")
    assert battery.capacity_mah == stated(r"\| 3S LiPo, 11.1 V, (\d+) mAh")
    assert 12.0 / kit().thrusters.motor.resistance_ohm < STALL_A
    assert stalled_a() < BRIDGE_A
    assert 2.0 * stalled_a() + battery.idle_a < FUSE_A == bench().battery.fuse_a
    assert bench().sensors.battery.max_current_a == SHUNT_A
    converter_a = stated(r"step-down converter, (\d+) A")
    assert bench().battery.idle_a * full_pack_v() / volts < converter_a  # without losses: the most it can be


@pytest.mark.parametrize("current_a", DROP_V)
def test_the_bridge_loses_what_an_l298n_loses(current_a: float) -> None:
    bridge = kit().thrusters.bridge
    least_v, most_v = DROP_V[current_a]
    assert least_v <= bridge.drop_v + current_a * bridge.resistance_ohm <= most_v
    assert bridge.brake is PLANS["l298n"].legs_pulsed, "pulses on the enable pin open the bridge"


def test_full_ahead_is_within_the_shunt() -> None:
    speed_m_s, current_a = at(1.0)
    assert current_a < SHUNT_A
    assert speed_m_s == pytest.approx(stated(r"This boat reaches ([\d.]+) m/s at full throttle"), abs=0.05)
    assert current_a == pytest.approx(
        stated(r"full ahead at 1.6 m/s, with Pi and servo \| ([\d.]+) A"), abs=0.1
    )


def test_the_example_cruises_as_this_boat_does() -> None:
    config = load_config(ROOT / "examples" / "configs" / "boat.toml")
    vehicle = kit().vehicle
    assert config.speed == vehicle.speed
    assert config.handling == vehicle.handling
    assert config.battery.capacity_mah == vehicle.battery.capacity_mah == kit().battery.capacity_mah
    assert config.parts.battery.shunt_ohm * SHUNT_A == pytest.approx(0.32)
    speed_m_s, current_a = at(config.speed.cruise_throttle)
    assert speed_m_s == pytest.approx(config.speed.cruise_m_s, abs=0.05)
    assert current_a == pytest.approx(stated(r"cruises at 1.2 m/s with ([\d.]+) A"), abs=0.1)


def bench() -> Scenario:
    return load_scenario("bench_boat")


def test_the_bench_boat_is_the_kit_with_the_program_of_the_example() -> None:
    config = load_config(ROOT / "examples" / "configs" / "boat.toml")
    assert (bench().hull, bench().thrusters, bench().battery) == (
        kit().hull, kit().thrusters, kit().battery,
    )  # fmt: skip
    vehicle = bench().vehicle
    assert vehicle.parts.compass.driver == config.parts.compass.driver
    # The emulated field has a declination of its own, which the boat's file corrects
    assert structs.replace(vehicle.parts, compass=config.parts.compass) == config.parts
    for section in ("speed", "handling", "guidance", "battery", "motors", "thrusters", "drive", "arming"):
        assert getattr(vehicle, section) == getattr(config, section), section
