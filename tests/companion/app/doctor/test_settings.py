"""The Pi's start-up files: what the doctor misses in them, and how it adds it."""

import pytest
from doctor_tree import PI_4, Examine

from companion.app.doctor.findings import Verdict
from companion.app.doctor.settings import (
    BACKUP,
    active_lines,
    check_boot_config,
    check_console,
    check_motors_off,
)
from companion.app.install.steps import apply_steps
from companion.config.actuators import MotorsPart, PulseOutputSetting
from companion.config.actuators import RudderPart as Rudder
from companion.config.boat_config import BoatConfig, Parts, decode_config
from companion.config.payload import GripperPayload, ServoPayload
from companion.config.sensors import BatteryPart, CompassPart, GnssPart
from companion.config.tuning import Rc

pytest_plugins = ("doctor_fixtures",)

PI_5 = "Raspberry Pi 5 Model B Rev 1.0\0"
CONFIG_TXT = "/boot/firmware/config.txt"
CMDLINE = "/boot/firmware/cmdline.txt"
STOCK = "# For more options see ...\n#dtparam=i2c_arm=on\ndtparam=audio=on\n[cm4]\notg_mode=1\n[all]\n"
KIT = BoatConfig(
    links=("tcpin:0.0.0.0:5760", "serial:/dev/ttyUSB0:57600"),
    parts=Parts(
        motors=MotorsPart(driver="l298n"),
        gnss=GnssPart(driver="nmea"),
        compass=CompassPart(driver="bno055"),
        battery=BatteryPart(driver="ina219"),
    ),
    rc=Rc(driver="crsf", port="/dev/ttyAMA4"),
)
SLOW_BUS = ["dtparam=i2c_arm=on", "dtparam=i2c_arm_baudrate=10000"]
ESC = BoatConfig(
    parts=Parts(
        motors=MotorsPart(driver="esc", right=PulseOutputSetting(output="pca9685", channel=1)),
        rudder=Rudder(driver="servo", signal=PulseOutputSetting(pin=19)),
    ),
    payload=(GripperPayload(pin=4), ServoPayload(number=5, signal=PulseOutputSetting(pin=18))),
)


def test_conditions_of_config_txt_are_followed() -> None:
    text = "a=1 # why\n[pi4]\nb=2\n[pi5]\nc=3\n[none]\nd=4\n[all]\ne=5\n[EDID=x]\nf=6\n"
    assert active_lines(text, "Raspberry Pi 4 Model B Rev 1.4") == ["a=1", "b=2", "e=5"]
    assert active_lines(text, "Raspberry Pi 5 Model B Rev 1.0") == ["a=1", "c=3", "e=5"]
    assert active_lines("[pi02]\nz=1\n[pi0]\ny=1\n", "Raspberry Pi Zero 2 W Rev 1.0") == ["z=1", "y=1"]
    assert active_lines(text, "") == ["a=1", "e=5"]


@pytest.mark.parametrize(
    ("model", "config", "lines"),
    [
        (PI_4, KIT, ["enable_uart=1", "dtoverlay=uart4", *SLOW_BUS]),
        (PI_5, KIT, ["dtparam=uart0=on", "dtoverlay=uart4-pi5", *SLOW_BUS]),
        (PI_4, ESC, ["dtparam=i2c_arm=on", "dtoverlay=pwm-2chan,pin=18,func=2,pin2=19,func2=2"]),
    ],
)
def test_missing_lines_are_named_and_added_beside_a_copy_of_the_file(
    examine: Examine, model: str, config: BoatConfig, lines: list[str]
) -> None:
    examined = examine({"/proc/device-tree/model": model, CONFIG_TXT: STOCK}, config)
    (found,) = check_boot_config(examined)
    assert found.verdict is Verdict.FAILED
    assert found.text == f"{CONFIG_TXT} lacks {', '.join(lines)}"
    apply_steps(found.fix, lambda _: None)
    text = examined.read(CONFIG_TXT) or ""
    assert text.startswith(STOCK)
    assert active_lines(text, examined.model)[-len(lines) :] == lines
    assert examined.path(CONFIG_TXT + BACKUP).read_text(encoding="utf-8") == STOCK
    (found,) = check_boot_config(examined)
    assert found.verdict is Verdict.FINE


@pytest.mark.parametrize(
    "console", ["console=serial0,115200 ", "console=ttyAMA0,115200n8 ", "console=ttyS0 "]
)
def test_a_console_on_the_receivers_line_is_taken_off(examine: Examine, console: str) -> None:
    rest = "console=tty1 root=PARTUUID=1-02 rootwait\n"
    examined = examine({CMDLINE: console + rest}, KIT)
    (found,) = check_console(examined)
    assert found.verdict is Verdict.FAILED
    apply_steps(found.fix, lambda _: None)
    assert examined.path(CMDLINE).read_text(encoding="utf-8") == rest
    (found,) = check_console(examined)
    assert found.verdict is Verdict.FINE


@pytest.mark.parametrize(
    "payload",
    [
        {"kind": "relay", "number": 0, "pin": 17},
        {"kind": "light", "number": 1, "pin": 17, "active_low": True},
        {"kind": "winch", "number": 1, "out_pin": 23, "in_pin": 26},
        {"kind": "winch", "number": 1, "signal": {"output": "software", "pin": 17}},
    ],
)
def test_a_payload_on_pins_needs_that_program_too(examine: Examine, payload: dict[str, object]) -> None:
    config = decode_config({"parts": {"motors": {"driver": "esc"}}, "payload": [payload]}, "test")
    assert check_motors_off(examine({}, config))[0].verdict is Verdict.FAILED
