"""ArduPilot's JSON interface: servo outputs come in, one JSON object between line ends goes back.

A servo packet is little-endian: magic, frame rate in Hz, frame count, then 16 pulse widths in µs, or 32
behind a magic of their own.

North, east, down in metres, body axes ahead, starboard, down; the boat floats level. Positions are in metres
of ArduPilot's sphere (Location::offset), so that its latitude and longitude are those of the scenario.
Acceleration is what an accelerometer on board feels, so a boat at rest says −g.

ArduPilot does not parse JSON: it looks for a key's name and scans what stands two characters behind it, so
no blank may follow a colon. A key that is left out keeps its last value, so an echo that ends has to be told
as one that is far away. Release 4.7 reads neither `battery` nor `velocity_wind`.
"""

import json
import math
import struct
from typing import NamedTuple

from companion.core.geo import LatLon, Point
from sitl.world.truth import Truth

GRAVITY_M_S2 = 9.80665
_SPHERE_M_DEG = 111_318.845  # a degree of latitude everywhere (ArduPilot, definitions.h: LATLON_TO_M)
NO_ECHO_M = 300.0  # beyond every RNGFND1_MAX; drivers that count centimetres in 16 bits end at 655 m


def sphere_offset(origin: LatLon, place: LatLon) -> Point:
    """How far ArduPilot has to go north and east from the origin to be at a place."""
    north_deg = place.lat_deg - origin.lat_deg
    east_deg = math.remainder(place.lon_deg - origin.lon_deg, 360.0)
    mid_rad = math.radians(origin.lat_deg + 0.5 * north_deg)
    return Point(north_deg * _SPHERE_M_DEG, east_deg * _SPHERE_M_DEG * math.cos(mid_rad))


def state_line(now: Truth, before: Truth, at: Point, range_ahead_m: float | None) -> bytes:
    """The state of now. before: one step earlier, for the acceleration. at: the place, by `sphere_offset`.

    range_ahead_m: what the sonar last heard over the bow, NO_ECHO_M for no echo, None for no sonar.
    """
    dt_s = now.time_s - before.time_s
    north = (now.north_m_s - before.north_m_s) / dt_s if dt_s > 0.0 else 0.0
    east = (now.east_m_s - before.east_m_s) / dt_s if dt_s > 0.0 else 0.0
    c, s = math.cos(now.heading_rad), math.sin(now.heading_rad)
    state: dict[str, object] = {
        "timestamp": now.time_s,
        "imu": {
            "gyro": [0.0, 0.0, now.yaw_rate_rad_s],
            "accel_body": [north * c + east * s, east * c - north * s, -GRAVITY_M_S2],
        },
        "position": [at.north_m, at.east_m, 0.0],
        "attitude": [0.0, 0.0, now.heading_rad],
        "velocity": [now.north_m_s, now.east_m_s, 0.0],
        "velocity_wind": [now.wind_north_m_s, now.wind_east_m_s, 0.0],
        "battery": {"voltage": now.voltage_v, "current": now.current_a},
    }
    if range_ahead_m is not None:
        state["rng_1"] = range_ahead_m
    return b"\n" + json.dumps(state, allow_nan=False, separators=(",", ":")).encode() + b"\n"


MAGIC_16, MAGIC_32 = 18458, 29569
_HEAD = struct.Struct("<HHI")
_CHANNELS = {MAGIC_16: 16, MAGIC_32: 32}
_CENTRE_US, _SPAN_US = 1500.0, 500.0
_LEAST_US, _MOST_US = 800, 2200


class ServoPacket(NamedTuple):
    """One frame. rate_hz: how often the other side wants its physics stepped; pulses_us: 0 is no pulse."""

    rate_hz: int
    frame: int
    pulses_us: tuple[int, ...]

    def has_pulse(self, channel: int) -> bool:
        """Whether a channel, counted from 1, has a pulse that a servo output can send."""
        return _LEAST_US <= self.pulses_us[channel - 1] <= _MOST_US

    def share(self, channel: int) -> float:
        """What a channel, counted from 1, asks of a motor: −1..1. Without a pulse it is 0."""
        if not self.has_pulse(channel):
            return 0.0
        return min(max((self.pulses_us[channel - 1] - _CENTRE_US) / _SPAN_US, -1.0), 1.0)


def parse_servos(data: bytes) -> ServoPacket | None:
    """Read a datagram; None for anything that is not one of these packets, whole."""
    if len(data) < _HEAD.size:
        return None
    magic, rate_hz, frame = _HEAD.unpack_from(data)
    count = _CHANNELS.get(magic)
    if count is None or len(data) != _HEAD.size + 2 * count or rate_hz == 0:
        return None
    return ServoPacket(rate_hz, frame, struct.unpack_from(f"<{count}H", data, _HEAD.size))
