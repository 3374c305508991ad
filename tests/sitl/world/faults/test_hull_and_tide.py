"""Water and heat in the hull, and a tidal stream: by schedule, by parameter, and what the boat does then."""

import math

import pytest
from boat_rig import Rig, waypoint

from companion.core.readings import HullReading
from companion.mavlink.dialect import dialect
from sitl.world.faults.catalogue import FaultSetting
from sitl.world.faults.parts import LeakPart, thermometer_part
from sitl.world.sensors.hull_sensor import SimHullSensor
from sitl.world.sensors.settings import HullSensorSettings

pytestmark = pytest.mark.slow


def mission_run(*settings: str) -> Rig:
    """A boat on a long leg."""
    return Rig("open", *settings).sail(waypoint(500.0, 0.0))


def set_parameter(rig: Rig, name: str, value: float) -> None:
    rig.peer.send(dialect.MAVLink_param_set_message(1, 1, name.encode(), value, 9))
    rig.run(0.1)


def reading(hull: SimHullSensor, now_s: float) -> HullReading:
    hull.sample(now_s)
    latest = hull.read()
    assert latest is not None
    return latest


def test_water_by_parameter_comes_and_goes() -> None:
    rig = mission_run()
    set_parameter(rig, "SIM_LEAK", 1.0)
    rig.run(4.0)
    assert rig.mode == "RTL"
    set_parameter(rig, "SIM_LEAK", 0.0)
    rig.run(15.0)
    assert "Failsafe over: hull dry again" in rig.peer.texts


def test_the_thermometer_warms_to_its_limit_and_is_cool_again_at_once() -> None:
    hull = SimHullSensor(HullSensorSettings(temperature_c=30.0))
    part = thermometer_part(hull)
    part(FaultSetting("thermometer", "hot", size=60.0), 10.0)
    assert reading(hull, 40.0) == HullReading(40.0, False, 60.0)
    assert reading(hull, 400.0).temperature_c == 110.0
    part(None, 401.0)
    assert reading(hull, 402.0).temperature_c == 30.0
    part(FaultSetting("thermometer", "wrong", size=-12.0), 403.0)
    assert reading(hull, 404.0).temperature_c == 18.0


def test_a_fault_that_ends_leaves_the_water_that_a_parameter_has_let_in() -> None:
    hull = SimHullSensor(HullSensorSettings())
    part = LeakPart(hull)
    part.set_wet(1.0)
    part(FaultSetting("leak", "off"), 0.0)
    assert reading(hull, 0.0).is_wet is None
    part(None, 1.0)
    assert reading(hull, 2.0).is_wet is True


def test_the_hull_is_looked_at_once_a_second_by_the_boat_s_clock() -> None:
    hull = SimHullSensor(HullSensorSettings())
    hull.clock_offset_s = -3.0
    first = reading(hull, 5.0)
    assert first.time_s == 2.0
    assert reading(hull, 5.98) is first
    assert reading(hull, 6.0).time_s == 3.0
    hull.restart()
    assert hull.read() is None


def test_a_tide_comes_on_top_of_the_scenario_s_own_current() -> None:
    rig = Rig("open", "environment.current_m_s=0.3", "environment.current_to_deg=0.0")
    set_parameter(rig, "SIM_TIDE_SPEED", 0.4)
    set_parameter(rig, "SIM_TIDE_DIR", -90.0)
    rig.run(30.0)
    speed = (rig.world.truth.north_m_s, rig.world.truth.east_m_s)
    assert math.hypot(*speed) == pytest.approx(0.5, abs=0.02)
    assert math.degrees(math.atan2(speed[1], speed[0])) == pytest.approx(53.1, abs=2.0)
