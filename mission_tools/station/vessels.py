"""The vessels that a boat hears by AIS, from its AIS_VESSEL messages."""

from typing import Final

from companion.core.geo import position_from_e7
from companion.core.status_text import one_line
from companion.core.units import KNOT_M_S
from companion.mavlink.dialect import Message, dialect
from mission_tools.station.messages import Place, Vessel

_LIFE_MS: Final = 90_000  # the boat repeats each every 30 s, and 100 vessels take 25 s
_MOST: Final = 100
_UNDER_WAY_M_S: Final = 2.0 * KNOT_M_S  # ITU-R M.1371-5, table 2; the course of one at rest is noise
_COURSE, _SPEED, _SIZE, _NAME = (
    getattr(dialect, f"AIS_FLAGS_VALID_{name}") for name in ("COG", "VELOCITY", "DIMENSIONS", "NAME")
)


class HeardVessels:
    """By their number. Messages are untrusted, as those of `View`."""

    def __init__(self) -> None:
        self._heard: dict[str, tuple[int, Vessel]] = {}  # with the boat's clock

    def ingest(self, message: Message, boot_ms: int) -> None:
        at = position_from_e7(message.lat, message.lon)
        if at is None:
            return
        flags, number = message.flags, f"{message.MMSI:09d}"
        name = one_line(str(message.name).split("\0", 1)[0]).strip() if flags & _NAME else ""
        course_deg = message.COG / 100.0 if flags & _COURSE and message.COG < 36000 else None
        speed_m_s = message.velocity / 100.0 if flags & _SPEED else None
        ahead_deg = None if speed_m_s is not None and speed_m_s <= _UNDER_WAY_M_S else course_deg
        self._heard.pop(number, None)
        self._heard[number] = (
            boot_ms,
            Vessel(
                name=name or number,
                place=Place(lat=at.lat_deg, lon=at.lon_deg),
                course_deg=course_deg,
                heading_deg=message.heading / 100.0 if message.heading < 36000 else ahead_deg,
                speed_m_s=speed_m_s,
                length_m=message.dimension_bow + message.dimension_stern if flags & _SIZE else None,
            ),
        )
        if len(self._heard) > _MOST:
            del self._heard[next(iter(self._heard))]

    def now(self, boot_ms: int) -> dict[str, Vessel]:
        """Those that the boat has told of lately. A clock that went back is a new start."""
        self._heard = {key: one for key, one in self._heard.items() if 0 <= boot_ms - one[0] <= _LIFE_MS}
        return {key: vessel for key, (_, vessel) in self._heard.items()}
