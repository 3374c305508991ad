"""`[[payload]]` and `[camera]`: what a file may say, and what is wrong with one that may not."""

import pytest

from companion.config.boat_config import decode_config
from companion.config.payload import HornPayload, ServoPayload
from companion.core.errors import ConfigError


def test_each_kind_has_its_number_and_its_safe_states() -> None:
    config = decode_config(
        {
            "payload": [
                {"kind": "horn", "number": 2, "pin": 22},
                {"kind": "servo", "number": 9, "name": "bait", "start": 1500, "at_end": 1100},
            ]
        },
        "boat.toml",
    )
    horn, servo = config.payload
    assert isinstance(horn, HornPayload)
    assert (horn.max_on_s, horn.on_disarm, horn.on_link_loss) == (5.0, "off", "off")
    assert isinstance(servo, ServoPayload)
    assert (horn.title, servo.title) == ("horn 2", "servo 9 (bait)")


RELAY = {"kind": "relay", "number": 0, "pin": 17}
FAULTS = [
    ([{"kind": "crane"}], "crane"),
    ([{"kind": "servo", "number": 4}], "Expected `int` >= 5"),
    ([{"kind": "servo", "number": 17}], "Expected `int` <= 16"),
    ([{"kind": "relay", "number": 0, "pin": 28}], "Expected `int` <= 27"),
    ([{"kind": "relay", "number": 0, "pin": 8}], "pin = 8: GPIO 0 to 8 are on at reset; expected 9 to 27"),
    ([{"kind": "winch", "out_pin": 17, "in_pin": 4}], "in_pin = 4: GPIO 0 to 8 are on at reset"),
    ([{"kind": "winch", "out_pin": 17}], "expected both out_pin and in_pin, or neither"),
    ([RELAY, {"kind": "light", "number": 0, "pin": 27}], "payload[1].number = 0: expected another"),
    ([{"kind": "servo", "number": 9, "start": 999}], "start = 999: expected 1100 to 1900, as in signal"),
    ([{"kind": "gripper", "open_us": 2000}], "open_us = 2000: expected 1100 to 1900, as in signal"),
    ([{"kind": "horn", "number": 0, "pin": 17, "max_on_s": 0.0}], "max_on_s"),
    ([{"kind": "command", "number": 1, "run": []}], "length >= 1"),
    ([RELAY, {"kind": "command", "number": 1, "run": ["/bin/true"], "relay": 0}], "[1].relay = 0: expected"),
    ([{"kind": "command", "number": 1, "run": ["date"]}], "run[0] = 'date': expected an absolute path"),
    ([{"kind": "relay", "number": 0, "pin": 17, "colour": "red"}], "colour"),
]  # fmt: skip


@pytest.mark.parametrize(("payload", "text"), FAULTS)
def test_a_wrong_table_is_refused_and_named(payload: list[dict[str, object]], text: str) -> None:
    with pytest.raises(ConfigError) as told:
        decode_config({"payload": payload}, "boat.toml")
    assert text in str(told.value)


@pytest.mark.parametrize(
    ("camera", "text"),
    [
        ({"rtsp": "http://10.0.0.2/x"}, "expected an address that begins with rtsp://"),
        ({"rtsp": "rtsp://" + "x" * 160}, "rtsp: expected at most 159 bytes"),
        ({"capture": ["rpicam-still"]}, "capture[0] = 'rpicam-still': expected an absolute path"),
        ({"capture": ["/usr/bin/rpicam-still", "-o", "{file}"]}, 'folder = "": expected the folder'),
    ],
)
def test_a_wrong_camera_is_refused_and_named(camera: dict[str, object], text: str) -> None:
    with pytest.raises(ConfigError) as told:
        decode_config({"camera": camera}, "boat.toml")
    assert text in str(told.value)
