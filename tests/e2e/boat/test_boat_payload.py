"""`boat-companion run` with payload on mock pins; the owner's programs are real processes."""

import sys
from pathlib import Path

import pytest
from mavutil_station import OpenStation
from patience import MOMENT_S
from programs import RunProgram, until
from pymavlink.dialects.v20 import all as dialect

pytestmark = pytest.mark.realtime
pytest_plugins = ("program_fixtures",)

MOCK_PINS = {"GPIOZERO_PIN_FACTORY": "mock", "GPIOZERO_MOCK_PIN_CLASS": "mockpwmpin"}
OK, DENIED = dialect.MAV_RESULT_ACCEPTED, dialect.MAV_RESULT_DENIED
BOAT = """
links = ["tcpin:127.0.0.1:0"]
failsafe.overrun_action = 0  # the machine may be busy with other tests
external = {{position = 1, heading = 1}}
parts.motors.driver = "l298n"

[[payload]]
kind = "relay"
number = 0
pin = 17

[[payload]]
kind = "command"
number = 7
run = ["{python}", "-c", "print('bottle 3 is full')"]

[[payload]]
kind = "command"
number = 8
run = ["{python}", "-c", "import os, time; open('{note}', 'w').write(str(os.getpid())); time.sleep(1000)"]

[camera]
capture = ["{python}", "-c", "import sys; open(sys.argv[1], 'w').write('jpeg')", "{{file}}"]
folder = "{images}"
"""


def test_programs_run_are_logged_and_end_with_the_boat(
    run_program: RunProgram, open_station: OpenStation, tmp_path: Path
) -> None:
    note, images, path = tmp_path / "pid", tmp_path / "images", tmp_path / "boat.toml"
    path.write_text(BOAT.format(python=sys.executable, note=note, images=images), encoding="utf-8")
    boat = run_program("boat-companion", "run", "--config", str(path), environment=MOCK_PINS)
    port = int(boat.wait_for(r"listening on tcpin:127\.0\.0\.1:(\d+)", stream="err")[1])
    station = open_station(port)
    assert station.command(dialect.MAV_CMD_DO_SET_RELAY, 0, 1) == OK
    assert station.command(dialect.MAV_CMD_DO_SET_RELAY, 12, 1) == DENIED  # the L298N's own pin
    relays = station.wait_for("RELAY_STATUS", lambda message: message.on == 1)
    assert relays.present == 1

    assert station.command(dialect.MAV_CMD_DO_SEND_SCRIPT_MESSAGE, 7) == OK
    boat.wait_for("command 7: bottle 3 is full", MOMENT_S, stream="err")
    boat.wait_for("INFO Command 7: done", MOMENT_S, stream="err")

    assert station.command(dialect.MAV_CMD_DO_DIGICAM_CONTROL, 0, 0, 0, 0, 1) == OK
    taken = station.wait_for("CAMERA_IMAGE_CAPTURED")
    assert (taken.get_srcComponent(), taken.capture_result, taken.image_index) == (100, 1, 0)
    assert taken.file_url.rstrip("\0") == str(images / "image-00001.jpg")
    assert (images / "image-00001.jpg").read_text() == "jpeg"

    assert station.command(dialect.MAV_CMD_DO_SEND_SCRIPT_MESSAGE, 8) == OK
    until(lambda: note.exists() and note.read_text())
    child = Path(f"/proc/{note.read_text()}")
    assert child.exists()
    boat.close()
    assert not child.exists()
