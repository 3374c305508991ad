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


def test_water_in_the_hull_by_schedule_sends_the_boat_home() -> None:
    rig = mission_run('faults=[{what="leak", kind="wet", at_s=30.0}]')
    rig.until(lambda: rig.world.time_s > 30.0, 30.0)
    assert rig.mode == "AUTO"
    rig.run(4.0)
    assert rig.mode == "RTL"
    assert "Failsafe: Water in the hull" in rig.peer.texts


def test_water_by_parameter_comes_and_goes() -> None:
    rig = mission_run()
    set_parameter(rig, "SIM_LEAK", 1.0)
    rig.run(4.0)
    assert rig.mode == "RTL"
    set_parameter(rig, "SIM_LEAK", 0.0)
    rig.run(15.0)
    assert "Failsafe over: hull dry again" in rig.peer.texts


def test_water_that_only_splashes_the_probe_does_not_end_the_mission() -> None:
    rig = mission_run('faults=[{what="leak", kind="intermittent", at_s=10.0, size=2.0}]')
    rig.run(40.0)
    assert rig.mode == "AUTO"


def test_heat_that_grows_sends_the_boat_home_once_it_is_too_hot() -> None:
    rig = mission_run('faults=[{what="thermometer", kind="hot", at_s=20.0, size=120.0}]')
    rig.until(lambda: rig.mode == "RTL", 90.0)
    # 40 °C, 2 °C a second from 20 s on: 85 °C at 42.5 s, and ten seconds of patience
    assert rig.world.time_s == pytest.approx(52.5, abs=2.5)
    assert any(text.startswith("Failsafe: Too hot: ") for text in rig.peer.texts)


def test_heat_by_parameter_is_noticed_and_over_when_it_is_cool_again() -> None:
    rig = mission_run()
    set_parameter(rig, "SIM_HULL_TEMP", 95.0)
    rig.run(13.0)
    assert (rig.mode, "Failsafe: Too hot: 95 C" in rig.peer.texts) == ("RTL", True)
    set_parameter(rig, "SIM_HULL_TEMP", 40.0)
    rig.run(35.0)
    assert "Failsafe over: cool again" in rig.peer.texts


@pytest.mark.parametrize("what", ["leak", "thermometer"])
def test_a_hull_sensor_that_is_silent_is_no_alarm(what: str) -> None:
    rig = mission_run(f'faults=[{{what="{what}", kind="off", at_s=5.0}}]')
    rig.run(30.0)
    assert rig.mode == "AUTO"
    hull = rig.boat.sensors.hull
    assert hull is not None
    assert (hull.is_wet is None, hull.temperature_c is None) == (what == "leak", what == "thermometer")


def test_a_boat_without_a_hull_sensor_has_neither_its_faults_nor_its_parameters() -> None:
    rig = Rig("open", "sensors.hull.fitted=false", 'faults=[{what="leak", kind="wet"}]')
    rig.run(5.0)
    assert rig.boat.sensors.hull is None
    assert not {"SIM_LEAK", "SIM_HULL_TEMP"} & {hook.row.name for hook in rig.world.hardware.parameter_hooks}


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


@pytest.mark.parametrize("waves_m", [0.0, 0.2])
def test_a_tide_by_parameter_carries_a_boat_adrift_away_from_where_it_comes(waves_m: float) -> None:
    rig = Rig("open", f"environment.wave_height_m={waves_m}")
    rig.run(2.0)
    set_parameter(rig, "SIM_TIDE_SPEED", 0.5)
    set_parameter(rig, "SIM_TIDE_DIR", 270.0)
    rig.run(60.0)
    truth = rig.world.truth
    assert truth.east_m == pytest.approx(30.0, abs=5.0)
    assert abs(truth.north_m) < 6.0  # the waves drift it, too
    set_parameter(rig, "SIM_TIDE_SPEED", 0.0)
    rig.run(30.0)
    stopped = rig.world.truth.east_m
    rig.run(20.0)
    assert rig.world.truth.east_m - stopped < 1.5


def test_a_tide_comes_on_top_of_the_scenario_s_own_current() -> None:
    rig = Rig("open", "environment.current_m_s=0.3", "environment.current_to_deg=0.0")
    set_parameter(rig, "SIM_TIDE_SPEED", 0.4)
    set_parameter(rig, "SIM_TIDE_DIR", -90.0)
    rig.run(60.0)
    speed = (rig.world.truth.north_m_s, rig.world.truth.east_m_s)
    assert math.hypot(*speed) == pytest.approx(0.5, abs=0.02)
    assert math.degrees(math.atan2(speed[1], speed[0])) == pytest.approx(53.1, abs=2.0)


def test_a_boat_that_keeps_station_estimates_and_stems_a_tide_that_sets_in() -> None:
    rig = Rig("open").ready()
    rig.set_mode(5)
    assert rig.arm() == 0
    set_parameter(rig, "SIM_TIDE_SPEED", 0.6)
    set_parameter(rig, "SIM_TIDE_DIR", 180.0)
    rig.run(90.0)
    nav = rig.boat.vehicle.nav
    assert nav is not None
    assert nav.current_north_m_s == pytest.approx(0.6, abs=0.15)
    assert rig.offset_m(0.0, 0.0) < 3.0
