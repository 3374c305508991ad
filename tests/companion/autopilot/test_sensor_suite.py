"""What the boat reads in one tick, from parts that the test sets."""

import math
from collections.abc import Sequence
from typing import Generic, TypeVar

import pytest
from boat_rig import FRAME, GOOD_FIX, ORIGIN
from msgspec.structs import replace

from companion.autopilot.sensor_suite import READ_S, SONAR_START_S, OriginMonitor, SensorSuite, trimmed
from companion.config.boat_config import BoatConfig, External, Parts, Trim
from companion.config.sensors import CompassPart, ProbePart
from companion.core.geo import LatLon, LocalFrame
from companion.core.readings import BatteryReading, GnssFix, HeadingReading, ProbeReading, SonarReading
from companion.core.state import MotorCommand
from companion.core.status_text import Severity, StatusText
from companion.estimation.estimator import Estimator
from companion.hal.interfaces import Hardware
from companion.obstacles.perception.sonar_schedule import Sector
from companion.sensors.compass.earth_field import EarthField
from companion.sensors.compass.magnetic_field import FieldCorrector, MagneticCorrection
from companion.sensors.external import ExternalSensors

R = TypeVar("R")

CONFIG = BoatConfig()
NO_EXTERNAL = External()


class Part(Generic[R]):
    """A part of any kind that repeats what the test gives it, as drivers do."""

    def __init__(self, reading: R | None = None) -> None:
        self.reading = reading

    def read(self) -> R | None:
        return self.reading

    def close(self) -> None:
        """Nothing to let go."""


class Ranger:
    """A sonar whose pings the test sets."""

    def __init__(self) -> None:
        self.pings: list[SonarReading] = []
        self.sectors: list[tuple[float, float]] = []

    def read(self) -> Sequence[SonarReading]:
        pings, self.pings = self.pings, []
        return pings

    def set_sector(self, port_rad: float, starboard_rad: float) -> None:
        self.sectors.append((port_rad, starboard_rad))

    def close(self) -> None:
        """Nothing to let go."""


class Motors:
    """Motors that nobody turns."""

    def write(self, left: float, right: float) -> None:
        """Nothing turns."""

    def stop(self) -> None:
        """Nothing turns."""

    def close(self) -> None:
        """Nothing to let go."""


def suite_of(external: ExternalSensors | None = None, **parts: object) -> SensorSuite:
    """A suite over these parts; receiver and compass say nothing unless given."""
    fitted: dict[str, object] = {"motors": Motors(), "gnss": Part(), "compass": Part(), **parts}
    return SensorSuite(Hardware(**fitted), external or ExternalSensors(NO_EXTERNAL))  # type: ignore[arg-type]


def test_the_readings_of_a_tick_are_those_of_the_parts_until_they_are_stale() -> None:
    compass = Part(HeadingReading(1.0, 0.5, yaw_rate_rad_s=0.1))
    suite = suite_of(gnss=Part(replace(GOOD_FIX, time_s=1.0)), compass=compass)
    suite.read(CONFIG, 1.0)
    assert suite.fix is not None
    assert suite.is_fix_own
    assert (suite.compass, suite.heading) == (compass.reading, compass.reading)
    suite.read(CONFIG, 1.0 + CONFIG.parts.compass.silence_s + 0.01)
    assert (suite.compass, suite.heading) == (None, None)
    assert suite.fix is not None
    suite.read(CONFIG, 1.0 + CONFIG.parts.gnss.timeout_s + 0.01)
    assert suite.fix is None


@pytest.mark.parametrize(("rate_rad_s", "has_gyro"), [(0.0, True), (None, False)])
def test_a_gyro_is_known_by_its_first_rate(rate_rad_s: float | None, has_gyro: bool) -> None:
    compass = Part[HeadingReading]()
    suite = suite_of(compass=compass)
    suite.read(CONFIG, 1.0)
    assert not suite.has_gyro
    compass.reading = HeadingReading(1.1, 0.0, rate_rad_s)
    suite.read(CONFIG, 1.1)
    assert suite.has_gyro is has_gyro
    suite.read(CONFIG, 20.0)
    assert suite.has_gyro is has_gyro, "a part that has measured is remembered"


def test_a_heading_is_trimmed_towards_true_north_and_its_rate_freed_of_bias() -> None:
    north = HeadingReading(3.0, 0.2, 0.05)
    assert trimmed(None, Trim(heading_rad=0.1)) is None
    assert trimmed(north, Trim()) is north
    assert trimmed(north, Trim(), declination_rad=0.3) is north, "its north is true"
    turned = trimmed(north, Trim(heading_rad=0.1, gyro_bias_rad_s=0.02))
    assert turned is not None
    assert turned.time_s == 3.0
    assert turned.heading_rad == pytest.approx(0.3)
    assert turned.yaw_rate_rad_s == pytest.approx(0.03)
    biased = trimmed(north, Trim(gyro_bias_rad_s=-0.02))
    assert biased is not None
    assert biased.yaw_rate_rad_s == pytest.approx(0.07)
    magnetic = trimmed(replace(north, is_magnetic=True, yaw_rate_rad_s=None), Trim(), declination_rad=0.3)
    assert magnetic is not None
    assert magnetic.heading_rad == pytest.approx(0.5)
    assert magnetic.yaw_rate_rad_s is None


def test_the_first_voltage_tells_of_a_wrong_number_of_cells_once() -> None:
    battery = Part(BatteryReading(1.0, 14.8))
    suite = suite_of(battery=battery)
    assert suite.has_battery_monitor
    assert not suite_of().has_battery_monitor
    suite.read(CONFIG, 1.0)
    wrong = StatusText(Severity.WARNING, "Battery: 14.8 V does not fit 3 cells, but 4")
    assert suite.notices == [wrong]
    battery.reading = BatteryReading(1.1, 14.8)
    suite.read(CONFIG, 1.1)
    assert suite.notices == []


def test_a_repeated_reading_of_the_battery_is_not_counted_again() -> None:
    battery = Part(BatteryReading(1.0, 12.0, 36.0))
    suite = suite_of(battery=battery)
    suite.read(CONFIG, 1.0)
    battery.reading = BatteryReading(2.0, 12.0, 36.0)
    suite.read(CONFIG, 2.0)
    assert suite.consumed_mah == pytest.approx(10.0)
    suite.read(CONFIG, 2.1)
    assert suite.consumed_mah == pytest.approx(10.0)


def test_a_magnetometer_is_corrected_for_the_load_of_both_motors_and_the_current() -> None:
    field = FieldCorrector()
    suite = suite_of(field=field, battery=Part(BatteryReading(1.0, 12.0, 4.0)))
    suite.read(CONFIG, 1.0, MotorCommand(0.4, -0.8))
    assert field.load.throttle == pytest.approx(0.6)
    assert field.load.current_a == 4.0
    alone = suite_of(field=field)
    alone.read(CONFIG, 1.0, MotorCommand(1.0, 1.0))
    assert [field.load.throttle, field.load.current_a] == [1.0, None]


def calibrated(reading: HeadingReading | None) -> SensorSuite:
    """A bare magnetometer in a field of 180 mG to the north and 450 mG down."""
    field = FieldCorrector()
    field.correction = MagneticCorrection(offset=(10.0, 0.0, 0.0))
    suite = suite_of(field=field)
    suite.compass = reading
    suite.earth.field = EarthField(0.0, 180.0, 450.0)
    return suite


def measured(level_mg: float) -> HeadingReading:
    return HeadingReading(1.0, 0.0, field_mg=(level_mg - 10.0, 0.0, 450.0), is_magnetic=True)


@pytest.mark.parametrize(
    ("level_mg", "is_trusted"), [(107.0, False), (109.0, True), (180.0, True), (269.0, True), (271.0, False)]
)
def test_a_field_that_is_not_the_earths_is_named(level_mg: float, is_trusted: bool) -> None:
    fault = calibrated(measured(level_mg)).compass_fault()
    expected = f"field of {level_mg:.0f} mG, not 180: iron near, or calibrate again"
    assert fault == ("" if is_trusted else expected)


def test_a_field_is_judged_on_the_level_however_the_boat_lies() -> None:
    heeled = replace(measured(180.0), roll_rad=math.pi / 2.0, field_mg=(170.0, 450.0, 0.0))
    assert calibrated(heeled).compass_fault() == ""
    pitched = replace(measured(180.0), pitch_rad=math.pi / 2.0, field_mg=(-460.0, 0.0, 180.0))
    assert calibrated(pitched).compass_fault() == ""
    assert calibrated(replace(heeled, roll_rad=0.0)).compass_fault() != ""


def test_only_a_bare_magnetometer_in_use_is_judged() -> None:
    assert suite_of().compass_fault() == ""
    assert calibrated(None).compass_fault() == ""
    assert calibrated(HeadingReading(1.0, 0.0)).compass_fault() == "", (
        "another part measures, it is in reserve"
    )
    assert calibrated(replace(measured(300.0), field_mg=None)).compass_fault() == ""
    unknown = calibrated(measured(300.0))
    unknown.earth.field = None
    assert unknown.compass_fault() == ""
    fresh = calibrated(None)
    assert fresh.field is not None
    fresh.field.correction = MagneticCorrection()
    assert fresh.compass_fault() == "not calibrated: start its calibration and turn the boat"


def test_the_declination_is_the_models_where_it_is_asked_for() -> None:
    suite = calibrated(None)
    suite.earth.field = EarthField(0.1, 180.0, 450.0)
    assert suite.declination_rad(CompassPart(declination_rad=0.3)) == 0.3
    asked = CompassPart(auto_declination=True, declination_rad=0.3)
    assert suite.declination_rad(asked) == 0.1
    assert suite_of().declination_rad(asked) == 0.0
    assert suite.uses_earth_field(CompassPart())
    assert suite_of().uses_earth_field(asked)
    assert not suite_of().uses_earth_field(CompassPart())


def test_probes_are_looked_at_ten_times_a_second() -> None:
    probe = Part(ProbeReading(1.0, "ph", 7.0))
    config = replace(CONFIG, probe=(ProbePart(name="ph", driver="file", path="/x", timeout_s=2.0),))
    suite = suite_of(probes=(probe,))
    suite.read(config, 1.0)
    first, probe.reading = probe.reading, ProbeReading(1.02, "ph", 7.1)
    suite.read(config, 1.0 + 0.5 * READ_S)
    assert suite.probes == [first]
    suite.read(config, 1.0 + READ_S)
    assert suite.probes == [probe.reading]
    suite.read(config, 3.2)
    assert suite.probes == []
    assert suite.notices == [StatusText(Severity.WARNING, "Probe ph is silent")]


def latest(suite: SensorSuite) -> SonarReading | None:
    return suite.sonar


def test_pings_are_those_of_one_tick_and_external_ones_bring_their_beam() -> None:
    ranger, external = Ranger(), ExternalSensors(NO_EXTERNAL)
    suite = suite_of(external, sonar=ranger)
    own, other = SonarReading(1.0, 0.0, 2.0), SonarReading(1.0, 0.5, 3.0)
    ranger.pings = [own]
    external.pings.append((other, 0.2))
    assert suite.is_sonar_fitted
    assert not suite_of().is_sonar_fitted
    suite.read(CONFIG, 1.0)
    assert suite.pings == [(own, None), (other, 0.2)]
    assert latest(suite) is own
    assert suite.sweep.latest is other
    suite.read(CONFIG, 1.02)
    assert suite.pings == []
    assert latest(suite) is own
    suite.read(CONFIG, 1.1 + CONFIG.failsafe.sonar_timeout_s)
    assert latest(suite) is None
    assert suite.has_sonar


def test_a_lidars_sectors_are_pings_of_five_degrees_beside_those_of_the_sonar() -> None:
    ranger, lidar = Ranger(), Ranger()
    suite = suite_of(sonar=ranger, lidar=lidar)
    ping, sector = SonarReading(1.0, 0.0, 2.0), SonarReading(1.0, 0.5, 3.0)
    ranger.pings, lidar.pings = [ping], [sector]
    suite.read(CONFIG, 1.0)
    assert suite.pings == [(ping, None), (sector, math.radians(5.0))]
    assert (suite.lidar, suite.has_lidar) == (sector, True)
    suite.read(CONFIG, 1.1 + CONFIG.failsafe.sonar_timeout_s)
    assert (suite.lidar, suite.has_lidar) == (None, True)
    assert suite_of(lidar=lidar).is_sonar_fitted


def test_a_lidar_that_never_measures_is_silent_a_few_seconds_after_the_start() -> None:
    suite = suite_of(lidar=Ranger())
    suite.read(CONFIG, 1.0)
    suite.read(CONFIG, 1.1 + SONAR_START_S)
    assert suite.notices == [StatusText(Severity.WARNING, "Lidar is silent")]


def test_a_sonar_that_never_pings_is_silent_a_few_seconds_after_the_start() -> None:
    suite = suite_of(sonar=Ranger())
    suite.read(CONFIG, 1.0)
    suite.read(CONFIG, 1.0 + SONAR_START_S)
    assert suite.notices == []
    suite.read(CONFIG, 1.1 + SONAR_START_S)
    assert suite.notices == [StatusText(Severity.WARNING, "Sonar is silent")]


def test_a_sonar_is_told_its_sector_when_that_changes() -> None:
    ranger = Ranger()
    suite = suite_of(sonar=ranger)
    for sector in (Sector(-0.5, 0.5), Sector(-0.5, 0.5), Sector(0.0, 1.0)):
        suite.point_sonar(sector)
    assert ranger.sectors == [(-0.5, 0.5), (0.0, 1.0)]
    suite_of().point_sonar(Sector(0.0, 1.0))  # no sonar: nothing to point


class Pausing(Part[HeadingReading]):
    may_pause = False


@pytest.mark.parametrize(
    ("command", "may_pause"),
    [(MotorCommand(0.0, 0.0), True), (MotorCommand(0.1, 0.0), False), (MotorCommand(0.0, -0.1), False)],
)
def test_a_compass_may_pause_while_both_motors_stand(command: MotorCommand, may_pause: bool) -> None:
    compass = Pausing()
    suite_of(compass=compass).read(CONFIG, 1.0, command)
    assert compass.may_pause is may_pause


def test_parts_without_a_timeout_of_their_own_have_that_of_their_driver() -> None:
    late = Part(HeadingReading(1.0, 0.0))
    nmea = replace(CONFIG, parts=Parts(compass=CompassPart(driver="nmea")))
    suite = suite_of(compass=late)
    suite.read(nmea, 2.4)
    assert suite.compass is late.reading
    suite.read(CONFIG, 2.4)
    assert suite.compass is None


FAR = LatLon(ORIGIN.lat_deg + 5.0, ORIGIN.lon_deg)


class Located:
    """An estimator that says how far its fixes lie beyond its frame."""

    def __init__(self, frame: LocalFrame | None, far_m: float = 0.0) -> None:
        self.frame = frame
        self.preset_frame: LocalFrame | None = None
        self.far_m = far_m
        self.resets = 0

    def reset_origin(self) -> None:
        self.resets += 1


def preset(estimator: Located) -> LocalFrame | None:
    return estimator.preset_frame


def monitor(estimator: Located, external: ExternalSensors) -> OriginMonitor:
    return OriginMonitor(estimator, external)  # type: ignore[arg-type]


def test_the_frame_is_shared_by_the_boat_and_external_poses() -> None:
    external = ExternalSensors(NO_EXTERNAL)
    estimator = Located(None)
    monitor(estimator, external).share_frame()
    assert preset(estimator) is None
    external.frame = FRAME
    monitor(estimator, external).share_frame()
    assert preset(estimator) is FRAME
    located, other = Located(LocalFrame(FAR)), ExternalSensors(NO_EXTERNAL)
    monitor(located, other).share_frame()
    assert other.frame is located.frame
    monitor(Located(FRAME), other).share_frame()
    assert other.frame is located.frame, "a frame that is known stays"


def test_an_origin_moves_with_a_disarmed_boat_and_an_armed_one_is_warned_once_a_time() -> None:
    external = ExternalSensors(NO_EXTERNAL)
    external.frame = FRAME
    estimator = Located(FRAME)
    origin, texts = monitor(estimator, external), list[tuple[int, str]]()

    def check(armed: bool, far_m: float) -> float:
        estimator.far_m = far_m
        return origin.check(armed, lambda severity, text: texts.append((severity, text)))

    warning = (Severity.WARNING, "GPS: 60 km from where the boat was, not used until disarmed")
    assert [check(True, far_m) for far_m in (0.0, 60e3, 60e3, 0.0, 60e3)] == [0.0] * 5
    assert texts == [warning, warning]
    assert [external.frame, estimator.resets] == [FRAME, 0]
    assert check(False, 0.0) == 0.0
    assert estimator.resets == 0
    assert check(False, 60e3) == 60e3
    assert [external.frame, estimator.resets] == [None, 1]
    assert texts == [warning, warning]
    external.frame = LocalFrame(FAR)
    assert check(False, 60e3) == 60e3
    assert external.frame is not None, "a frame of its own"
    assert check(True, 60e3) == 0.0
    assert texts == [warning] * 3


def test_a_real_estimator_has_no_frame_before_its_first_fix() -> None:
    external, estimator = ExternalSensors(NO_EXTERNAL), Estimator()
    external.frame = FRAME
    OriginMonitor(estimator, external).share_frame()
    assert estimator.preset_frame is FRAME


def test_an_external_fix_takes_the_place_of_a_receiver_that_is_silent() -> None:
    external = ExternalSensors(NO_EXTERNAL)
    external.fix = replace(GOOD_FIX, time_s=9.0)
    asked = replace(CONFIG, external=External(position=1))
    gnss = Part[GnssFix](replace(GOOD_FIX, time_s=9.0))
    suite = suite_of(external, gnss=gnss)
    suite.read(asked, 9.0)
    assert suite.is_fix_own
    gnss.reading = None
    suite.read(asked, 9.0)
    assert suite.fix is external.fix
    assert not suite.is_fix_own
