"""No two parts on one pin or signal."""

from typing import Any

import pytest

from companion.config.boat_config import BoatConfig, decode_config
from companion.config.parts.outputs_in_use import check_outputs, outputs_in_use
from companion.core.errors import ConfigError

ESC = {"motors": {"driver": "esc"}}
SERVO = {"kind": "servo", "number": 5}
WINCH = {"kind": "winch", "number": 1}


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
            config({**ESC, "rudder": {"driver": "servo"}}),
            "parts.rudder.signal: GPIO 13 belongs to parts.motors.right",
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
                {"motors": {"driver": "esc", "left": {"output": "pca9685", "channel": 3}}},
                {**SERVO, "signal": {"output": "pca9685", "channel": 3}},
            ),
            r"payload\[0\].signal: channel 3 of the PCA9685 belongs to parts.motors.left",
        ),
        (
            config({"motors": {"driver": "esc", "right": {"output": "pca9685", "channel": 1}}}),
            r"parts.motors.right: .* goes on with its last pulse .* parts.pca9685.output_enable",
        ),
        (config(ESC, SERVO), r"payload\[0\].signal.pin: expected the number of a pin"),
        (config(ESC, WINCH), r"payload\[0\].signal.pin: expected the number of a pin"),
    ],
)
def test_what_is_used_twice_names_both_keys(tree: BoatConfig, message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        check_outputs(tree)


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
        config(
            ESC,
            {**SERVO, "signal": {"output": "pca9685"}},
            {**WINCH, "signal": {"output": "pca9685", "channel": 1}},
        ),
    ],
)
def test_parts_that_share_nothing_are_accepted(tree: BoatConfig) -> None:
    check_outputs(tree)


def test_a_bridge_uses_six_pins_a_boat_with_one_motor_three() -> None:
    bridge = {"motors": {"driver": "l298n"}}
    assert len(list(outputs_in_use(config(bridge)))) == 6
    assert [key for key, _ in outputs_in_use(config(bridge, layout="rudder"))] == [
        "parts.motors.left_forward",
        "parts.motors.left_backward",
        "parts.motors.left_enable",
    ]
