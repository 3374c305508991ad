"""Positions of other vehicles: FOLLOW_TARGET, and GLOBAL_POSITION_INT of other systems."""

import math

from companion.core.geo import position_from_e7, yaw_of_quaternion
from companion.core.requests import OtherVehicle
from companion.mavlink.dialect import Message, dialect
from companion.services.outbox import Origin
from companion.vehicle.vehicle import Vehicle

_UNKNOWN_HEADING = 0xFFFF
_STILL_M_S = 0.2  # below it, the course over ground is not a heading
_WHOLE_SYSTEMS = frozenset((dialect.MAV_COMP_ID_AUTOPILOT1, dialect.MAV_COMP_ID_MISSIONPLANNER))
_HAS_VELOCITY = 1 << 1  # FOLLOW_TARGET.est_capabilities: position, velocity, acceleration, attitude
_HAS_ATTITUDE = 1 << 3


class OtherVehicleService:
    """Converts the reports to requests; the vehicle selects the one to follow."""

    def __init__(self, vehicle: Vehicle) -> None:
        self._vehicle = vehicle

    def on_follow_target(self, message: Message, origin: Origin) -> None:
        """FOLLOW_TARGET, sent by ground stations for the operator's position."""
        known = message.est_capabilities
        north_m_s, east_m_s = message.vel[:2] if known & _HAS_VELOCITY else (0.0, 0.0)
        heading = yaw_of_quaternion(message.attitude_q) if known & _HAS_ATTITUDE else None
        self._request(message, origin, north_m_s, east_m_s, heading)

    def on_global_position(self, message: Message, origin: Origin) -> None:
        """GLOBAL_POSITION_INT of another vehicle or a mobile ground station."""
        if origin.address.component not in _WHOLE_SYSTEMS:
            return
        heading = None if message.hdg == _UNKNOWN_HEADING else math.radians(message.hdg * 0.01)
        self._request(message, origin, message.vx * 0.01, message.vy * 0.01, heading)

    def _request(
        self, message: Message, origin: Origin, north_m_s: float, east_m_s: float, heading: float | None
    ) -> None:
        position = position_from_e7(message.lat, message.lon)
        if position is None or not math.isfinite(north_m_s + east_m_s):
            return
        if heading is None or not math.isfinite(heading):
            moves = math.hypot(north_m_s, east_m_s) > _STILL_M_S
            heading = math.atan2(east_m_s, north_m_s) if moves else 0.0
        self._vehicle.request(OtherVehicle(origin.address.system, position, north_m_s, east_m_s, heading))
