"""The real program with speed controllers: armed, driven, and ended by a signal or killed."""

import json
import re
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import nmea_boat
import pytest
from mavutil_station import MavutilStation, OpenStation
from patience import JOB_S
from programs import Program, RunProgram, until
from pymavlink.dialects.v20 import all as dialect

pytestmark = pytest.mark.realtime
pytest_plugins = ("program_fixtures",)

E2E = Path(__file__).parent
MANUAL = 0
ARMING_S = 1.0
CHANNELS = ("pwmchip0/pwm0", "pwmchip0/pwm1")
BOAT = """
links = ["tcpin:127.0.0.1:0"]
[failsafe]
overrun_action = 0  # the machine may be busy with other tests
[parts.motors]
driver = "esc"
arming_s = {arming_s}
[parts.gnss]
driver = "nmea"
port = "{gnss}"
[parts.compass]
driver = "nmea"
port = "{compass}"
"""


@pytest.fixture
def config(tmp_path: Path) -> Iterator[Path]:
    """The boat's file, with both of its serial parts switched on."""
    gnss, compass, path = tmp_path / "gnss", tmp_path / "compass", tmp_path / "boat.toml"
    path.write_text(BOAT.format(gnss=gnss, compass=compass, arming_s=ARMING_S), encoding="utf-8")
    with ExitStack() as parts:
        parts.enter_context(nmea_boat.receiver(gnss, 50.7, -1.3))
        parts.enter_context(nmea_boat.compass(compass, 1.5))
        yield path


@pytest.fixture
def driving(run_program: RunProgram, open_station: OpenStation, config: Path, tmp_path: Path) -> Program:
    """Armed in MANUAL, ahead."""
    boat = run_program(str(E2E / "esc_boat.py"), str(tmp_path), "run", "--config", str(config))
    port = boat.wait_for(r"listening on tcpin:127\.0\.0\.1:(\d+)", stream="err")[1]
    station = open_station(int(port))
    assert station.enter(MANUAL) == dialect.MAV_RESULT_ACCEPTED
    until(lambda: station.arm() == dialect.MAV_RESULT_ACCEPTED)
    until(lambda: push(station) or all(width > 1_700_000 for width in widths_ns(tmp_path)))
    return boat


def push(station: MavutilStation) -> bool:
    station.mav.rc_channels_override_send(1, 1, 1500, 0, 1900, 0, 0, 0, 0, 0)
    return False


def widths_ns(root: Path) -> list[int]:
    """What the kernel makes now; 0 where it is disabled."""
    folders = [root / "class" / "pwm" / channel for channel in CHANNELS]
    values = [
        [(folder / name).read_text(encoding="ascii") for name in ("duty_cycle", "enable")]
        for folder in folders
    ]
    return [int(duty or 0) * int(enable or 0) for duty, enable in values]


def test_a_signal_sends_neutral_and_then_ends_the_pulses(driving: Program, tmp_path: Path) -> None:
    driving.send(signal.SIGTERM)
    ended = driving.wait()
    assert ended.code == 0, ended
    assert re.search(r"stopped after \d+ ticks, \d+ late, \d+ skipped", ended.err)
    assert "Traceback" not in ended.err
    assert widths_ns(tmp_path) == [0, 0]
    history = json.loads((tmp_path / "history.json").read_text(encoding="utf-8"))
    for channel in CHANNELS:
        pulses = [(time_s, width_us) for time_s, output, width_us in history if output == channel]
        (began_s, _), (neutral_s, neutral_us), (end_s, end_us) = pulses[0], *pulses[-2:]
        assert (neutral_us, end_us) == (1500.0, 0.0)
        assert end_s - neutral_s >= 0.04  # two pulses at least
        assert {width_us for time_s, width_us in pulses if time_s - began_s < ARMING_S} == {1500.0}


def test_a_killed_program_drives_on_until_motors_off_has_run(
    driving: Program, tmp_path: Path, config: Path
) -> None:
    driving.send(signal.SIGKILL)
    driving.wait()
    assert all(width > 1_700_000 for width in widths_ns(tmp_path))
    off = [sys.executable, str(E2E / "esc_boat.py"), str(tmp_path), "motors_off", str(config)]
    subprocess.run(off, check=True, timeout=JOB_S)
    history = json.loads((tmp_path / "history.json").read_text(encoding="utf-8"))
    assert [width_us for _, _, width_us in history] == [1500.0, 1500.0, 0.0, 0.0]
    assert widths_ns(tmp_path) == [0, 0]
