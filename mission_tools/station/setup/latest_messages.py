"""The latest message of each part of a boat, and when what it measured last changed."""

from dataclasses import dataclass
from typing import Final

from companion.mavlink.dialect import Message, dialect
from mission_tools.station.view import DOWN, clean

RANGER: Final = "ranger"  # DISTANCE_SENSOR, sideways
SOUNDER: Final = "sounder"  # DISTANCE_SENSOR, downwards
_MOST_PROBES: Final = 16
_PROBE: Final = dialect.MAVLINK_MSG_ID_NAMED_VALUE_FLOAT

# By the message: the field that says when its part measured; without one, the message's arrival counts
_TIMES: Final[dict[int, str]] = {
    dialect.MAVLINK_MSG_ID_BATTERY_STATUS: "",
    dialect.MAVLINK_MSG_ID_DISTANCE_SENSOR: "time_boot_ms",
    dialect.MAVLINK_MSG_ID_EKF_STATUS_REPORT: "",
    dialect.MAVLINK_MSG_ID_GPS_RAW_INT: "time_usec",
    dialect.MAVLINK_MSG_ID_MEMINFO: "",
    _PROBE: "time_boot_ms",
    dialect.MAVLINK_MSG_ID_RC_CHANNELS: "",
    dialect.MAVLINK_MSG_ID_SCALED_IMU: "",
    dialect.MAVLINK_MSG_ID_SERVO_OUTPUT_RAW: "",
    dialect.MAVLINK_MSG_ID_SYSTEM_TIME: "",
    dialect.MAVLINK_MSG_ID_SYS_STATUS: "",
    dialect.MAVLINK_MSG_ID_WATER_DEPTH: "time_boot_ms",
}
MESSAGES: Final = frozenset(_TIMES)


@dataclass(slots=True)
class _Latest:
    message: Message
    measured: object
    changed_s: float


class LatestMessages:
    """The messages of a boat's parts, by message; a distance sensor by its direction, a probe by its name."""

    def __init__(self) -> None:
        self._latest: dict[int | str, _Latest] = {}
        self.probes: list[str] = []

    def on_message(self, message: Message, now_s: float) -> None:
        """Take a message of one of the kinds in MESSAGES."""
        number = message.get_msgId()
        key = self._key(number, message)
        if key is None:
            return
        name = _TIMES[number]
        measured = getattr(message, name) if name else now_s
        latest = self._latest.get(key)
        if latest is None or latest.measured != measured:
            self._latest[key] = _Latest(message, measured, now_s)
        else:
            latest.message = message

    def _key(self, number: int, message: Message) -> int | str | None:
        if number == dialect.MAVLINK_MSG_ID_DISTANCE_SENSOR:
            return SOUNDER if message.orientation == DOWN else RANGER
        if number == dialect.MAVLINK_MSG_ID_BATTERY_STATUS and message.id != 0:
            return None
        if number != _PROBE:
            return number
        name = clean(message.name)
        if name not in self.probes:
            if not name or len(self.probes) >= _MOST_PROBES:
                return None
            self.probes.append(name)
        return f"probe {name}"

    def latest(self, key: int | str) -> Message | None:
        """The latest message of a part."""
        one = self._latest.get(key)
        return None if one is None else one.message

    def age_s(self, key: int | str, now_s: float) -> float | None:
        """How long ago the part measured something new, by the station's clock."""
        one = self._latest.get(key)
        return None if one is None else max(now_s - one.changed_s, 0.0)
