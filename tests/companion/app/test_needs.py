"""No two parts on one pin, signal, device or address; each pin does what it is used for."""

from pathlib import Path
from typing import Any

import pytest

from companion.app.needs import Needs, check_needs, check_ports
from companion.config.boat_config import BoatConfig, decode_config
from companion.core.errors import ConfigError

ESC = {"motors": {"driver": "esc"}}
SERVO = {"kind": "servo", "number": 5}
WINCH = {"kind": "winch", "number": 1}
BRIDGE = {"motors": {"driver": "l298n"}}
COMPASS = {"compass": {"driver": "bno055"}}
PI_4, PI_5 = "Raspberry Pi 4 Model B Rev 1.4", "Raspberry Pi 5 Model B Rev 1.0"


def config(parts: dict[str, Any], *payload: dict[str, Any], layout: str = "differential") -> BoatConfig:
    return decode_config({"parts": parts, "payload": list(payload), "drive": {"layout": layout}}, "test")


@pytest.mark.parametrize(
    ("tree", "message"),
    [
        (
            config({"motors": {"driver": "l298n", "right_enable": 5}}),
            r"right_enable: GPIO 5 belongs to .*left_forward",
        ),
        (
            config({"motors": {"driver": "l298n"}, "sonar": {"driver": "tfmini", "servo": 12}}),
            "parts.sonar.servo: GPIO 12 belongs to parts.motors.left_enable",
        ),
        (
            config({"sonar": {"driver": "hcsr04"}, "hull": {"driver": "host", "leak": 24}}),
            "parts.hull.leak: GPIO 24 belongs to parts.sonar.echo",
        ),
        (
            config(ESC, {"kind": "light", "number": 0, "pin": 12}),
            r"payload\[0\].pin: GPIO 12 belongs to parts.motors.left",
        ),
        (
            config(
                {
                    "motors": {"driver": "esc", "left": {"output": "pca9685", "channel": 3}},
                    "pca9685": {"output_enable": 22},
                },
                {**SERVO, "signal": {"output": "pca9685", "channel": 3}},
            ),
            r"payload\[0\].signal: channel 3 of the PCA9685 belongs to parts.motors.left",
        ),
        (
            config({"motors": {"driver": "esc", "right": {"output": "pca9685", "channel": 1}}}),
            r"parts.motors.right: .* goes on with its last pulse .* parts.pca9685.output_enable",
        ),
        (
            config(ESC, {**WINCH, "signal": {"output": "pca9685", "channel": 1}}),
            r"payload\[0\].signal: .* goes on with its last pulse .* parts.pca9685.output_enable",
        ),
        (config(ESC, WINCH), r"payload\[0\].signal.pin: expected the number of a pin"),
    ],
)
def test_what_is_used_twice_names_both_keys(tree: BoatConfig, message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        check_needs(tree, PI_4)


@pytest.mark.parametrize(
    "tree",
    [
        config({}),
        config({**ESC, "rudder": {"driver": "servo"}}, layout="rudder"),  # no right motor
        config(
            {
                "motors": {"driver": "drv8833", "left_forward": 17, "left_backward": 27},
                "hull": {"driver": "host", "leak": 12},
            }
        ),
        config(ESC, {**WINCH, "out_pin": 17, "in_pin": 27}),
        config(ESC, {**SERVO, "signal": {"output": "pca9685"}}),
        config(
            {**ESC, "pca9685": {"output_enable": 22}},
            {**SERVO, "signal": {"output": "pca9685"}},
            {**WINCH, "signal": {"output": "pca9685", "channel": 1}},
        ),
    ],
)
def test_parts_that_share_nothing_are_accepted(tree: BoatConfig) -> None:
    check_needs(tree, PI_4)


def with_forward(pin: int) -> dict[str, Any]:
    return {"motors": {"driver": "l298n", "left_forward": pin}}


@pytest.mark.parametrize(
    ("parts", "message"),
    [
        (
            {"motors": {"driver": "esc", "left": {"pin": 5}}},
            "parts.motors.left: GPIO 5 has no hardware PWM; expected 12, 13, 18 or 19",
        ),
        (
            {"motors": {"driver": "esc", "left": {"pin": 12}, "right": {"pin": 18}}},
            "parts.motors.right: GPIO 18 shares a PWM channel with parts.motors.left, GPIO 12",
        ),
        (
            {**with_forward(2), **COMPASS},
            "parts.motors.left_forward: GPIO 2 belongs to parts.compass, /dev/i2c-1",
        ),
        (
            {**with_forward(14), "gnss": {"driver": "nmea", "port": "/dev/serial0"}},
            "parts.motors.left_forward: GPIO 14 belongs to parts.gnss.port, /dev/serial0",
        ),
        (
            {
                "gnss": {"driver": "nmea", "port": "/dev/serial0"},
                "sonar": {"driver": "tfmini", "port": "/dev/ttyAMA0"},
            },
            "parts.sonar.port: GPIO 14 belongs to parts.gnss.port, /dev/serial0",
        ),
        (
            {**BRIDGE, "sonar": {"driver": "tfmini", "port": "/dev/ttyAMA5"}},
            "parts.motors.left_enable: GPIO 12 belongs to parts.sonar.port, /dev/ttyAMA5",
        ),
    ],
)
def test_wiring_that_cannot_be_is_refused(parts: dict[str, Any], message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        check_needs(config(parts), PI_4)


def test_the_pins_of_a_pi_5_are_its_own() -> None:
    check_needs(config({"motors": {"driver": "esc", "left": {"pin": 12}, "right": {"pin": 18}}}), PI_5)
    check_needs(config({**BRIDGE, "sonar": {"driver": "tfmini", "port": "/dev/ttyAMA3"}}), PI_5)  # GPIO 8, 9
    with pytest.raises(
        ConfigError, match=r"left_enable: GPIO 12 belongs to parts\.sonar\.port, /dev/ttyAMA4"
    ):
        check_needs(config({**BRIDGE, "sonar": {"driver": "tfmini", "port": "/dev/ttyAMA4"}}), PI_5)


def test_two_names_of_one_device_are_one_device(tmp_path: Path) -> None:
    (tmp_path / "ttyUSB0").touch()
    (tmp_path / "mavboat-gnss").symlink_to(tmp_path / "ttyUSB0")
    ports = {"parts.gnss.port": f"{tmp_path}/mavboat-gnss", "rc.port": f"{tmp_path}/ttyUSB0"}
    with pytest.raises(ConfigError, match=r"rc\.port: .*ttyUSB0 belongs to parts\.gnss\.port"):
        check_ports(Needs(ports, {}, {}, stretches_clock=False))
