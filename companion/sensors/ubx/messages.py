"""Decodes the UBX messages in use. Payloads of another length or version are None.

Sources: UBX-13003221 (M8), sections 32.17 "UBX-NAV" and 32.16 "UBX-MON"; u-blox, *ZED-F9P interface
description* (UBX-22008968), section 3.15.
"""

import calendar
import math
import re
from struct import Struct
from typing import Final, NamedTuple

from companion.core.geo import LatLon
from companion.core.readings import GnssFix
from companion.sensors.receiver_clock import ReceiverClock
from companion.sensors.ubx.frames import NAV_DOP, NAV_PVT, UbxFrame

# iTOW … hMSL, hAcc, vAcc, velocity, ground speed, course, sAcc, course accuracy, pDOP, flags3
_PVT: Final = Struct("<IHBBBBBBIiBBBBiiiiIIiiiiiIIHH")
_PVT_LENGTHS: Final = (84, 92)  # 84 before protocol 15
_DOP: Final = Struct("<I7H")
_DOP_LENGTH: Final = 18
_RELPOSNED: Final = Struct("<BxHI3iii4x4b5I4xI")
_DATED: Final = 0x07  # valid date, valid time, leap seconds known
_FIX_OK, _DIFFERENTIAL, _INVALID_POSITION = 0x01, 0x02, 0x01
# PVT's fixType: dead reckoning alone (1) and time only (5) are no fix.
_FIX_TYPES: Final = {2: 2, 3: 3, 4: 3}
_RTK: Final = {1: 5, 2: 6}  # carrier solution: floating, fixed
# Upper bound in s of the age of the differential corrections, by code; 0: not available.
_CORRECTION_AGES_S: Final = (1.0, 2.0, 5.0, 10.0, 15.0, 20.0, 30.0, 45.0, 60.0, 90.0, 120.0, math.inf)
_HEADING_VALID, _NORMALIZED = 0x100, 0x200  # a normalised vector has no length
_PROTOCOL: Final = re.compile(rb"PROTVER[ =](\d+\.\d+)")
_MODULE: Final = re.compile(rb"MOD=([\w-]+)")


class Solution(NamedTuple):
    """NAV-PVT. fix_type as in GnssFix; the accuracies are standard deviations as the receiver states them."""

    time_of_week_s: float
    unix_time_s: float | None  # None until date, time and leap seconds are known
    fix_type: int
    satellites: int
    position: LatLon
    altitude_m: float  # above mean sea level
    horizontal_accuracy_m: float
    vertical_accuracy_m: float
    north_m_s: float
    east_m_s: float
    speed_accuracy_m_s: float
    position_dop: float
    correction_age_s: float | None


class Baseline(NamedTuple):
    """NAV-RELPOSNED: from the reference antenna to the receiver's own. heading_rad is None while invalid."""

    time_of_week_s: float
    length_m: float
    heading_rad: float | None
    accuracy_rad: float
    is_fixed: bool  # the carrier-phase ambiguities are resolved


class Version(NamedTuple):
    """MON-VER. protocol: 13 if not stated, as by u-blox 6."""

    protocol: float
    module: str


def solution(payload: bytes) -> Solution | None:
    """Decode a NAV-PVT; None if it is malformed."""
    if len(payload) not in _PVT_LENGTHS:
        return None
    (
        itow_ms, year, month, day, hour, minute, second, valid, _, nano_s, fix, flags, _, satellites,
        lon_e7, lat_e7, _, altitude_mm, h_acc_mm, v_acc_mm, north_mm_s, east_mm_s, _, _, _, s_acc_mm_s, _,
        dop_e2, flags3,
    ) = _PVT.unpack_from(payload)  # fmt: skip
    has_flags3 = len(payload) == _PVT_LENGTHS[1]
    is_valid = flags & _FIX_OK and not (has_flags3 and flags3 & _INVALID_POSITION)
    fix_type = _FIX_TYPES.get(fix, 1) if is_valid else 1
    if fix_type == 3:
        fix_type = _RTK.get(flags >> 6, 4 if flags & _DIFFERENTIAL else 3)
    is_dated = valid & _DATED == _DATED and 1980 <= year < 2100 and 1 <= month <= 12
    age = flags3 >> 1 & 0x0F if has_flags3 and flags & _DIFFERENTIAL else 0
    if not (abs(lat_e7) <= 900_000_000 and abs(lon_e7) <= 1_800_000_000):
        return None
    return Solution(
        itow_ms * 1e-3,
        calendar.timegm((year, month, day, hour, minute, second)) + nano_s * 1e-9 if is_dated else None,
        fix_type,
        satellites,
        LatLon(lat_e7 * 1e-7, lon_e7 * 1e-7),
        altitude_mm * 1e-3,
        h_acc_mm * 1e-3,
        v_acc_mm * 1e-3,
        north_mm_s * 1e-3,
        east_mm_s * 1e-3,
        s_acc_mm_s * 1e-3,
        dop_e2 * 0.01,
        None if age == 0 else _CORRECTION_AGES_S[min(age, len(_CORRECTION_AGES_S)) - 1],
    )


def horizontal_dop(payload: bytes) -> float | None:
    """The horizontal dilution of precision of a NAV-DOP."""
    if len(payload) != _DOP_LENGTH:
        return None
    return float(_DOP.unpack(payload)[5]) * 0.01


def baseline(payload: bytes) -> Baseline | None:
    """Decode a NAV-RELPOSNED of version 1 (generation 9); version 0 has no heading."""
    if len(payload) != _RELPOSNED.size or payload[0] != 1:
        return None
    fields = _RELPOSNED.unpack(payload)
    length_cm, heading_e5, length_e2, flags = fields[6], fields[7], fields[11], fields[-1]
    return Baseline(
        fields[2] * 1e-3,
        length_cm * 1e-2 + length_e2 * 1e-4,
        math.radians(heading_e5 * 1e-5) if flags & (_HEADING_VALID | _NORMALIZED) == _HEADING_VALID else None,
        math.radians(fields[-2] * 1e-5),
        flags >> 3 & 3 == 2,
    )


def version(payload: bytes) -> Version:
    """Decode a MON-VER of any generation."""
    protocol, module = _PROTOCOL.search(payload), _MODULE.search(payload)
    number = float(protocol[1]) if protocol else 13.0
    return Version(number, module[1].decode() if module else "u-blox")


_DAY_S: Final = 86_400.0
_DOP_LIFE_S: Final = 2.0


class UbxFixAssembler:
    """A NAV-PVT is a fix; the horizontal DOP is that of the latest NAV-DOP."""

    def __init__(self, latency_s: float) -> None:
        """latency_s: shortest time from measurement to arrival."""
        self._clock = ReceiverClock(latency_s)
        self._hdop, self._hdop_s = 99.99, -math.inf

    def feed(self, frame: UbxFrame, time_s: float) -> GnssFix | None:
        """Process a frame that arrived at time_s."""
        if frame.kind == NAV_DOP and (hdop := horizontal_dop(frame.payload)) is not None:
            self._hdop, self._hdop_s = hdop, time_s
        if frame.kind != NAV_PVT or (pvt := solution(frame.payload)) is None:
            return None
        has_velocity = pvt.fix_type > 1
        # The position DOP is an upper bound of the horizontal one.
        hdop = self._hdop if time_s - self._hdop_s <= _DOP_LIFE_S else pvt.position_dop
        return self._clock.stamp(
            GnssFix(
                time_s=time_s,
                position=pvt.position,
                fix_type=pvt.fix_type,
                satellites=pvt.satellites,
                hdop=hdop,
                north_m_s=pvt.north_m_s if has_velocity else None,
                east_m_s=pvt.east_m_s if has_velocity else None,
                altitude_m=pvt.altitude_m,
                horizontal_accuracy_m=pvt.horizontal_accuracy_m,
                unix_time_s=pvt.unix_time_s,
                time_of_day_s=pvt.time_of_week_s % _DAY_S,
                vertical_accuracy_m=pvt.vertical_accuracy_m,
                speed_accuracy_m_s=pvt.speed_accuracy_m_s,
                correction_age_s=pvt.correction_age_s,
            )
        )
