"""Who asked for a log or a file: its many frames go nowhere else.

LOG_ENTRY and LOG_DATA have no target of their own, so they would go out on every link; a file's replies are
addressed, but a station may be heard on several links and wants them once.
"""

from companion.mavlink.dialect import dialect
from companion.mavlink.framing import Frame

LIFE_S = 60.0  # of a request; every further request of the same download renews it

_LOG_REQUESTS = frozenset(
    (
        dialect.MAVLINK_MSG_ID_LOG_REQUEST_LIST,
        dialect.MAVLINK_MSG_ID_LOG_REQUEST_DATA,
    )
)
_LOG_REPLIES = frozenset((dialect.MAVLINK_MSG_ID_LOG_ENTRY, dialect.MAVLINK_MSG_ID_LOG_DATA))
_FTP = dialect.MAVLINK_MSG_ID_FILE_TRANSFER_PROTOCOL
_FTP_OPCODE_AT = 6  # network, system, component, then sequence and session of the inner frame
_FTP_FIRST_REPLY: int = dialect.MAV_FTP_OPCODE_ACK

DOWNLOAD_IDS = _LOG_REQUESTS | _LOG_REPLIES | {_FTP}
"""The messages that `note` and `limit` want to see; for others they do nothing."""


class BulkTransferThrottle:
    """Requests under way, a time stamp for each vehicle and channel that it was asked from."""

    def __init__(self) -> None:
        self._asked_s: dict[tuple[bool, int, int], float] = {}  # by is_file, system, channel

    def note(self, frame: Frame, target_system: int, channel: int, now_s: float) -> None:
        """A frame for a system has come in on a channel; remember it if it asks for a download."""
        if frame.message_id in _LOG_REQUESTS or _is_file_request(frame):
            self._asked_s[frame.message_id == _FTP, target_system, channel] = now_s

    def limit(self, frame: Frame, channels: tuple[int, ...], now_s: float) -> tuple[int, ...]:
        """Those of the channels that a frame may go to."""
        is_file = frame.message_id == _FTP
        if frame.message_id not in _LOG_REPLIES and not (is_file and not _is_file_request(frame)):
            return channels
        system = frame.sender.system
        return tuple(
            channel
            for channel in channels
            if now_s - self._asked_s.get((is_file, system, channel), -LIFE_S) < LIFE_S
        )

    def forget(self, channel: int) -> None:
        """A channel has gone."""
        self._asked_s = {key: at_s for key, at_s in self._asked_s.items() if key[2] != channel}


def _is_file_request(frame: Frame) -> bool:
    if frame.message_id != _FTP:
        return False
    payload = frame.payload
    return (payload[_FTP_OPCODE_AT] if len(payload) > _FTP_OPCODE_AT else 0) < _FTP_FIRST_REPLY
