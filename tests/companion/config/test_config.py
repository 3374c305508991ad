import tomllib
from pathlib import Path

import pytest

from companion.config.boat_config import BoatConfig, decode_config, load_config, with_value
from companion.core.errors import ConfigError


def decoded(text: str) -> BoatConfig:
    return decode_config(tomllib.loads(text), "boat.toml")


@pytest.mark.parametrize(
    ("text", "key"),
    [
        ("[heading]\nkpp = 1.0", "kpp"),
        ("[haeding]\nkp = 1.0", "haeding"),
        ("[heading]\nkp = -1.0", "heading.kp"),
        ("[heading]\nkp = 1e39", "kp"),
        ("[identity]\nsystem_id = 256", "identity.system_id"),
        ("[failsafe]\ngcs_enabled = 1", "failsafe.gcs_enabled"),
        ("[parts.motors]\ndriver = 'warp'", "parts.motors.driver"),
        ("links = [5760]", "links"),
    ],
)
def test_a_key_that_cannot_be_used_is_named(text: str, key: str) -> None:
    with pytest.raises(ConfigError, match=key) as caught:
        decoded(text)
    assert "boat.toml" in str(caught.value)
    assert caught.value.exit_code == 2


def test_a_file_that_is_missing_or_no_toml_is_named(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"missing\.toml"):
        load_config(tmp_path / "missing.toml")
    path = tmp_path / "bad.toml"
    path.write_text("[heading]\nkp = = 1\n", encoding="utf-8")
    with pytest.raises(ConfigError, match=r"bad\.toml.*line 2"):
        load_config(path)
    path.write_bytes(b"title = '\xff'\n")
    with pytest.raises(ConfigError, match=r"bad\.toml"):
        load_config(path)


@pytest.mark.parametrize(
    ("path", "value"),
    [
        ("heading.kpp", 1.0),
        ("nothing.kp", 1.0),
        ("links", ()),
        ("", 1.0),
        ("heading.kp", -0.1),
        ("heading.kp", float("inf")),
        ("failsafe.gcs_enabled", 1.0),
    ],
)
def test_a_value_that_does_not_fit_is_refused_by_its_path(path: str, value: object) -> None:
    with pytest.raises(ConfigError) as caught:
        with_value(BoatConfig(), path, value)
    assert str(caught.value).startswith(f"{path}:")


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


DRV8833 = "[parts.motors]\ndriver = 'drv8833'\n"


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        (DRV8833 + "left_forward = 9\nleft_backward = 8", "left_backward = 8: GPIO 0 to 8 are high at reset"),
        ("[parts.sonar]\ntrigger = 28", "sonar.trigger"),
        ("[[probe]]\nname = 'ph'\ndriver = 'file'\npattern = '(\\d+)'", "path of the probe ph: expected"),
        ("[[probe]]\nname = 'ph'\ndriver = 'serial'\npattern = '(\\d+)'", "port of the probe ph"),
        ("[parts.lidar]\ndriver = 'ld06'\nmin_range_m = 8.0", "min_range_m = 8: expected less"),
        ("[parts.lidar]\nblind_rad = [[170.0, 190.0]]", "lidar.blind_rad"),
        ("[parts.lidar]\nblind_rad = [[-2.97, 2.97]]", "hides more than 180° clockwise"),
        ("[camera]\nname = '" + 32 * "x" + "'", "camera.name"),
    ],
)  # fmt: skip
def test_a_part_that_cannot_work_is_refused_with_the_reason(text: str, reason: str) -> None:
    with pytest.raises(ConfigError) as caught:
        decoded(text)
    assert reason in str(caught.value)


def test_parts_that_can_work_are_accepted() -> None:
    config = decoded(
        DRV8833 + "left_forward = 9\nleft_backward = 10\nright_forward = 11\nright_backward = 12\n"
        "[[probe]]\nname = 'ph'\ndriver = 'serial'\nport = '/dev/ttyUSB3'\npattern = '(\\d+)'\n"
    )
    assert config.parts.motors.pins(has_right=True) == {
        "left_forward": 9, "left_backward": 10, "right_forward": 11, "right_backward": 12,
    }  # fmt: skip
    assert [probe.path for probe in config.probe] == [""]


def test_the_switch_chooses_the_modes_in_the_order_of_its_positions() -> None:
    config = decoded("[rc]\nmode_1 = 4\nmode_2 = 10\nmode_6 = 11")
    assert [mode.name for mode in (*config.rc.modes[:2], config.rc.modes[5])] == ["HOLD", "AUTO", "RTL"]


@pytest.mark.parametrize(
    ("enable", "uses"), [(0, False), (1, False), (2, True), (3, True), (4, False), (7, True)]
)
def test_rangers_are_used_where_the_second_bit_of_avoid_enable_is_set(enable: int, uses: bool) -> None:
    assert decoded(f"[avoidance]\nenable = {enable}").avoidance.avoids_obstacles is uses
