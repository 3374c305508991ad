"""Signed links between real programs: pymavlink, MAVProxy and mission-upload, with keys and without."""

import socket
import stat
import time
from pathlib import Path

import pytest
from mavutil_station import MavutilStation, OpenStation, zigzag
from patience import JOB_S
from programs import RunBoat, RunProgram
from pymavlink.dialects.v20 import all as dialect

from companion.mavlink.signing_key import SigningKey, read_key_file

pytestmark = pytest.mark.realtime
pytest_plugins = ("program_fixtures",)

PHRASE = "correct-horse"  # one word, for MAVProxy
KEY = SigningKey.from_passphrase(PHRASE).reveal()
OTHER = SigningKey.from_passphrase("battery staple").reveal()
OK = dialect.MAV_RESULT_ACCEPTED
HOLD, MANUAL = 4.0, 0.0


@pytest.fixture
def key_file(tmp_path: Path) -> Path:
    """A key as a person makes one."""
    path = tmp_path / "boat.key"
    path.write_text(PHRASE + "\n")
    path.chmod(0o600)
    return path


def sign(station: MavutilStation, key: bytes = KEY) -> None:
    """Let pymavlink sign, and take nothing that is not signed."""
    station.link.setup_signing(key, sign_outgoing=True)
    station.mav = station.link.mav  # which pymavlink has made anew when it first heard version 2


def answer(station: MavutilStation, mode: float, timeout_s: float = 2.0) -> int | None:
    """What the boat says to a change of mode; None: nothing."""
    station.mav.command_long_send(1, 1, dialect.MAV_CMD_DO_SET_MODE, 0, 1.0, mode, 0, 0, 0, 0, 0)
    ack = station.link.recv_match(type="COMMAND_ACK", blocking=True, timeout=timeout_s)
    return None if ack is None else int(ack.result)


def test_pymavlink_signs_and_is_obeyed_and_without_the_key_is_not(
    running_boat: RunBoat, open_station: OpenStation, key_file: Path
) -> None:
    boat = running_boat("open", "--sign-key", str(key_file))
    friend, stranger, forger = (open_station(boat.port, system) for system in (255, 254, 253))
    sign(friend)
    sign(forger, OTHER)
    assert friend.command(dialect.MAV_CMD_DO_SET_MODE, 1.0, MANUAL) == OK
    assert friend.upload(zigzag(100)) == dialect.MAV_MISSION_ACCEPTED
    assert len(friend.download()) == 101
    assert answer(stranger, HOLD) is None
    assert answer(forger, HOLD) is None
    assert "not signed" in friend.wait_for("STATUSTEXT", lambda text: "refused" in text.text).text
    assert friend.mode() == MANUAL
    assert friend.mav.signing.goodsig_count > 200
    assert friend.mav.signing.badsig_count == friend.mav.signing.reject_count == 0


def test_a_restarted_boat_goes_on_where_it_was(
    running_boat: RunBoat, open_station: OpenStation, key_file: Path, tmp_path: Path
) -> None:
    options = ["open", "--sign-key", str(key_file), "--state", str(tmp_path / "state")]
    last = 0
    for _ in range(2):
        boat = running_boat(*options)
        station = open_station(boat.port)
        sign(station)
        assert station.command(dialect.MAV_CMD_DO_SET_MODE, 1.0, HOLD) == OK
        heartbeat = station.wait_for("HEARTBEAT")
        stamp = int.from_bytes(bytes(heartbeat.get_msgbuf())[-12:-6], "little")
        assert stamp > last
        last = stamp
        boat.program.kill()


def test_mission_upload_brings_a_mission_over_signed_udp(run_program: RunProgram, key_file: Path) -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
        free.bind(("127.0.0.1", 0))
        place = f"127.0.0.1:{free.getsockname()[1]}"
    boat = run_program("boat-sitl", "serve", "lake", "--no-tcp", "--udp", place, "--sign-key", str(key_file))
    boat.wait_for("ready")
    planner = run_program(
        "mission-upload", "lake", "--connect", f"udpin:{place}", "--sign-key", str(key_file)
    )
    ended = planner.wait(JOB_S)
    assert ended.code == 0, ended
    assert "read back and found equal" in ended.out


def test_mavproxy_brings_the_key_over_loopback_and_both_sign_from_then_on(
    running_boat: RunBoat, run_program: RunProgram, open_station: OpenStation, tmp_path: Path
) -> None:
    state = tmp_path / "state"
    boat = running_boat("open", "--signing", "accept", "--state", str(state))
    proxy = run_program("mavproxy.py", f"--master={boat.url}", "--state-basedir=.")
    proxy.wait_for("Received [0-9]+ parameters")
    proxy.say(f"signing setup {PHRASE}")
    proxy.wait_for("Signing key stored")
    key = state / "signing.key"
    assert stat.S_IMODE(key.stat().st_mode) == 0o600
    assert read_key_file(key) == SigningKey.from_passphrase(PHRASE)
    proxy.say("set allow_unsigned 0")  # from now on it hears nothing but what the boat signs
    time.sleep(0.2)
    said = len(proxy.out)
    proxy.say("mode manual")
    proxy.wait_for("Got COMMAND_ACK: DO_SET_MODE: ACCEPTED", after=said)
    proxy.wait_for("Mode MANUAL", after=said)

    station = open_station(boat.port, 254)
    signed = station.wait_for("HEARTBEAT", lambda heartbeat: heartbeat.get_srcSystem() == 1)
    assert signed.get_msgbuf()[2] & 1
    proxy.hang_up()
    proxy.wait()
