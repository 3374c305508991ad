"""A boat with a u-blox receiver and two antennas, as ground stations see it; corrections sent by MAVSDK."""

import asyncio
import base64
import random
from collections.abc import Iterator
from pathlib import Path

import pytest
from mavsdk.asyncio.plugins.rtk import RtkAsync
from mavsdk.logging import log_subscribe
from mavsdk.plugins.rtk import RtcmData
from mavsdk_station import mavsdk_station
from mavutil_station import OpenStation
from patience import MOMENT_S
from programs import Program, RunProgram, until
from pyrtcm.rtcmhelpers import calc_crc24q
from twins.lines import PtyLine
from twins.ubx_receiver import ZED_F9P, UbxReceiver
from twins.ubx_serial import SerialReceiver

pytestmark = pytest.mark.realtime
pytest_plugins = ("program_fixtures",)

MOCK_PINS = {"GPIOZERO_PIN_FACTORY": "mock", "GPIOZERO_MOCK_PIN_CLASS": "mockpwmpin"}
BOAT = """
links = ["tcpin:127.0.0.1:0"]

[failsafe]
overrun_action = 0  # the machine may be busy with other tests

[parts.motors]
driver = "l298n"

[parts.gnss]
driver = "ubx"
port = "{gnss}"
baseline_m = 1.0

[parts.compass]
driver = "gnss"
"""


@pytest.fixture
def receiver(tmp_path: Path) -> Iterator[UbxReceiver]:
    """A ZED-F9P with a fixed solution and a moving base a metre away."""
    twin = UbxReceiver(ZED_F9P)
    twin.motion.carrier, twin.motion.h_acc_mm, twin.motion.correction_age = 2, 14, 1
    line = PtyLine(tmp_path / "gnss")
    with SerialReceiver(line, twin):
        yield twin
    line.unplug()


@pytest.fixture
def boat(run_program: RunProgram, receiver: UbxReceiver, tmp_path: Path) -> Program:
    """The program, started and listening."""
    path = tmp_path / "boat.toml"
    path.write_text(BOAT.format(gnss=tmp_path / "gnss"), encoding="utf-8")
    program = run_program("boat-companion", "run", "--config", str(path), environment=MOCK_PINS)
    program.wait_for(r"listening on tcpin:", stream="err")
    return program


def port_of(boat: Program) -> int:
    return int(boat.wait_for(r"listening on tcpin:127\.0\.0\.1:(\d+)", stream="err")[1])


def test_a_station_sees_the_fixed_solution_and_the_heading(boat: Program, open_station: OpenStation) -> None:
    station = open_station(port_of(boat))
    raw = station.wait_for("GPS_RAW_INT", lambda raw: raw.fix_type == 6 and raw.yaw not in (0, 65535))
    assert (raw.h_acc, raw.vel_acc, raw.yaw) == (14, 250, 9000)
    assert station.wait_for("GPS_RTK").nsats == 14
    at = station.wait_for("GLOBAL_POSITION_INT", lambda at: abs(at.lat - 505000000) < 1000)
    assert at.hdg == pytest.approx(9000, abs=200)  # centidegrees
    boat.wait_for(r"INFO GNSS: ZED-F9P set up: 5 Hz, 115200 baud", stream="err")


def rtcm_frame(size: int) -> bytes:
    """A frame of an observation message."""
    head = b"\xd3" + size.to_bytes(2, "big") + b"\x43\x50" + random.Random(size).randbytes(size - 2)
    crc: int = calc_crc24q(head)
    return head + crc.to_bytes(3, "big")


def test_corrections_of_mavsdk_reach_the_receiver_whole(boat: Program, receiver: UbxReceiver) -> None:
    log_subscribe(lambda *_: True)
    frames = [rtcm_frame(size) for size in (19, 174, 175, 300, 600, 700)]
    boat.wait_for(r"INFO GNSS: ZED-F9P set up", stream="err")

    async def send() -> None:
        async with mavsdk_station(port_of(boat)) as system:
            rtk = RtkAsync(system)
            while not all(frame in receiver.rtcm for frame in frames):  # a receiver in its set-up gets none
                for frame in frames:
                    await rtk.send_rtcm_data(RtcmData(base64.b64encode(frame).decode()))
                await asyncio.sleep(1.0)

    asyncio.run(asyncio.wait_for(send(), 2.0 * MOMENT_S))

    def rest() -> bytes:
        left = receiver.rtcm
        for frame in frames:
            left = left.replace(frame, b"")
        return left

    until(lambda: not rest())  # nothing but whole frames
