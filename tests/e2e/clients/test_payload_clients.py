"""The payload of an emulated boat as MAVSDK and MAVProxy meet it."""

import asyncio
from collections.abc import Iterator
from pathlib import Path

import pytest
from mavsdk.asyncio.plugins.camera import CameraAsync
from mavsdk.asyncio.plugins.gripper import GripperAsync
from mavsdk.asyncio.plugins.telemetry import TelemetryAsync
from mavsdk.logging import log_subscribe
from mavsdk.plugins.camera import CaptureInfo, VideoStreamUpdate
from mavsdk_station import mavsdk_station
from patience import JOB_S, MOMENT_S
from payload_rig import CAMERA, PAYLOAD
from programs import Program, RunningBoat, start_boat

pytestmark = pytest.mark.realtime


@pytest.fixture(scope="module")
def boat(tmp_path_factory: pytest.TempPathFactory) -> Iterator[RunningBoat]:
    """One boat for all."""
    log_subscribe(lambda *_: True)
    room = tmp_path_factory.mktemp("payload") / "boat"
    running = start_boat(room, "open", "--set", PAYLOAD, "--set", CAMERA, "--speedup", "5")
    yield running
    running.program.close()


def test_mavsdk_finds_the_camera_takes_a_photo_and_moves_the_gripper(boat: RunningBoat) -> None:
    async def job() -> None:
        async with mavsdk_station(boat.port) as system:
            camera = CameraAsync(system)

            async def position() -> None:
                async for health in TelemetryAsync(system).subscribe_health():
                    if health.is_global_position_ok:
                        return
                raise AssertionError("the boat has no position")

            async def stream() -> VideoStreamUpdate:
                async for update in camera.subscribe_video_stream_info():
                    if update.video_stream_info.settings.uri:
                        return update
                raise AssertionError("the stream ended")

            async def photo() -> CaptureInfo:
                async for taken in camera.subscribe_capture_info():
                    return taken
                raise AssertionError("no photo came")

            await asyncio.wait_for(position(), MOMENT_S)  # the photo carries it
            seen = await asyncio.wait_for(stream(), MOMENT_S)
            assert seen.component_id == 100
            assert seen.video_stream_info.settings.uri == "rtsp://10.0.0.2:8554/bow"
            (found,) = (await camera.camera_list()).cameras
            assert (found.component_id, found.model_name) == (100, "Boat camera")
            coming = asyncio.create_task(photo())
            await asyncio.sleep(0)
            await camera.take_photo(100)
            taken = await asyncio.wait_for(coming, MOMENT_S)
            assert taken.is_success
            assert taken.index == 0
            assert taken.position.latitude_deg == pytest.approx(50.0, abs=0.01)
            gripper = GripperAsync(system)
            await gripper.grab(1)
            await gripper.release(1)

    asyncio.run(asyncio.wait_for(job(), JOB_S))


def test_mavproxy_sets_relay_and_servo(boat: RunningBoat, tmp_path: Path) -> None:
    proxy = Program(tmp_path / "proxy", ["mavproxy.py", f"--master={boat.url}", "--state-basedir=."])
    try:
        proxy.wait_for("Received [0-9]+ parameters")
        for line, answer in (
            ("relay set 0 1", r"Relay 0 \(pump\): on"),
            ("servo set 9 1250", r"Servo 9 \(bait\): 1250 us"),
            ("servo set 3 1900", r"DO_SET_SERVO: no servo 3, expected 9 \(bait\)"),
        ):
            said = len(proxy.out)
            proxy.say(line)
            proxy.wait_for(answer, MOMENT_S, after=said)
    finally:
        proxy.close()
