"""Converts AIS sentences (IEC 61162-1) to vessels (ITU-R M.1371-5). Malformed input is counted, not raised.

The types 1, 2, 3, 18, 19 and 27 give positions, 5, 19 and 24 static data. Base stations (4) show that the
receiver hears; aids to navigation (21), aircraft (9) and texts are left out.
"""

import math
from collections.abc import Callable
from heapq import nsmallest
from typing import Any, Final, TypeVar

from msgspec.structs import replace

from companion.core.geo import LatLon, geodesic_m, longitude_difference_deg
from companion.core.readings import AisReading, AisVessel
from companion.core.units import KNOT_M_S
from companion.sensors.nmea.sentences import LineReader

LIFE_S: Final = 600.0  # without a position; ArduPilot's AIS_TIME_OUT
# Two channels of 2,250 slots a minute, six reports of each vessel under way (ITU-R M.1371-5, annex 2)
_MOST_VESSELS: Final = 750
_MOST_NEAR: Final = 100  # the largest AIS_LIST_MAX of ArduPilot
_POSITIONS: Final = frozenset({1, 2, 3, 18, 19, 27})
_STATIC: Final = frozenset({5, 19, 24})
_CLASS_B: Final = frozenset({18, 19})
_LONG_RANGE: Final = 27  # in tenths of a minute
_ERRORS_M: Final = (13.0, 10.0)  # 95 %, without and with corrections (IMO MSC.112(73), MSC.114(73))
_COARSE_M: Final = 0.1 / 60.0 * 111e3
_MOST_PARTS: Final = 10  # unfinished messages: as many as there are sequential numbers
_TOGETHER_S: Final = 1.0  # the sentences of a message come back to back
_FASTEST_M_S: Final = 50.0 * KNOT_M_S  # of a vessel that does not tell its speed: the fastest ferries
_GAINS: Final = 1.5  # it may go so much faster between two reports
_LATE_S: Final = 3.0  # a report may come so much later than another
_SIDE_ONLY: Final = 127.0  # of a turn: more than 10° a minute
_DEGREE: Final = math.radians(1.0)
Key = TypeVar("Key")
Kept = TypeVar("Kept")


class AisReader(LineReader):
    """Keeps the vessels of a receiver's sentences.

    `malformed`: sentences with a wrong checksum or form, or without the parts before them, and messages that
    cannot be decoded.
    """

    def __init__(self, decode: Callable[..., Any], own_mmsi: int = 0) -> None:
        """decode: pyais' own, which gives the message of its sentences. It may raise anything."""
        super().__init__()
        self._decode = decode
        self._own_mmsi, self._transponder_mmsi = own_mmsi, 0
        self._parts: dict[tuple[bytes, ...], tuple[float, list[bytes]]] = {}
        self._static: dict[int, dict[str, Any]] = {}  # by MMSI, the latest heard last
        self._vessels: dict[int, AisVessel] = {}

    def feed(self, data: bytes, time_s: float) -> AisReading | None:
        """Process bytes received at time_s; None if they complete no message."""
        is_heard = False
        for line in self.lines(data):
            sentence = line[max(line.rfind(b"!"), 0) :]  # a tag block or half a sentence may precede it
            if sentence[3:6] in (b"VDM", b"VDO"):
                try:
                    is_heard |= self._hear(sentence, time_s)
                except Exception:
                    self.malformed += 1
        if not is_heard:
            return None
        known = (one for one in self._vessels.values() if time_s - one.time_s <= LIFE_S)
        return AisReading(time_s, tuple(one for one in known if not one.is_doubtful))

    def forget(self) -> None:
        super().forget()
        self._parts.clear()

    def _hear(self, sentence: bytes, time_s: float) -> bool:
        """Whether a sentence completes a message."""
        _, count, number, sequence, channel, _, _ = sentence.split(b",")
        key = count, sequence, channel
        begun_s, parts = (time_s, []) if number == b"1" else self._parts.pop(key)
        if time_s - begun_s > _TOGETHER_S:
            raise ValueError("the parts before it are another message's")
        parts.append(sentence)
        if number != count:
            _keep(self._parts, key, (begun_s, parts), _MOST_PARTS)
            return False
        message = self._decode(*parts, error_if_checksum_invalid=True)
        self._ingest(message, time_s, is_own=sentence[3:6] == b"VDO")
        return True

    def _ingest(self, message: Any, time_s: float, *, is_own: bool) -> None:  # noqa: ANN401 (one class a type)
        mmsi, kind = int(message.mmsi), message.msg_type
        if is_own:
            self._transponder_mmsi = mmsi
        if mmsi in (self._own_mmsi, self._transponder_mmsi):
            self._vessels.pop(mmsi, None)
            return
        if kind in _STATIC:
            static = self._static.pop(mmsi, {}) | _static(message)
            _keep(self._static, mmsi, static, _MOST_VESSELS)
            if mmsi in self._vessels:
                self._vessels[mmsi] = replace(self._vessels[mmsi], **static)
        if kind in _POSITIONS and abs(message.lat) <= 90.0 and abs(message.lon) <= 180.0:
            old = self._vessels.pop(mmsi, None)
            new = _vessel(message, mmsi, time_s, self._static.get(mmsi, {}))
            new = replace(new, is_doubtful=old is not None and _has_jumped(old, new))
            _keep(self._vessels, mmsi, new, _MOST_VESSELS)


def nearest(reading: AisReading, here: LatLon) -> AisReading:
    """Without the vessels that are farther away than the nearest hundred."""
    if len(reading.vessels) <= _MOST_NEAR:
        return reading
    east = math.cos(math.radians(here.lat_deg))

    def off(vessel: AisVessel) -> float:
        east_deg = longitude_difference_deg(vessel.position.lon_deg, here.lon_deg)
        return math.hypot(vessel.position.lat_deg - here.lat_deg, east * east_deg)

    return replace(reading, vessels=tuple(nsmallest(_MOST_NEAR, reading.vessels, off)))


def _keep(table: dict[Key, Kept], key: Key, value: Kept, most: int) -> None:
    """Add what was not there; the oldest gives way."""
    table[key] = value
    if len(table) > most:
        del table[next(iter(table))]


def _static(message: Any) -> dict[str, Any]:  # noqa: ANN401
    """The two parts of a type 24 have different fields."""
    names = {"shipname": "name", "callsign": "callsign", "ship_type": "kind"}
    names |= {f"to_{side}": f"{side}_m" for side in ("bow", "stern", "port", "starboard")}
    told = {ours: getattr(message, theirs, None) for theirs, ours in names.items()}
    return {name: value for name, value in told.items() if value is not None}


def _vessel(message: Any, mmsi: int, time_s: float, static: dict[str, Any]) -> AisVessel:  # noqa: ANN401
    is_coarse = message.msg_type == _LONG_RANGE
    turn_rad_s = _known(message, "turn", _DEGREE / 60.0, _SIDE_ONLY + 1.0, -_SIDE_ONLY)
    if turn_rad_s is not None and abs(message.turn) == _SIDE_ONLY:
        turn_rad_s = math.copysign(math.inf, turn_rad_s)
    return AisVessel(
        mmsi=mmsi,
        time_s=time_s,
        position=LatLon(message.lat, message.lon),
        speed_m_s=_known(message, "speed", KNOT_M_S, 63.0 if is_coarse else 102.3),
        course_rad=_known(message, "course", _DEGREE, 360.0),
        heading_rad=_known(message, "heading", _DEGREE, 360.0),
        turn_rad_s=turn_rad_s,
        status=int(getattr(message, "status", 15)),
        is_class_b=message.msg_type in _CLASS_B,
        is_accurate=bool(message.accuracy),
        error_m=_COARSE_M if is_coarse else _ERRORS_M[bool(message.accuracy)],
        **static,
    )


def _has_jumped(old: AisVessel, new: AisVessel) -> bool:
    """Whether no vessel of these speeds gets from one position to the other in the time between."""
    fastest_m_s = max(_FASTEST_M_S if one.speed_m_s is None else one.speed_m_s for one in (old, new))
    way_m = _GAINS * fastest_m_s * (new.time_s - old.time_s + _LATE_S)
    return geodesic_m(old.position, new.position) > way_m + 2.0 * (old.error_m + new.error_m)


def _known(message: Any, name: str, unit: float, limit: float, least: float = 0.0) -> float | None:  # noqa: ANN401
    """A number of a message in a unit; None where the message has none, or says that it is not known."""
    value = getattr(message, name, None)
    return float(value) * unit if value is not None and least <= value < limit else None
