"""GPS_RTCM_DATA and GPS_INJECT_DATA: differential corrections from a station to the GNSS receiver.

A long RTCM message comes in up to four fragments of 180 bytes, with their number and the number of the
message. The receiver gets whole frames with a valid checksum only. One sender at a time: another is accepted
once the first has been silent for a while, because a receiver takes the corrections of one base.
"""

import math
from collections import deque
from typing import Final

from msgspec import Struct

from companion.core.status_text import Severity
from companion.hal.interfaces import CorrectionInput
from companion.mavlink.address import Address
from companion.mavlink.dialect import Message
from companion.sensors.rtcm import RtcmReader, message_type
from companion.services.outbox import Origin
from companion.services.statustext import StatusTextService

_FRAGMENTED: Final = 0x01
_SENDER_S: Final = 5.0  # corrections come every second, or every five seconds on slow links
_MESSAGE_S: Final = 2.0  # longest time between two fragments of one message
_REPEAT_S: Final = 0.5  # the same frame on another link; stations repeat a frame after a second or more
_STOPPED_S: Final = 30.0  # a fixed solution lasts for a minute without corrections
_MOST_RECENT: Final = 16


class CorrectionStatus(Struct, frozen=True):
    """What has come so far.

    lost: messages with a missing fragment; malformed: frames with a wrong checksum; repeated: by another
    link; refused: by the receiver, faster than its line. age_s: since the latest frame, None before.
    types: of the latest frames.
    """

    sender: str
    frames: int
    bytes: int
    lost: int
    malformed: int
    repeated: int
    refused: int
    age_s: float | None
    types: tuple[int, ...]


class CorrectionService:
    """Assembles frames and passes them to the receiver."""

    def __init__(self, receiver: CorrectionInput | None, texts: StatusTextService) -> None:
        """receiver: None if it takes no corrections."""
        self._receiver = receiver
        self._texts = texts
        self._reader = RtcmReader()
        self._sender: Address | None = None
        self._heard_s = self._frame_s = self._fragment_s = -math.inf
        self._sequence = -1
        self._next = 0  # number of the fragment to read next
        self._fragments: dict[int, bytes] = {}  # of the present message
        self._recent: deque[tuple[float, bytes]] = deque(maxlen=_MOST_RECENT)
        self._frames = self._bytes = self._lost = self._repeated = self._refused = 0
        self._is_flowing = self._has_told_none = False

    def on_rtcm_data(self, message: Message, origin: Origin, now_s: float) -> None:
        """A message or a fragment of one."""
        if message.len > len(message.data) or not self._admits(origin, now_s):
            return
        data, flags = bytes(message.data[: message.len]), message.flags
        if flags & _FRAGMENTED:
            self._on_fragment(flags >> 1 & 3, flags >> 3, data, now_s)
            return
        # Whole frames are not taken for the rest of a broken one; some senders cut a stream anywhere.
        alone = RtcmReader()
        frames = alone.feed(data)
        if frames and not alone.is_partial:
            self._begin(-1)
            for frame in frames:
                self._forward(frame, now_s)
        else:
            self._read(data, now_s)

    def on_inject_data(self, message: Message, origin: Origin, now_s: float) -> None:
        """The older message: pieces of any size."""
        if message.len <= len(message.data) and self._admits(origin, now_s):
            self._read(bytes(message.data[: message.len]), now_s)

    def tick(self, now_s: float) -> None:
        """Tell when corrections have stopped."""
        if self._is_flowing and now_s - self._frame_s > _STOPPED_S:
            self._is_flowing = False
            self._texts.notify(Severity.NOTICE, "GNSS corrections stopped")

    def status(self, now_s: float) -> CorrectionStatus | None:
        """None before the first frame."""
        if self._sender is None:
            return None
        return CorrectionStatus(
            self._name,
            self._frames,
            self._bytes,
            self._lost,
            self._reader.malformed,
            self._repeated,
            self._refused,
            None if self._frame_s == -math.inf else now_s - self._frame_s,
            tuple(sorted({message_type(frame) for _, frame in self._recent})),
        )

    def _admits(self, origin: Origin, now_s: float) -> bool:
        if self._receiver is None:
            if not self._has_told_none:
                self._has_told_none = True
                self._texts.notify(Severity.WARNING, "GNSS corrections: the receiver's driver takes none")
            return False
        if origin.address != self._sender:
            if now_s - self._heard_s <= _SENDER_S:
                return False
            self._sender = origin.address
            self._begin(-1)
        self._heard_s = now_s
        return True

    @property
    def _name(self) -> str:
        return "" if self._sender is None else f"{self._sender.system}/{self._sender.component}"

    def _begin(self, sequence: int) -> None:
        """Drop what is left of the message before."""
        self._lost += self._reader.is_partial or len(self._fragments) > self._next
        self._sequence, self._next = sequence, 0
        self._fragments.clear()
        self._reader.forget()

    def _on_fragment(self, number: int, sequence: int, data: bytes, now_s: float) -> None:
        known = self._fragments.get(number)
        is_late = now_s - self._fragment_s > _MESSAGE_S
        if sequence != self._sequence or is_late or (known is not None and known != data):
            self._begin(sequence)
        elif known is not None:
            return
        self._fragment_s = now_s
        self._fragments[number] = data
        while self._next in self._fragments:
            self._next += 1
            self._read(self._fragments[self._next - 1], now_s)

    def _read(self, data: bytes, now_s: float) -> None:
        for frame in self._reader.feed(data):
            self._forward(frame, now_s)

    def _forward(self, frame: bytes, now_s: float) -> None:
        if any(known == frame and now_s - at_s <= _REPEAT_S for at_s, known in self._recent):
            self._repeated += 1
            return
        self._recent.append((now_s, frame))
        if self._receiver is None or not self._receiver.inject(frame):
            self._refused += 1
            return
        self._frames += 1
        self._bytes += len(frame)
        self._frame_s = now_s
        if not self._is_flowing:
            self._is_flowing = True
            self._texts.notify(Severity.INFO, f"GNSS corrections from {self._name}")
