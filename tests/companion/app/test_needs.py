"""No two parts on one pin, signal, device or address; each pin does what it is used for."""

import tomllib
from pathlib import Path

import pytest

from companion.app.needs import Needs, check_needs, check_ports
from companion.config.boat_config import decode_config
from companion.core.errors import ConfigError

PI_4, PI_5 = "Raspberry Pi 4 Model B Rev 1.4", "Raspberry Pi 5 Model B Rev 1.0"
BRIDGE, ESC = "parts.motors.driver='l298n'", "parts.motors.driver='esc'"
OE = "parts.pca9685.output_enable=22"
HULL = "parts.hull={driver='host', leak=%d}"
TFMINI = "parts.sonar={driver='tfmini', port='%s'}"
RECEIVER = "parts.gnss={driver='nmea', port='/dev/serial0'}"
SERVO = "{kind='servo', number=5, signal={output='pca9685', channel=3}}"
LAST_PULSE = "goes on with its last pulse .* parts.pca9685.output_enable"


def check(*lines: str, model: str = PI_4) -> None:
    check_needs(decode_config(tomllib.loads("\n".join(lines)), "test"), model)


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        (
            ("parts.compass={driver='ist8308', imu='icm20948'}",),
            "parts.compass.imu: 0xc on I²C belongs to parts.compass.address, ist8308",
        ),
        ((BRIDGE, "parts.motors.right_enable=5"), r"right_enable: GPIO 5 belongs to .*left_forward"),
        (
            (BRIDGE, "parts.sonar={driver='tfmini', servo=12}"),
            "parts.sonar.servo: GPIO 12 belongs to parts.motors.left_enable",
        ),
        (
            ("parts.sonar.driver='hcsr04'", HULL % 24),
            "parts.hull.leak: GPIO 24 belongs to parts.sonar.echo",
        ),
        (
            (ESC, "payload=[{kind='light', number=0, pin=12}]"),
            r"payload\[0\].pin: GPIO 12 belongs to parts.motors.left",
        ),
        (
            (ESC, OE, "parts.motors.left={output='pca9685', channel=3}", f"payload=[{SERVO}]"),
            r"payload\[0\].signal: channel 3 of the PCA9685 belongs to parts.motors.left",
        ),
        (
            ("parts.autopilot='serial:/dev/serial0:57600'", RECEIVER),
            "parts.autopilot: /dev/serial0 belongs to parts.gnss.port",
        ),
        ((ESC, "parts.motors.right.output='pca9685'"), f"parts.motors.right: .* {LAST_PULSE}"),
        (
            (ESC, "payload=[{kind='winch', signal={output='pca9685'}}]"),
            rf"payload\[0\].signal: .* {LAST_PULSE}",
        ),
        ((ESC, "payload=[{kind='winch'}]"), r"payload\[0\].signal.pin: expected the number of a pin"),
        (
            (ESC, "parts.motors.left.pin=5"),
            "parts.motors.left: GPIO 5 has no hardware PWM; expected 12, 13, 18 or 19",
        ),
        (
            (ESC, "parts.motors.right.pin=18"),
            "parts.motors.right: GPIO 18 shares a PWM channel with parts.motors.left, GPIO 12",
        ),
        (
            (BRIDGE, "parts.motors.left_forward=2", "parts.compass.driver='bno055'"),
            "parts.motors.left_forward: GPIO 2 belongs to parts.compass, /dev/i2c-1",
        ),
        (
            (BRIDGE, "parts.motors.left_forward=14", RECEIVER),
            "parts.motors.left_forward: GPIO 14 belongs to parts.gnss.port, /dev/serial0",
        ),
        (
            (RECEIVER, TFMINI % "/dev/ttyAMA0"),
            "parts.sonar.port: GPIO 14 belongs to parts.gnss.port, /dev/serial0",
        ),
        (
            (RECEIVER, "parts.lidar={driver='ld06', port='/dev/ttyAMA0'}"),
            "parts.lidar.port: GPIO 14 belongs to parts.gnss.port, /dev/serial0",
        ),
        (
            (BRIDGE, TFMINI % "/dev/ttyAMA5"),
            "parts.motors.left_enable: GPIO 12 belongs to parts.sonar.port, /dev/ttyAMA5",
        ),
        (("parts.ais={driver='nmea', port='ttyACM0'}",), "parts.ais.port: port 'ttyACM0': expected udpin"),
        (("parts.ais={driver='nmea', port='upd::10110'}",), "parts.ais.port: .* unknown kind 'upd'"),
        (
            ("parts.motors={driver='esc', telemetry='kiss', right_port=''}",),
            "parts.motors.right_port: port '': expected",
        ),
        (
            (
                "parts.lidar={driver='ld06', port='/dev/ttyUSB3'}",
                "parts.ais={driver='nmea', port='serial:/dev/ttyUSB3:38400'}",
            ),
            "parts.ais.port: /dev/ttyUSB3 belongs to parts.lidar.port",
        ),
    ],
)
def test_what_is_used_twice_or_cannot_be_names_its_keys(lines: tuple[str, ...], message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        check(*lines)


@pytest.mark.parametrize(
    "lines",
    [
        (),
        (ESC, "parts.rudder.driver='servo'", "drive.layout='rudder'"),  # no right motor
        (
            "parts.motors={driver='drv8833', left_forward=17, left_backward=27}",
            HULL % 12,
        ),
        (ESC, "payload=[{kind='winch', out_pin=17, in_pin=27}]"),
        (ESC, f"payload=[{SERVO}]"),
        ("parts.gnss={driver='gpsd', port='localhost:2947'}",),
        ("parts.ais={driver='nmea', port='udpin:127.0.0.1:10110'}",),
        ("parts.ais={driver='nmea', port='/dev/serial/by-path/platform-usb-0:1.3:1.0-port0'}",),
        (ESC, OE, f"payload=[{SERVO}, {{kind='winch', signal={{output='pca9685', channel=1}}}}]"),
    ],
)
def test_parts_that_share_nothing_are_accepted(lines: tuple[str, ...]) -> None:
    check(*lines)


def test_the_pins_of_a_pi_5_are_its_own() -> None:
    check(ESC, "parts.motors.right.pin=18", model=PI_5)
    check(BRIDGE, TFMINI % "/dev/ttyAMA3", model=PI_5)  # GPIO 8, 9
    told = r"left_enable: GPIO 12 belongs to parts\.sonar\.port, /dev/ttyAMA4"
    with pytest.raises(ConfigError, match=told):
        check(BRIDGE, TFMINI % "/dev/ttyAMA4", model=PI_5)


def test_two_names_of_one_device_are_one_device(tmp_path: Path) -> None:
    (tmp_path / "ttyUSB0").touch()
    (tmp_path / "mavboat-gnss").symlink_to(tmp_path / "ttyUSB0")
    ports = {"parts.gnss.port": f"{tmp_path}/mavboat-gnss", "rc.port": f"{tmp_path}/ttyUSB0"}
    with pytest.raises(ConfigError, match=r"rc\.port: .*ttyUSB0 belongs to parts\.gnss\.port"):
        check_ports(Needs(ports, {}, {}, stretches_clock=False))
