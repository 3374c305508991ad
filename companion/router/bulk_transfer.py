"""Limits log and file transfers to the links that requested them.

LOG_ENTRY and LOG_DATA have no target and would go out on every link; file replies are addressed, but a
station on several links needs them once.
"""

from companion.mavlink.dialect import dialect
from companion.mavlink.framing import Frame

LIFE_S = 60.0  # of a request; further requests renew it

_LOG_REQUESTS = frozenset(
    (
        dialect.MAVLINK_MSG_ID_LOG_REQUEST_LIST,
        dialect.MAVLINK_MSG_ID_LOG_REQUEST_DATA,
    )
)
_LOG_REPLIES = frozenset((dialect.MAVLINK_MSG_ID_LOG_ENTRY, dialect.MAVLINK_MSG_ID_LOG_DATA))
_FTP = dialect.MAVLINK_MSG_ID_FILE_TRANSFER_PROTOCOL
_FTP_OPCODE_AT = 6  # after network, system, component, sequence and session
_FTP_FIRST_REPLY: int = dialect.MAV_FTP_OPCODE_ACK

DOWNLOAD_IDS = _LOG_REQUESTS | _LOG_REPLIES | {_FTP}
"""The messages for `note` and `limit`; others are unaffected."""


class BulkTransferThrottle:
    """Time of the requests by vehicle and channel."""

    def __init__(self) -> None:
        self._asked_s: dict[tuple[bool, int, int], float] = {}  # by is_file, system, channel

    def note(self, frame: Frame, target_system: int, channel: int, now_s: float) -> None:
        """Record a request in a received frame."""
        if frame.message_id in _LOG_REQUESTS or _is_file_request(frame):
            self._asked_s[frame.message_id == _FTP, target_system, channel] = now_s

    def limit(self, frame: Frame, channels: tuple[int, ...], now_s: float) -> tuple[int, ...]:
        """The channels to which a frame may go."""
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
        """A channel has closed."""
        self._asked_s = {key: at_s for key, at_s in self._asked_s.items() if key[2] != channel}


def _is_file_request(frame: Frame) -> bool:
    if frame.message_id != _FTP:
        return False
    payload = frame.payload
    return (payload[_FTP_OPCODE_AT] if len(payload) > _FTP_OPCODE_AT else 0) < _FTP_FIRST_REPLY
