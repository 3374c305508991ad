"""BNO055 and INA219 by their registers, through the real smbus2."""

import math
from pathlib import Path

import pytest
from twins.battery import Ina219Twin
from twins.i2c import AMG, CONFIG, NDOF, Bno055Twin, I2cDev, plug_in
from twins.lines import HandClock, known

from companion.config.actuators import Pca9685Part, PulseOutputSetting
from companion.config.sensors import BatteryPart, CompassPart, ProbePart
from companion.core.errors import HardwareError
from companion.core.generations import ProfileFile
from companion.hal.battery import open_battery_monitor
from companion.hal.heading.bno055 import Bno055, Bno055Compass, open_bno055
from companion.hal.heading.magnetic_compass import open_magnetic_compass
from companion.hal.probes import open_analog_probe
from companion.hal.pulses.pca9685 import open_pca9685_pulses, replace_pca9685_pulses
from companion.hal.raspberry_pi import I2cBus, import_optional
from companion.sensors.compass.magnetic_field import FieldCorrector

COMPASS, BATTERY = CompassPart(driver="bno055"), BatteryPart(driver="ina219")


@pytest.fixture
def chip() -> Bno055Twin:
    return Bno055Twin()


@pytest.fixture
def dev(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, chip: Bno055Twin) -> I2cDev:
    return plug_in(monkeypatch, tmp_path, {0x28: chip, 0x40: Ina219Twin(HandClock())})


def steps(compass: Bno055Compass, count: int) -> None:
    for _ in range(count):
        assert 0.0 < compass.step() < 0.1


def test_heading_and_rate_are_clockwise_and_corrected(bus: I2cBus, clock: HandClock) -> None:
    compass = Bno055Compass(Bno055(bus), clock, correction_rad=math.radians(-3.0))
    assert compass.read() is None
    steps(compass, 3)
    reading = known(compass.read())
    assert reading.time_s == clock()
    assert math.degrees(reading.heading_rad) == pytest.approx(87.0, abs=0.02)
    assert reading.yaw_rate_rad_s == pytest.approx(math.radians(10.0), abs=1e-3)
    assert reading.roll_rad == pytest.approx(math.radians(1.0), abs=2e-4)
    assert reading.pitch_rad == pytest.approx(math.radians(-2.0), abs=2e-4)


def test_a_part_that_has_just_been_switched_on_is_set_up(bus: I2cBus, chip: Bno055Twin) -> None:
    part = Bno055(bus)
    assert part.read() is None
    part.set_up()
    assert (chip.mode, chip.units, chip.page, chip.power) == (NDOF, 0x80, 0, 0)
    assert part.read() is not None


def test_a_part_in_another_programs_mode_and_units_is_set_up_through_configuration_mode(
    bus: I2cBus, chip: Bno055Twin
) -> None:
    chip.mode, chip.units = AMG, 0x06  # raw values, radians
    part = Bno055(bus)
    assert part.read() is None
    part.set_up()
    assert chip.mode == CONFIG
    part.set_up()
    sample = known(part.read())
    assert sample.rate[2] == pytest.approx(math.radians(-10.0), abs=1e-3)


def test_a_program_that_starts_again_keeps_what_the_part_has_learned(bus: I2cBus, chip: Bno055Twin) -> None:
    chip.mode = NDOF
    compass = Bno055Compass(Bno055(bus), HandClock())
    steps(compass, 2)
    assert compass.read() is not None
    assert chip.resets == 0


def test_no_heading_counts_before_the_magnetometer_is_calibrated(bus: I2cBus, chip: Bno055Twin) -> None:
    chip.magnet = 0
    compass = Bno055Compass(Bno055(bus), HandClock())
    steps(compass, 5)
    assert compass.read() is None
    chip.magnet = 1
    steps(compass, 2)
    assert compass.read() is not None
    chip.magnet, chip.heading_deg = 0, 180.0
    steps(compass, 1)
    reading = known(compass.read())
    assert abs(reading.heading_rad) == pytest.approx(math.pi, abs=2e-4)


def test_a_part_whose_supply_dipped_is_set_up_again_and_must_find_north_again(
    bus: I2cBus, chip: Bno055Twin, clock: HandClock
) -> None:
    compass = Bno055Compass(Bno055(bus), clock)
    steps(compass, 3)
    before = compass.read()
    chip.power_up()
    chip.magnet, chip.heading_deg = 0, 0.0
    clock.advance(1.0)
    steps(compass, 5)
    assert chip.mode == NDOF
    assert compass.read() is before
    assert [one.text for one in compass.take_texts()] == [
        "Compass: BNO055 was reset: it must find north again"
    ]
    chip.magnet = 2
    steps(compass, 2)
    after = known(compass.read())
    assert after.time_s == clock()


def test_an_orientation_with_a_wrong_bit_is_ignored(bus: I2cBus, chip: Bno055Twin) -> None:
    chip.heading_deg = 40.0
    compass = Bno055Compass(Bno055(bus), HandClock())
    steps(compass, 3)
    before = compass.read()
    for bit in range(5, 8):  # the upper ones of QUA_Data_w
        chip.flips = bytes(one == 0x21 and 1 << bit for one in range(0x80))
        steps(compass, 1)
    assert compass.read() is before


def test_a_part_of_another_kind_is_told_in_one_line(dev: I2cDev) -> None:
    dev.parts = {0x28: Bno055Twin(chip_id=0x55), 0x40: Bno055Twin()}
    with pytest.raises(HardwareError, match="BNO055: the part at I²C address 0x28 says 0x55, not 0xa0"):
        open_bno055(COMPASS, HandClock())
    dev.parts[0x40] = dev.parts[0x28]
    with pytest.raises(HardwareError, match="INA219: the part at I²C address 0x40 is not an INA219"):
        open_battery_monitor(BATTERY, HandClock())


def test_a_pi_without_i2c_is_told_how_to_switch_it_on(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr("companion.hal.raspberry_pi.ROOT", tmp_path)
    with pytest.raises(HardwareError, match=r"BNO055: there is no .*i2c-1; .* raspi-config nonint do_i2c 0"):
        open_bno055(COMPASS, HandClock())


def test_each_part_opens_the_bus_that_it_is_on(monkeypatch: pytest.MonkeyPatch) -> None:
    opened: list[str] = []

    def refuse(device: str) -> None:
        opened.append(device)
        raise FileNotFoundError(2, "No such file or directory")

    monkeypatch.setattr("smbus2.SMBus", refuse)
    clock = HandClock()
    chip, magnetometer = Pca9685Part(i2c_bus=4), CompassPart(driver="lis3mdl", i2c_bus=5)
    for open_part in (
        lambda: open_bno055(CompassPart(driver="bno055", i2c_bus=3), clock),
        lambda: open_battery_monitor(BatteryPart(driver="ina219", i2c_bus="/dev/i2c-7"), clock),
        lambda: open_pca9685_pulses(PulseOutputSetting(output="pca9685"), chip),
        lambda: replace_pca9685_pulses(0, 0.0, chip),
        lambda: open_magnetic_compass(magnetometer, clock, FieldCorrector()),
        lambda: open_analog_probe(ProbePart(name="ph", driver="ads1115", i2c_bus=6), clock),
    ):
        with pytest.raises(HardwareError, match=r"there is no /dev/i2c-\d; add its line to config.txt"):
            open_part()
    assert opened == [f"/dev/i2c-{bus}" for bus in (3, 7, 4, 4, 5, 6)]


@pytest.mark.parametrize(
    "fault",
    [
        'RuntimeError("The gpiod library is not installed\\n  see the manual")',
        "AttributeError",
    ],
)
def test_a_library_that_does_not_load_is_one_line_that_names_the_part_and_the_cure(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, fault: str
) -> None:
    (tmp_path / "moody_library.py").write_text(f"raise {fault}\n", encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    with pytest.raises(HardwareError) as caught:
        import_optional("moody_library", "BNO055")
    text = str(caught.value)
    assert text.startswith("BNO055: the Python module 'moody_library' does not load on this machine (")
    assert text.endswith("reinstall the extra pi, or set the part's driver to none")
    assert "\n" not in text


LEARNED = bytes(range(1, 23))


@pytest.fixture
def kept(tmp_path: Path) -> ProfileFile:
    return ProfileFile(tmp_path / "state" / "bno055.profile")


def learn(bus: I2cBus, chip: Bno055Twin, kept: ProfileFile) -> Bno055Compass:
    """A part that has calibrated itself while the boat was at rest, and was given the time to save it."""
    compass = Bno055Compass(Bno055(bus), HandClock(), profile=kept)
    steps(compass, 3)
    chip.profile = LEARNED
    compass.may_pause = True
    steps(compass, 260)
    return compass


def test_a_good_calibration_is_kept_and_given_back_after_a_power_cut(
    bus: I2cBus, chip: Bno055Twin, kept: ProfileFile
) -> None:
    learn(bus, chip, kept)
    assert kept.load() == LEARNED
    chip.power_up()
    compass = Bno055Compass(Bno055(bus), HandClock(), profile=kept)
    steps(compass, 3)
    assert chip.profile == LEARNED
    assert chip.mode == NDOF
    assert compass.read() is not None


def test_the_calibration_is_not_read_under_way_nor_before_it_is_good(
    bus: I2cBus, chip: Bno055Twin, kept: ProfileFile
) -> None:
    compass = Bno055Compass(Bno055(bus), HandClock(), profile=kept)
    steps(compass, 2)
    chip.profile = LEARNED
    steps(compass, 600)
    assert kept.load() == b""
    chip.magnet, compass.may_pause = 2, True
    steps(compass, 600)
    assert kept.load() == b""


def test_a_damaged_profile_is_not_given_to_the_part(
    bus: I2cBus, chip: Bno055Twin, kept: ProfileFile, tmp_path: Path
) -> None:
    kept.save(LEARNED)
    path = tmp_path / "state" / "bno055.profile"
    path.write_bytes(path.read_bytes()[:-3])  # cut off in the middle of a write
    assert kept.load() == b""
    compass = Bno055Compass(Bno055(bus), HandClock(), profile=kept)
    steps(compass, 3)
    assert chip.profile == bytes(22)
    kept.save(LEARNED)
    kept.save(LEARNED[::-1])
    path.write_bytes(b"")
    assert kept.load() == LEARNED
