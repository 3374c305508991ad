"""Telemetry of vessels heard by AIS: AIS_VESSEL, on a new report and from time to time, as ArduPilot."""

import math
from typing import Final

from companion.core.geo import position_to_e7
from companion.core.readings import AisReading, AisVessel
from companion.core.units import KNOT_M_S, clamp
from companion.mavlink.dialect import Message, dialect
from companion.services.telemetry.motion_messages import heading_cdeg

_AGAIN_S: Final = 30.0  # a vessel that is silent, as ArduPilot
_PERIOD_S: Final = 0.25  # between two messages: 280 bytes a second, all of 100 vessels in 25 s
_UNKNOWN_16, _UNKNOWN_TURN = 0xFFFF, 0x7F
_NEVER: Final = (None, -math.inf)
_FASTEST_M_S: Final = 102.15 * KNOT_M_S  # reported as 102.2 knots or more


def ais_vessel(vessel: AisVessel, now_s: float) -> Message:
    """What is not known has no flag, and ArduPilot's value; sizes are then 0."""
    lat_e7, lon_e7 = position_to_e7(vessel.position)
    speed_m_s, turn_rad_s = vessel.speed_m_s, vessel.turn_rad_s
    sides_m = vessel.bow_m, vessel.stern_m, vessel.port_m, vessel.starboard_m
    has_place = vessel.bow_m + vessel.port_m > 0 and vessel.stern_m + vessel.starboard_m > 0
    flags = {
        dialect.AIS_FLAGS_POSITION_ACCURACY: vessel.is_accurate,
        dialect.AIS_FLAGS_VALID_COG: vessel.course_rad is not None,
        dialect.AIS_FLAGS_VALID_VELOCITY: speed_m_s is not None,
        dialect.AIS_FLAGS_HIGH_VELOCITY: (speed_m_s or 0.0) > _FASTEST_M_S,
        dialect.AIS_FLAGS_VALID_TURN_RATE: turn_rad_s is not None,
        dialect.AIS_FLAGS_TURN_RATE_SIGN_ONLY: turn_rad_s is not None and math.isinf(turn_rad_s),
        dialect.AIS_FLAGS_VALID_DIMENSIONS: has_place,
        dialect.AIS_FLAGS_VALID_CALLSIGN: bool(vessel.callsign),
        dialect.AIS_FLAGS_VALID_NAME: bool(vessel.name),
    }
    bow_m, stern_m, port_m, starboard_m = sides_m if has_place else (0, 0, 0, 0)
    return dialect.MAVLink_ais_vessel_message(
        MMSI=vessel.mmsi,
        lat=lat_e7,
        lon=lon_e7,
        COG=_UNKNOWN_16 if vessel.course_rad is None else heading_cdeg(vessel.course_rad),
        heading=_UNKNOWN_16 if vessel.heading_rad is None else heading_cdeg(vessel.heading_rad),
        velocity=_UNKNOWN_16 if speed_m_s is None else round(100.0 * speed_m_s),
        turn_rate=_turn_rate(turn_rad_s),
        navigational_status=vessel.status,
        type=vessel.kind,
        dimension_bow=bow_m,
        dimension_stern=stern_m,
        dimension_port=port_m,
        dimension_starboard=starboard_m,
        callsign=vessel.callsign.encode("ascii", "replace"),
        name=vessel.name.encode("ascii", "replace"),
        tslc=round(clamp(now_s - vessel.time_s, 0.0, 65535.0)),
        flags=sum(flag for flag, is_set in flags.items() if is_set),
    )


def _turn_rate(turn_rad_s: float | None) -> int:
    """In cdeg/s; only its sign where the rate is not known."""
    if turn_rad_s is None:
        return _UNKNOWN_TURN
    most = 1.0 if math.isinf(turn_rad_s) else _UNKNOWN_TURN - 1.0
    return round(clamp(100.0 * math.degrees(turn_rad_s), -most, most))


class VesselSchedule:
    """Which vessel is due: one that has reported, or was not sent for long; one at a time."""

    def __init__(self, *, is_fitted: bool) -> None:
        self._sent: dict[int, tuple[AisVessel | None, float]] = {}  # by MMSI, with its time
        self._look_s = 0.0 if is_fitted else math.inf

    def has_due(self, now_s: float) -> bool:
        return now_s >= self._look_s

    def due(self, reading: AisReading | None, now_s: float) -> list[Message]:
        self._look_s = now_s + _PERIOD_S
        vessels = () if reading is None else reading.vessels
        sent = self._sent = {one.mmsi: self._sent.get(one.mmsi, _NEVER) for one in vessels}
        waiting = [
            one for one in vessels if sent[one.mmsi][0] is not one or now_s - sent[one.mmsi][1] >= _AGAIN_S
        ]
        if not waiting:
            return []
        one = min(waiting, key=lambda one: sent[one.mmsi][1])
        sent[one.mmsi] = one, now_s
        return [ais_vessel(one, now_s)]
