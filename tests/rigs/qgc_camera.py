"""QGroundControl's side of the camera protocol, as strict as the program is.

From its sources src/Camera/QGCCameraManager, CameraDiscoveryStateMachine and VehicleCameraControl: which
messages it takes from which component, what it asks in which order and when, and what it then offers. Frames
are parsed by pymavlink, not by our codec. `way`: "commands" asks by the REQUEST_… commands (4.0 to 4.3),
"messages" by REQUEST_MESSAGE first (5.0 on).
"""

import io
from typing import Any, Literal

from pymavlink.dialects.v20 import all as mavlink

from companion.links.interfaces import Link
from companion.mavlink.dialect import Message

VEHICLE, STATION = (1, 1), (255, 190)
FIRST_CAMERA, LAST_CAMERA = 100, 105
ANSWER_S = 1.0  # for a requested message
SILENT_S = 5.0  # then the camera is removed
SETTINGS_S, STREAMS_S, STORAGE_S, STATUS_S = 0.0, 0.25, 2.5, 2.75  # after CAMERA_INFORMATION
IDLE, BUSY, SERIES_IDLE, SERIES_BUSY = range(4)

_OLD = {
    259: mavlink.MAV_CMD_REQUEST_CAMERA_INFORMATION,
    260: mavlink.MAV_CMD_REQUEST_CAMERA_SETTINGS,
    261: mavlink.MAV_CMD_REQUEST_STORAGE_INFORMATION,
    262: mavlink.MAV_CMD_REQUEST_CAMERA_CAPTURE_STATUS,
    269: mavlink.MAV_CMD_REQUEST_VIDEO_STREAM_INFORMATION,
    270: mavlink.MAV_CMD_REQUEST_VIDEO_STREAM_STATUS,
}


class QgcCamera:
    """One camera as QGroundControl knows it; None of its values before the vehicle has sent them."""

    def __init__(self, link: Link, way: Literal["commands", "messages"]) -> None:
        self.component = 0  # of the camera, 0 before a heartbeat
        self.info: Any = None
        self.mode: int | None = None
        self.streams: dict[int, Any] = {}
        self.expected_streams = 1
        self.storage: Any = None
        self.photo_status: int | None = None
        self.stream_status: Any = None
        self.photos: list[Any] = []  # trigger points on the map
        self.refused: list[tuple[int, int]] = []  # (command, result)
        self.unanswered: list[int] = []
        self._link = link
        self._way = way
        self._parser = mavlink.MAVLink(io.BytesIO())
        self._parser.robust_parsing = True
        self._sender = mavlink.MAVLink(io.BytesIO(), *STATION)
        self._heard_s = 0.0
        self._plan: list[tuple[float, int]] = []  # (time, message to ask for)
        self._open: dict[int, float] = {}  # command without an answer, and its deadline
        self._asks_at_s = 0.0

    @property
    def takes_photos(self) -> bool:
        """Whether there is a button for photos."""
        return bool(self.info and self.info.flags & mavlink.CAMERA_CAP_FLAGS_CAPTURE_IMAGE and self.mode == 0)

    @property
    def video_uri(self) -> str:
        """The address that it opens by itself, empty without one."""
        has_stream = self.info and self.info.flags & mavlink.CAMERA_CAP_FLAGS_HAS_VIDEO_STREAM
        if not has_stream or len(self.streams) < self.expected_streams:
            return ""
        (stream, *_) = self.streams.values()
        return str(stream.uri).rstrip("\0") if stream.type == mavlink.VIDEO_STREAM_TYPE_RTSP else ""

    def press_shutter(self, now_s: float, interval_s: float = 0.0, count: int = 1) -> bool:
        """The button; nothing is sent while it is disabled."""
        if not self.takes_photos or self.photo_status != IDLE:
            return False
        self._command(mavlink.MAV_CMD_IMAGE_START_CAPTURE, now_s, 0, interval_s, count)
        self.photo_status = BUSY
        self._plan.append((now_s + 1.0, 262))
        return True

    def step(self, now_s: float) -> None:
        """Take what has come, and ask what is due."""
        for chunk in self._link.receive():
            for message in self._parser.parse_buffer(chunk) or ():
                self._take(message, now_s)
        for command, deadline_s in list(self._open.items()):
            if now_s > deadline_s:
                del self._open[command]
                self.unanswered.append(command)
        if self.info is not None and now_s - self._heard_s > SILENT_S:
            self.component, self.info, self.streams = 0, None, {}
        for one in [one for one in self._plan if one[0] <= now_s]:
            self._plan.remove(one)
            self._ask(one[1], now_s)

    def _take(self, message: Message, now_s: float) -> None:
        system, component = message.get_srcSystem(), message.get_srcComponent()
        if system != VEHICLE[0]:
            return
        if message.get_type() == "CAMERA_IMAGE_CAPTURED" and message.capture_result == 1:
            self.photos.append(message)
        if message.get_type() == "COMMAND_ACK" and component in (self.component, VEHICLE[1]):
            self._take_answer(message, component)
        if not FIRST_CAMERA <= component <= LAST_CAMERA:
            return
        match message.get_type():
            case "HEARTBEAT":
                assert message.type == mavlink.MAV_TYPE_CAMERA
                assert message.autopilot == mavlink.MAV_AUTOPILOT_INVALID
                self._heard_s = now_s
                if not self.component:
                    self.component = component
                    self._ask(259, now_s)
            case "CAMERA_INFORMATION" if component == self.component and self.info is None:
                self.info = message
                assert not str(message.cam_definition_uri).rstrip("\0"), "it would wait for a definition file"
                self._plan = [(now_s + SETTINGS_S, 260), (now_s + STORAGE_S, 261), (now_s + STATUS_S, 262)]
                if message.flags & mavlink.CAMERA_CAP_FLAGS_HAS_VIDEO_STREAM:
                    self._plan.append((now_s + STREAMS_S, 269))
            case "CAMERA_SETTINGS" if self.info is not None:
                self.mode = message.mode_id
            case "STORAGE_INFORMATION" if self.info is not None:
                self.storage = message
            case "CAMERA_CAPTURE_STATUS" if self.info is not None:
                self.photo_status = message.image_status
                if message.image_status == BUSY:
                    self._plan.append((now_s + 1.0, 262))
            case "VIDEO_STREAM_INFORMATION" if self.info is not None:
                self.expected_streams = message.count
                assert 1 <= message.stream_id <= message.count
                self.streams.setdefault(message.stream_id, message)
            case "VIDEO_STREAM_STATUS" if self.info is not None:
                self.stream_status = message

    def _take_answer(self, message: Message, component: int) -> None:
        if component != self.component or (message.target_system, message.target_component) != STATION:
            return
        if (
            self._open.pop(message.command, None) is not None
            and message.result != mavlink.MAV_RESULT_ACCEPTED
        ):
            self.refused.append((message.command, message.result))

    def _ask(self, message_id: int, now_s: float) -> None:
        if self._way == "messages":
            self._command(mavlink.MAV_CMD_REQUEST_MESSAGE, now_s, message_id)
        else:
            is_stream = message_id in (269, 270)
            self._command(_OLD[message_id], now_s, 0 if is_stream else 1)

    def _command(self, number: int, now_s: float, *params: float) -> None:
        p = [*params, *[0.0] * (7 - len(params))]
        message = mavlink.MAVLink_command_long_message(VEHICLE[0], self.component, number, 0, *p)
        assert self._link.send(message.pack(self._sender))
        self._sender.seq = (self._sender.seq + 1) & 0xFF
        self._open[number] = now_s + ANSWER_S
