"""`boat-companion run` as on the boat: serial parts on pseudo-terminals, pins that are gpiozero's mocks."""

import itertools
import os
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import nmea_boat
import pytest
from fastcrc.crc8 import dvb_s2 as crc8
from mavutil_station import MavutilStation, OpenStation
from programs import Program, RunProgram
from pymavlink.dialects.v20 import all as dialect

pytestmark = pytest.mark.realtime
pytest_plugins = ("program_fixtures",)

MANUAL, AUTO = 0, 10
LAT_DEG, LON_DEG, HEADING_RAD = 50.7001, -1.3002, 1.5
MOCK_PINS = {"GPIOZERO_PIN_FACTORY": "mock", "GPIOZERO_MOCK_PIN_CLASS": "mockpwmpin"}
BOAT = """
links = ["tcpin:127.0.0.1:0"]

[failsafe]
overrun_action = 0  # the machine may be busy with other tests

[parts.motors]
driver = "l298n"

[parts.gnss]
driver = "nmea"
port = "{gnss}"

[parts.compass]
driver = "nmea"
port = "{compass}"
"""


@contextmanager
def fitted(folder: Path, more: str = "") -> Iterator[Path]:
    """A boat's file, with both of its serial parts switched on."""
    gnss, compass, path = folder / "gnss", folder / "compass", folder / "boat.toml"
    path.write_text(BOAT.format(gnss=gnss, compass=compass) + more, encoding="utf-8")
    with nmea_boat.receiver(gnss, LAT_DEG, LON_DEG), nmea_boat.compass(compass, HEADING_RAD):
        yield path


@pytest.fixture(scope="module")
def boat(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Program]:
    """The program, started and listening."""
    folder = tmp_path_factory.mktemp("boat")
    with fitted(folder) as path:
        program = Program(folder / "room", ("boat-companion", "run", "--config", str(path)), MOCK_PINS)
        program.wait_for(r"listening on tcpin:", stream="err")
        assert program.out == ""
        yield program
        program.close()


def port_of(boat: Program) -> int:
    return int(boat.wait_for(r"listening on tcpin:127\.0\.0\.1:(\d+)", stream="err")[1])


def push(station: MavutilStation, throttle_us: int, steering_us: int) -> bool:
    """A hand at the sticks, as often as a busy machine needs it. Returns that nothing has come of it yet."""
    station.mav.rc_channels_override_send(1, 1, steering_us, 0, throttle_us, 0, 0, 0, 0, 0)
    return False


def test_it_finds_itself_arms_and_obeys_the_operators_hand(boat: Program, open_station: OpenStation) -> None:
    station = open_station(port_of(boat))
    raw = station.wait_for("GPS_RAW_INT", lambda raw: raw.fix_type == 3)
    assert (raw.lat, raw.lon) == (pytest.approx(LAT_DEG * 1e7, abs=20), pytest.approx(LON_DEG * 1e7, abs=20))
    assert raw.satellites_visible == 12
    at = station.wait_for("GLOBAL_POSITION_INT", lambda at: abs(at.lat - LAT_DEG * 1e7) < 20)
    assert at.hdg == pytest.approx(8594, abs=10)  # centidegrees
    assert station.wait_for("SERVO_OUTPUT_RAW").servo1_raw == 1500

    assert station.enter(AUTO) == dialect.MAV_RESULT_FAILED  # there is no mission
    assert station.enter(MANUAL) == dialect.MAV_RESULT_ACCEPTED
    assert station.arm() == dialect.MAV_RESULT_ACCEPTED
    push(station, 1900, 1500)
    ahead = station.wait_for(
        "SERVO_OUTPUT_RAW", lambda servo: servo.servo1_raw > 1800 or push(station, 1900, 1500)
    )
    assert ahead.servo3_raw > 1800
    # The hand falls silent: the motors stop by themselves
    station.wait_for("SERVO_OUTPUT_RAW", lambda servo: (servo.servo1_raw, servo.servo3_raw) == (1500, 1500))
    assert station.enter(MANUAL) == dialect.MAV_RESULT_ACCEPTED  # should it have been missed meanwhile
    push(station, 1500, 2000)
    turning = station.wait_for(
        "SERVO_OUTPUT_RAW", lambda servo: servo.servo1_raw > 1600 or push(station, 1500, 2000)
    )
    assert turning.servo3_raw < 1400
    # The journal says what the operator was told
    for line in ("INFO Mode MANUAL", "INFO Armed", "ERROR AUTO: no mission"):
        boat.wait_for(rf"^[-0-9]+ [:,0-9]+ {line}", stream="err")


def test_a_program_that_hung_reads_the_heartbeats_that_waited_before_it_misses_an_operator(
    boat: Program, open_station: OpenStation
) -> None:
    station = open_station(port_of(boat))
    station.heartbeat()
    station.listen(0.5)
    os.kill(boat.pid, signal.SIGSTOP)
    for _ in range(8):  # seconds; after 5 an operator is lost
        station.heartbeat()
        station.link.recv_match(type="PING", blocking=True, timeout=1.0)
    os.kill(boat.pid, signal.SIGCONT)
    texts = [station.wait_for("STATUSTEXT").text]
    while "Clock leapt by" not in texts[-1]:
        texts.append(station.wait_for("STATUSTEXT").text)
    texts += [told.text for told in station.listen(3.0) if told.get_type() == "STATUSTEXT"]
    assert not [text for text in texts if "Operator lost" in text]


def channels(throttle_us: int, arm_us: int) -> bytes:
    """A CRSF frame as a receiver sends it: 1 steers, 3 is the throttle, 5 arms."""
    ticks = [992, 992, round(992 + 1.6 * (throttle_us - 1500)), 992, round(992 + 1.6 * (arm_us - 1500))]
    bits = sum(tick << 11 * number for number, tick in enumerate(ticks + [992] * 11))
    body = b"\x16" + bits.to_bytes(22, "little")
    return bytes([0xC8, len(body) + 1]) + body + bytes([crc8(body)])


def arm_by_switch(station: MavutilStation, said: list[bytes]) -> None:
    """Move the switch until the boat is armed: what it refuses once, it does not try again by itself."""
    for arm_us in itertools.cycle((2000, 1000)):
        said[0] = channels(1500, arm_us)
        while station.wait_for("RC_CHANNELS").chan5_raw != arm_us:
            pass
        beats = [station.wait_for("HEARTBEAT", lambda beat: beat.get_srcSystem() == 1) for _ in range(2)]
        if beats[-1].base_mode & dialect.MAV_MODE_FLAG_SAFETY_ARMED:
            return


def test_a_transmitter_arms_and_drives_it_and_is_missed_when_it_is_silent(
    run_program: RunProgram, open_station: OpenStation, tmp_path: Path
) -> None:
    uart, said = tmp_path / "uart", [channels(1500, 1000)]
    radio = f'\n[rc]\ndriver = "crsf"\nport = "{uart}"\narm_channel = 5\ntimeout_s = 2.0\n'
    with nmea_boat.TalkingPart(uart, lambda: said[0]), fitted(tmp_path, radio) as path:
        boat = run_program("boat-companion", "run", "--config", str(path), environment=MOCK_PINS)
        station = open_station(port_of(boat))  # it chooses MANUAL, and listens
        station.wait_for("RC_CHANNELS", lambda rc: rc.chancount == 16 and rc.chan5_raw == 1000)
        station.wait_for("GPS_RAW_INT", lambda raw: raw.fix_type == 3)
        assert station.enter(MANUAL) == dialect.MAV_RESULT_ACCEPTED
        arm_by_switch(station, said)
        said[0] = channels(1900, 2000)
        station.wait_for("SERVO_OUTPUT_RAW", lambda servo: servo.servo1_raw > 1800)
        said[0] = b""
        station.wait_for("STATUSTEXT", lambda line: "RC lost: the receiver is silent" in line.text)
