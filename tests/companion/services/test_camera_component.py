"""The camera as QGroundControl, MAVLink's rules and other stations meet it."""

import math
from types import SimpleNamespace
from typing import Any, Literal

import pytest
from boat_rig import DENIED, OK, QGC, UNSUPPORTED, Peer, Rig
from hypothesis import given, settings
from hypothesis import strategies as st
from payload_rig import PayloadRig
from qgc_camera import IDLE, QgcCamera

from companion.core.geo import LatLon
from companion.links.memory import memory_pair
from companion.mavlink.address import Address
from companion.mavlink.codec import Received
from companion.mavlink.dialect import dialect
from companion.payload.camera import Image
from companion.services.camera.component import QUESTIONS
from companion.services.camera.messages import image_captured
from companion.services.payload.rows import ROWS

pytestmark = pytest.mark.slow

CMD, NAN = dialect, math.nan
WAYS: list[Literal["commands", "messages"]] = ["commands", "messages"]


def qgc(rig: Rig, way: Literal["commands", "messages"] = "messages") -> QgcCamera:
    near, far = memory_pair("QGroundControl", True)
    rig.port.offer(near)
    rig.step()
    return QgcCamera(far, way)


def run(rig: Rig, station: QgcCamera, seconds: float) -> None:
    for _ in range(round(seconds / 0.02)):
        rig.step()
        station.step(rig.now_s)


def heard(peer: Peer) -> list[Received]:
    """Messages with their senders."""
    return [one for chunk in peer.link.receive() for one in peer._decoder.feed(chunk)]


@pytest.mark.parametrize("way", WAYS)
def test_qgroundcontrol_shows_the_camera_and_opens_its_stream(way: Literal["commands", "messages"]) -> None:
    rig = PayloadRig()
    station = qgc(rig, way)
    run(rig, station, 4.0)
    assert station.component == 100
    assert bytes(station.info.model_name).rstrip(b"\0") == b"Boat camera"
    assert station.takes_photos
    assert station.video_uri == "rtsp://10.0.0.2:8554/bow"
    assert station.streams[1].resolution_h == 1280
    assert station.storage.status == dialect.STORAGE_STATUS_READY
    assert station.photo_status == IDLE
    assert not station.refused
    assert not station.unanswered
    run(rig, station, 6.0)
    assert station.info is not None  # never silent for five seconds


@pytest.mark.parametrize("way", WAYS)
def test_its_shutter_takes_an_image_that_appears_on_the_map(way: Literal["commands", "messages"]) -> None:
    rig = PayloadRig().ready()
    station = qgc(rig, way)
    run(rig, station, 4.0)
    assert station.press_shutter(rig.now_s)
    assert not station.press_shutter(rig.now_s)  # until the camera is idle
    run(rig, station, 3.0)
    (photo,) = station.photos
    truth = rig.world.truth
    point = rig.scenario.frame.to_local(LatLon(photo.lat / 1e7, photo.lon / 1e7))
    assert math.hypot(point.north_m - truth.north_m, point.east_m - truth.east_m) < 3.0
    assert photo.image_index == photo.camera_id == photo.alt == photo.relative_alt == 0
    assert station.photo_status == IDLE
    assert station.press_shutter(rig.now_s)
    run(rig, station, 3.0)
    assert [one.image_index for one in station.photos] == [0, 1]
    assert not station.refused
    assert not station.unanswered


def test_a_failed_image_is_no_photo_and_is_told() -> None:
    rig = PayloadRig()
    capture = rig.sim.capture
    assert capture is not None
    capture.outcome = "exit code 1"
    station = qgc(rig)
    run(rig, station, 4.0)
    station.press_shutter(rig.now_s)
    run(rig, station, 3.0)
    assert station.photos == []
    assert station.photo_status == IDLE
    assert "Camera: image 0: exit code 1" in rig.peer.texts


def test_an_image_of_an_unknown_place_is_told_without_one() -> None:
    now: Any = SimpleNamespace(unix_s=0.0, now_s=9.0)
    message = image_captured(now, Image(3, 8.5, None, NAN, "x.jpg", ""))
    assert (message.time_boot_ms, message.time_utc, message.lat, message.lon) == (8500, 0, 0, 0)
    assert message.q == [1.0, 0.0, 0.0, 0.0]


ANSWERS = [
    (CMD.MAV_CMD_REQUEST_MESSAGE, (259,), OK, "CAMERA_INFORMATION"),
    (CMD.MAV_CMD_REQUEST_MESSAGE, (269, 1), OK, "VIDEO_STREAM_INFORMATION"),
    (CMD.MAV_CMD_REQUEST_MESSAGE, (269, 2), DENIED, ""),
    (CMD.MAV_CMD_REQUEST_MESSAGE, (270,), OK, "VIDEO_STREAM_STATUS"),
    (CMD.MAV_CMD_REQUEST_MESSAGE, (263, 0), DENIED, ""),
    (CMD.MAV_CMD_REQUEST_MESSAGE, (148,), UNSUPPORTED, ""),
    (CMD.MAV_CMD_REQUEST_MESSAGE, (NAN,), 4, ""),
    (CMD.MAV_CMD_REQUEST_STORAGE_INFORMATION, (0, 1), OK, "STORAGE_INFORMATION"),
    (CMD.MAV_CMD_SET_CAMERA_MODE, (0, 0), OK, ""),
    (CMD.MAV_CMD_SET_CAMERA_MODE, (0, 1), DENIED, ""),
    (CMD.MAV_CMD_VIDEO_START_STREAMING, (1,), OK, ""),
    (CMD.MAV_CMD_VIDEO_STOP_STREAMING, (2,), DENIED, ""),
    (CMD.MAV_CMD_IMAGE_START_CAPTURE, (0, 0, 1), OK, ""),
    (CMD.MAV_CMD_IMAGE_STOP_CAPTURE, (), OK, ""),
    (CMD.MAV_CMD_VIDEO_START_CAPTURE, (), UNSUPPORTED, ""),
    (CMD.MAV_CMD_COMPONENT_ARM_DISARM, (1, 2989), UNSUPPORTED, ""),
    (CMD.MAV_CMD_PREFLIGHT_REBOOT_SHUTDOWN, (1,), UNSUPPORTED, ""),
]


@pytest.mark.parametrize(("number", "params", "result", "name"), ANSWERS)
def test_the_camera_answers_each_command_from_its_own_component(
    number: int, params: tuple[float, ...], result: int, name: str
) -> None:
    rig = PayloadRig()
    rig.run(1.0)
    heard(rig.peer)
    p = [*params, *[0.0] * (7 - len(params))]
    rig.peer.send(dialect.MAVLink_command_long_message(1, 100, number, 0, *p))
    rig.receive()
    got = [one for one in heard(rig.peer) if one.message.get_type() != "STATUSTEXT"]
    assert {one.sender for one in got} == {Address(1, 100)}
    assert got[0].message.get_type() == "COMMAND_ACK"
    assert (got[0].message.command, got[0].message.result) == (number, result)
    assert (got[0].message.target_system, got[0].message.target_component) == QGC
    assert [one.message.get_type() for one in got[1:]] == ([name] if name else [])
    assert not rig.boat.vehicle.armed
    assert not rig.boat.wants_restart


def test_a_resent_capture_takes_one_image_and_a_lost_image_can_be_asked_for() -> None:
    rig = PayloadRig()
    rig.run(1.0)
    capture, shoot = (
        rig.sim.capture,
        dialect.MAVLink_command_long_message(1, 100, 2000, 0, 0, 0, 1, 0, 0, 0, 0),
    )
    assert capture is not None
    for _ in range(2):
        rig.peer.send(shoot)
        rig.run(0.5)
    rig.run(3.0)
    assert [ack.result for ack in rig.peer.said("COMMAND_ACK")] == [OK, OK]
    statuses = rig.peer.said("CAMERA_CAPTURE_STATUS")
    assert [one.image_status for one in statuses] == [1, IDLE], "told when it changes"
    assert len(capture.starts) == 1
    assert len(rig.peer.said("CAMERA_IMAGE_CAPTURED")) == 1
    rig.peer.send(shoot)  # later than a station repeats itself: one more
    rig.run(3.0)
    assert len(capture.starts) == 2
    rig.peer.forget()
    rig.peer.send(dialect.MAVLink_command_long_message(1, 100, 512, 0, 263, 0, 0, 0, 0, 0, 0))
    rig.receive()
    (again,) = rig.peer.said("CAMERA_IMAGE_CAPTURED")
    assert again.image_index == 0


def test_one_image_is_told_once_by_the_camera_alone() -> None:
    """QGroundControl counts CAMERA_FEEDBACK of the autopilot as one more photograph."""
    rig = PayloadRig().ready()
    rig.peer.forget()
    assert rig.ask(CMD.MAV_CMD_DO_DIGICAM_CONTROL, 0, 0, 0, 0, 1) == OK
    rig.run(3.0)
    assert len(rig.peer.said("CAMERA_IMAGE_CAPTURED")) == 1
    assert not rig.peer.said("CAMERA_FEEDBACK")


NUMBERS = sorted({*ROWS, *QUESTIONS, CMD.MAV_CMD_REQUEST_MESSAGE, CMD.MAV_CMD_SET_CAMERA_MODE})


@settings(max_examples=12)  # each with a boat of its own
@given(
    st.sampled_from([1, 100]),
    st.sampled_from(NUMBERS),
    st.lists(
        st.one_of(st.floats(width=32), st.sampled_from([0.0, 1.0, 9.0, 1500.0])), min_size=7, max_size=7
    ),
)
def test_any_payload_command_is_answered_once_and_does_no_harm(
    component: int, number: int, params: list[float]
) -> None:
    rig = PayloadRig()
    rig.run(0.2)
    rig.peer.forget()
    rig.peer.send(dialect.MAVLink_command_long_message(1, component, number, 0, *params))
    rig.run(1.5)
    assert len([ack for ack in rig.peer.said("COMMAND_ACK") if ack.command == number]) == 1
    assert rig.boat.endpoint.faults == rig.boat.net.faults == 0
    assert all(channel.faults == 0 for channel in rig.boat.channels.open.values())
    assert rig.world._motors.left == rig.world._motors.right == 0.0
