"""Telemetry of the payload: relays and winch. Servos are in SERVO_OUTPUT_RAW."""

import math

from companion.autopilot.snapshot import Snapshot
from companion.mavlink.dialect import Message, dialect

_UNKNOWN = math.nan
_UNKNOWN_TEMPERATURE = 0x7FFF


def relay_status(now: Snapshot) -> Message | None:
    """Relays, lights and horns, by number; None without one."""
    is_on, exists = now.payload.units.relays()
    return dialect.MAVLink_relay_status_message(now.boot_ms, is_on, exists) if exists else None


def winch_status(now: Snapshot) -> Message | None:
    """The first winch; None without one."""
    winch = now.payload.units.winch
    if winch is None:
        return None
    flags = 0 if winch.fault else dialect.MAV_WINCH_STATUS_HEALTHY
    if winch.is_moving:
        flags |= dialect.MAV_WINCH_STATUS_MOVING
    elif winch.out_m == 0.0:
        flags |= dialect.MAV_WINCH_STATUS_FULLY_RETRACTED
    return dialect.MAVLink_winch_status_message(
        time_usec=now.boot_us,
        line_length=winch.out_m,
        speed=winch.speed_m_s,
        tension=_UNKNOWN,
        voltage=_UNKNOWN,
        current=_UNKNOWN,
        temperature=_UNKNOWN_TEMPERATURE,
        status=flags,
    )
