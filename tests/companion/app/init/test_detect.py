"""`boat-companion init --detect` writes the parts that it has found, and says what it left out."""

import os
from pathlib import Path

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink
from test_detect_i2c import part_of
from test_detect_serial import CRSF
from twins.i2c import I2cDev, plug_in
from twins.rangers import tfmini_frame
from twins.serial_ports import RMC, Device, SerialBench, every_s, plug_in_ports, receiver
from twins.ubx_messages import sentence
from twins.ubx_receiver import NEO_M8N

from companion.app.cli import run_program
from companion.app.init.presets import preset_text, with_values
from companion.app.init.serial_parts import find_serial_parts
from companion.app.process import only_program
from companion.config.boat_config import BoatConfig, load_config

REFUSED = ["init", "--preset", "lake", "--detect", "--yes", "--output", os.devnull, "--force"]


@pytest.fixture
def dev(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> I2cDev:
    dev = plug_in(monkeypatch, tmp_path, {})
    (tmp_path / "dev/i2c-3").unlink()
    return dev


@pytest.fixture
def bench(dev: I2cDev, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> SerialBench:
    bench = plug_in_ports(monkeypatch, tmp_path)
    monkeypatch.setattr(
        "companion.app.init.questions.find_serial_parts",
        lambda: find_serial_parts(bench.clock, bench.wait),
    )
    return bench


def written(tmp_path: Path, *options: str) -> BoatConfig:
    path = tmp_path / "boat.toml"
    assert run_program(["init", "--preset", "lake", "--detect", "--output", str(path), *options]) == 0
    assert run_program(["check", "--config", str(path)]) == 0
    return load_config(path)


def test_what_is_found_is_written_and_passes_the_check(
    bench: SerialBench, dev: I2cDev, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    bench.plug_in("ttyUSB0", receiver(NEO_M8N), "serial/by-id/usb-u-blox")
    bench.plug_in("ttyUSB1", Device(115_200, every_s(0.01, tfmini_frame(300))))
    dev.parts = {
        0x0D: part_of("qmc5883l"),
        0x45: part_of("ina226"),
        0x68: part_of("mpu6050"),
        0x41: part_of("pca9685"),
    }
    bench.plug_in("ttyAMA4", Device(420_000, every_s(0.02, CRSF)))
    config = written(tmp_path, "--yes")
    assert (config.rc.driver, config.rc.port) == ("crsf", "/dev/ttyAMA4")
    parts = config.parts
    assert (parts.gnss.driver, parts.gnss.port) == ("ubx", "/dev/serial/by-id/usb-u-blox")
    assert (parts.sonar.driver, parts.sonar.port) == ("tfmini", "/dev/ttyUSB1")
    assert (parts.compass.driver, parts.compass.imu) == ("qmc5883l", "mpu6050")
    assert (parts.battery.driver, parts.battery.address, parts.battery.shunt_ohm) == ("ina226", 0x45, 0.002)
    assert parts.pca9685.address == 0x41
    assert "address = 0x45" in (tmp_path / "boat.toml").read_text(encoding="utf-8")
    said = capsys.readouterr().out
    assert "parts.compass.driver qmc5883l, 0xd on I²C bus 1" in said
    assert "left out" not in said
    assert "fine; parts motors l298n, gnss ubx, compass qmc5883l, sonar tfmini, battery ina226" in said


def test_with_nothing_connected_it_is_the_preset(
    bench: SerialBench, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    written(tmp_path, "--yes")
    assert (tmp_path / "boat.toml").read_text(encoding="utf-8") == preset_text("lake")
    assert "not found, as in the preset: parts.compass.driver bno055" in capsys.readouterr().out
    assert bench.written == []


def test_of_two_for_one_use_the_first_is_taken_and_the_other_told(
    bench: SerialBench, dev: I2cDev, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    bench.plug_in("ttyUSB0", Device(9600, every_s(1.0, RMC)))
    bench.plug_in("ttyUSB1", receiver(NEO_M8N))
    dev.parts = {0x0D: part_of("qmc5883l"), 0x29: part_of("bno055")}
    parts = written(tmp_path, "--yes").parts
    assert (parts.gnss.driver, parts.gnss.port) == ("ubx", "/dev/ttyUSB1")
    assert (parts.compass.driver, parts.compass.address) == ("bno055", 0x29)
    said = capsys.readouterr().out
    assert (
        "left out: parts.compass.driver qmc5883l, 0xd on I²C bus 1; taken: parts.compass.driver bno055"
        in said
    )
    assert "left out: parts.gnss.driver nmea" in said


def test_a_sure_part_comes_before_one_that_is_not(bench: SerialBench, dev: I2cDev, tmp_path: Path) -> None:
    bench.plug_in("ttyUSB0", Device(9600, every_s(1.0, RMC + sentence("GNHDT,91.0,T"))))
    dev.parts = {0x28: part_of("bno055")}
    assert written(tmp_path, "--yes").parts.compass.driver == "bno055"


@pytest.mark.parametrize("has_another", [False, True])
def test_the_depth_of_a_receivers_line_goes_with_that_receiver(
    has_another: bool, bench: SerialBench, tmp_path: Path
) -> None:
    bench.plug_in("ttyUSB0", Device(9600, every_s(1.0, RMC + sentence("SDDPT,2.1,0.3"))))
    if has_another:
        bench.plug_in("ttyUSB1", receiver(NEO_M8N))
    parts = written(tmp_path, "--yes").parts
    assert (parts.gnss.driver, parts.depth.driver) == (("ubx", "none") if has_another else ("nmea", "gnss"))


def test_an_autopilot_that_is_accepted_passes_the_check(
    bench: SerialBench, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def reply(text: str, default: str) -> str:
        return "yes" if text.startswith("take parts.autopilot") else default

    monkeypatch.setattr("companion.app.init.questions.ask", reply)
    beat = mavlink.MAVLink_heartbeat_message(10, 3, 0, 0, 4, 3).pack(
        mavlink.MAVLink(None, srcSystem=1, srcComponent=1)
    )
    bench.plug_in("ttyACM0", Device(115_200, every_s(1.0, beat)))
    parts = written(tmp_path).parts
    assert parts.autopilot == "serial:/dev/ttyACM0:115200"
    assert parts.motors.driver == "l298n"


@pytest.mark.parametrize(("answer", "driver"), [("yes", "ads1115"), ("no", "ina219")])
def test_a_part_that_is_not_sure_is_asked_for_and_then_the_default(
    answer: str, driver: str, dev: I2cDev, bench: SerialBench, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def reply(text: str, default: str) -> str:
        return answer if text.startswith("take parts.battery.driver ads1115") else default

    monkeypatch.setattr("companion.app.init.questions.ask", reply)
    dev.parts = {0x48: part_of("ads1115")}
    assert written(tmp_path).parts.battery.driver == driver
    assert bench.written == []


def test_with_yes_a_part_that_is_not_sure_is_left_out(
    bench: SerialBench, dev: I2cDev, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    dev.parts = {0x48: part_of("ads1115")}
    assert written(tmp_path, "--yes").parts.battery.driver == "ina219"
    assert "left out: parts.battery.driver ads1115, 0x48 on I²C bus 1: not sure" in capsys.readouterr().out
    assert bench.written == []


def test_a_running_boat_keeps_its_parts(
    bench: SerialBench, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    bench.plug_in("ttyUSB0", receiver(NEO_M8N))
    monkeypatch.setattr("companion.app.init.questions.running_boat", lambda _: object())
    assert run_program(REFUSED) != 0
    assert "sudo systemctl stop mavboat" in capsys.readouterr().err
    assert bench.clock() == bench.began_s


def test_a_boat_that_another_program_runs_is_left_alone(
    bench: SerialBench, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    state = tmp_path / "state"
    state.mkdir()
    text = with_values(preset_text("lake"), {"storage.folder": str(state)})
    monkeypatch.setattr("companion.app.init.questions.preset_text", lambda *_: text)
    with only_program(str(state)):
        assert (
            run_program(["init", "--preset", "lake", "--detect", "--yes", "--output", os.devnull, "--force"])
            != 0
        )
    assert "another program runs this boat" in capsys.readouterr().err
    assert bench.clock() == bench.began_s
