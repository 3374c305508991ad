"""Converts the reports of gpsd to fixes. Malformed input is counted, never raised.

Field meanings: gpsd_json(5) of gpsd 3.25, sections "TPV" and "SKY". Error estimates there have an unknown
confidence level; eph is used as a standard deviation, which is on the safe side. eps, which gpsd computes
from two positions where a receiver states none, is not used.
"""

import datetime
import math
from typing import Final

import msgspec

from companion.core.geo import LatLon
from companion.core.readings import GnssFix
from companion.sensors.receiver_clock import ReceiverClock

WATCH: Final = b'?WATCH={"enable":true,"json":true};\n'
_LONGEST_LINE: Final = 16_384  # gpsd_json(5): 10,240
_NO_FIX, _FIX_2D, _FIX_3D = 1, 2, 3
_STATUS_FIX: Final = {2: 4, 3: 6, 4: 5}  # DGPS, RTK fixed, RTK floating
_DEAD_RECKONING: Final = 5
_UNKNOWN_HDOP: Final = 99.99
_SKY_LIFE_S: Final = 5.0
# Where a receiver states no error, gpsd sends the HDOP times this many metres, without and with DGPS: 95 %
# bounds that are ten times the errors of today (P_UERE_NO_DGPS and P_UERE_WITH_DGPS of its source).
_GUESSES_M: Final = (19.0, 4.75)
_SAME_M: Final = 0.01


class _Tpv(msgspec.Struct, tag_field="class", tag="TPV"):
    mode: int
    status: int = 0
    time: str = ""
    lat: float | None = None
    lon: float | None = None
    altMSL: float | None = None  # noqa: N815
    alt: float | None = None
    eph: float | None = None
    epx: float | None = None
    epy: float | None = None
    epv: float | None = None
    track: float | None = None
    speed: float | None = None
    velN: float | None = None  # noqa: N815
    velE: float | None = None  # noqa: N815
    dgpsAge: float | None = None  # noqa: N815


class _Satellite(msgspec.Struct):
    used: bool = False


class _Sky(msgspec.Struct, tag_field="class", tag="SKY"):
    hdop: float | None = None
    uSat: int | None = None  # noqa: N815
    satellites: list[_Satellite] = []


class _Other(msgspec.Struct):
    """Any report, such as VERSION, DEVICES or PPS."""

    name: str = msgspec.field(name="class")


_FAULTS: Final = (msgspec.MsgspecError, UnicodeDecodeError)
_REPORTS: Final = msgspec.json.Decoder(_Tpv | _Sky)
_OTHERS: Final = msgspec.json.Decoder(_Other)


class GpsdReader:
    """Splits a byte stream into reports, and these into fixes."""

    def __init__(self, latency_s: float) -> None:
        """latency_s: shortest time from measurement to arrival."""
        self.malformed = 0
        self._held = b""
        self._clock = ReceiverClock(latency_s)
        self._position = LatLon(0.0, 0.0)
        self._hdop, self._satellites, self._sky_s = _UNKNOWN_HDOP, 0, -math.inf
        self._epoch = ("", 0)

    def feed(self, data: bytes, time_s: float) -> list[GnssFix]:
        """The fixes of complete lines that arrived at time_s; a partial line is kept."""
        *lines, self._held = (self._held + data).split(b"\n")
        if len(self._held) > _LONGEST_LINE:
            self._held = b""
            self.malformed += 1
        return [fix for line in lines if (fix := self._parse(line.strip(), time_s)) is not None]

    def forget(self) -> None:
        """Drop a partial line after a reconnect."""
        self._held = b""

    def _parse(self, line: bytes, time_s: float) -> GnssFix | None:
        if not line:
            return None
        try:
            report = _REPORTS.decode(line)
        except _FAULTS:
            self._count_malformed(line)
            return None
        if isinstance(report, _Sky):
            self._ingest_sky(report, time_s)
            return None
        return self._fix(report, time_s)

    def _count_malformed(self, line: bytes) -> None:
        try:
            is_other = _OTHERS.decode(line).name not in ("TPV", "SKY")
        except _FAULTS:
            is_other = False
        self.malformed += not is_other

    def _ingest_sky(self, sky: _Sky, time_s: float) -> None:
        if sky.hdop is not None:
            self._hdop = sky.hdop
        if sky.uSat is not None or sky.satellites:
            used = sum(one.used for one in sky.satellites)
            self._satellites = used if sky.uSat is None else max(sky.uSat, 0)
        self._sky_s = time_s

    def _fix(self, tpv: _Tpv, time_s: float) -> GnssFix | None:
        # gpsd sends several TPV of one epoch, the later ones with more fields where a receiver dribbles.
        epoch = (tpv.time, tpv.mode)
        if tpv.time and epoch == self._epoch:
            return None
        fix_type = _NO_FIX
        if tpv.mode >= _FIX_2D and tpv.status != _DEAD_RECKONING and (position := _position(tpv)) is not None:
            self._position = position
            fix_type = _STATUS_FIX.get(tpv.status, _FIX_3D) if tpv.mode >= _FIX_3D else _FIX_2D
        self._epoch = epoch
        north_m_s, east_m_s = _velocity(tpv) if fix_type > _NO_FIX else (None, None)
        utc = _utc(tpv.time)
        is_seen = time_s - self._sky_s <= _SKY_LIFE_S
        return self._clock.stamp(
            GnssFix(
                time_s=time_s,
                position=self._position,
                fix_type=fix_type,
                satellites=self._satellites if is_seen else 0,
                hdop=self._hdop if is_seen else _UNKNOWN_HDOP,
                north_m_s=north_m_s,
                east_m_s=east_m_s,
                altitude_m=tpv.altMSL or tpv.alt or 0.0,
                horizontal_accuracy_m=self._accuracy_m(tpv),
                unix_time_s=utc if fix_type > _NO_FIX else None,
                time_of_day_s=None if utc is None else utc % 86_400.0,
                vertical_accuracy_m=tpv.epv,
                correction_age_s=tpv.dgpsAge,
            )
        )

    def _accuracy_m(self, tpv: _Tpv) -> float | None:
        """The horizontal accuracy that the receiver states, None if it states none."""
        eph_m = tpv.eph
        if eph_m is None:
            return math.hypot(tpv.epx, tpv.epy) if tpv.epx is not None and tpv.epy is not None else None
        is_guess = any(abs(eph_m - one_m * self._hdop) < _SAME_M for one_m in _GUESSES_M)
        return None if is_guess else eph_m


def _position(tpv: _Tpv) -> LatLon | None:
    if tpv.lat is None or tpv.lon is None or not (abs(tpv.lat) <= 90.0 and abs(tpv.lon) <= 180.0):
        return None
    return LatLon(tpv.lat, tpv.lon)


def _velocity(tpv: _Tpv) -> tuple[float | None, float | None]:
    """North and east. A receiver at rest has a speed without a track, which is no velocity."""
    if tpv.velN is not None and tpv.velE is not None:
        return tpv.velN, tpv.velE
    if tpv.speed is None or tpv.track is None:
        return None, None
    track_rad = math.radians(tpv.track)
    return tpv.speed * math.cos(track_rad), tpv.speed * math.sin(track_rad)


def _utc(text: str) -> float | None:
    """Unix time of an ISO 8601 stamp, None if it is none."""
    try:
        stamp = datetime.datetime.fromisoformat(text)
    except ValueError:
        return None
    return stamp.timestamp() if stamp.tzinfo is not None else None
