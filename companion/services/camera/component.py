"""The camera as a MAVLink component of its own, beside the autopilot on the same links.

Ground stations find a camera by a heartbeat of MAV_TYPE_CAMERA from a component of the vehicle, 100 to 105,
and then address it. QGroundControl asks for CAMERA_INFORMATION, at once for CAMERA_SETTINGS, after 250 ms for
the video streams, after 2.5 s for storage and capture status; by REQUEST_MESSAGE or by the older commands,
depending on its version and the try. It removes a camera without a heartbeat for 5 s.
"""

from collections import deque
from dataclasses import dataclass, field
from typing import ClassVar

from companion.mavlink.dialect import Message, component_heartbeat, constants, dialect, message_ids
from companion.payload.camera import Image
from companion.services.camera import messages as build
from companion.services.commands.command import Command, CommandTable, Result, acknowledgement, command_of
from companion.services.commands.payload import act
from companion.services.outbox import Origin, Outbox
from companion.services.statustext import StatusTextService
from companion.services.telemetry.service import TakeSnapshot
from companion.vehicle.payload_control import PayloadControl

_PERIOD_S = 1.0
_RESEND_S = 2.0  # as of the autopilot's commands
_REMEMBERED = 1000  # images that can be asked for again
_COMMANDS = message_ids("COMMAND_LONG", "COMMAND_INT")

# The older commands that ask for a message; the stream is in the first parameter
_ASKED = (
    *("CAMERA_INFORMATION", "CAMERA_SETTINGS", "STORAGE_INFORMATION", "CAMERA_CAPTURE_STATUS"),
    *("VIDEO_STREAM_INFORMATION", "VIDEO_STREAM_STATUS"),
)
_QUESTIONS = dict(zip(constants("MAV_CMD_REQUEST", *_ASKED), message_ids(*_ASKED), strict=True))
_STREAMS = message_ids("VIDEO_STREAM_INFORMATION", "VIDEO_STREAM_STATUS")
_SHOTS = constants(
    *("MAV_CMD", "IMAGE_START_CAPTURE", "IMAGE_STOP_CAPTURE", "DO_DIGICAM_CONTROL", "DO_SET_CAM_TRIGG_DIST")
)
QUESTIONS = frozenset(_QUESTIONS)
"""Commands that change nothing."""


@dataclass(eq=False)
class CameraComponent:
    """Answers commands to the camera, and tells of its images."""

    handled: ClassVar = frozenset(_COMMANDS)

    component: int
    _payload: PayloadControl
    _outbox: Outbox
    _texts: StatusTextService
    _take_snapshot: TakeSnapshot
    _due_s: float = field(default=0.0, init=False)
    _status: int = field(default=0, init=False)
    _done: Command | None = field(default=None, init=False)  # the latest that took images
    _images: deque[Image] = field(default_factory=lambda: deque(maxlen=_REMEMBERED), init=False)

    def __post_init__(self) -> None:
        self._table: CommandTable = {
            **dict.fromkeys(_SHOTS, self._shoot),
            dialect.MAV_CMD_SET_CAMERA_MODE: _set_mode,
            dialect.MAV_CMD_VIDEO_START_STREAMING: self._stream,
            dialect.MAV_CMD_VIDEO_STOP_STREAMING: self._stream,
        }

    def handle(self, message: Message, origin: Origin, now_s: float) -> None:
        """A message addressed to the camera; only commands have an effect."""
        if message.get_msgId() in _COMMANDS:
            self._execute(command_of(message, origin, now_s))

    def open(self, channel: int) -> None:
        self._outbox.send(channel, component_heartbeat(dialect.MAV_TYPE_CAMERA), self.component)

    def tick(self, now_s: float) -> None:
        """Heartbeat, changes of the capture status, and new images."""
        if now_s >= self._due_s:
            self._due_s = now_s + _PERIOD_S
            self._outbox.broadcast(component_heartbeat(dialect.MAV_TYPE_CAMERA), self.component)
        images, status = self._payload.images, build.image_status(self._payload.camera)
        if not images and status == self._status:
            return
        now = self._take_snapshot()
        if now is None:
            return
        if status != self._status:
            self._status = status
            self._outbox.broadcast(build.capture_status(now), self.component)
        for image in images:
            self._images.append(image)
            self._outbox.broadcast(build.image_captured(now, image), self.component)

    def _execute(self, command: Command) -> None:
        """Acknowledge a command, then send the messages that it asks for."""
        answers: list[Message] = []
        if command.number == dialect.MAV_CMD_REQUEST_MESSAGE:
            result = self._request(command.whole(0), command.p[1], answers)
        elif command.number in _QUESTIONS:
            result = self._request(_QUESTIONS[command.number], command.p[0], answers)
        elif (carry_out := self._table.get(command.number)) is not None:
            result = carry_out(command)
        else:
            result = Result.UNSUPPORTED
        channel, asker = command.origin
        self._outbox.send(channel, acknowledgement(command.number, result, asker), self.component)
        for answer in answers:
            self._outbox.send(channel, answer, self.component)

    def _request(self, message_id: int | None, which: float, answers: list[Message]) -> Result:
        """Build a message. which: a stream, 0 for all; or the index of an image."""
        now = self._take_snapshot()
        if now is None or message_id is None:
            return Result.FAILED
        if message_id == dialect.MAVLINK_MSG_ID_CAMERA_IMAGE_CAPTURED:
            answers += [build.image_captured(now, image) for image in self._images if image.index == which]
            return Result.ACCEPTED if answers else Result.DENIED
        if message_id in _STREAMS and which not in (0.0, build.STREAM_ID):
            return Result.DENIED
        builder = build.MESSAGES.get(message_id)
        message = None if builder is None else builder(now)
        if message is None:
            return Result.UNSUPPORTED
        answers.append(message)
        return Result.ACCEPTED

    def _shoot(self, command: Command) -> Result:
        done = self._done
        if done is not None and command.now_s - done.now_s <= _RESEND_S and command.is_same_as(done):
            return Result.ACCEPTED
        result = act(command, self._payload, self._texts)
        if result == Result.ACCEPTED:
            self._done = command
        return result

    def _stream(self, command: Command) -> Result:
        """The stream runs by itself, for whoever opens it."""
        is_ours = bool(self._payload.setting.rtsp) and command.whole(0) in (0, build.STREAM_ID)
        return Result.ACCEPTED if is_ours else Result.DENIED


def _set_mode(command: Command) -> Result:
    """There is one mode, for images."""
    return Result.ACCEPTED if command.whole(1) == dialect.CAMERA_MODE_IMAGE else Result.DENIED
