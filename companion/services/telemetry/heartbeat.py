"""HEARTBEAT: once a second, and at once on change.

A ground station waits 1.3 s for a new mode and 1.5 s for the armed bit; at 1 Hz it would sometimes report a
failure.
"""

from companion.calibration.motor_test import MotorTest
from companion.core.modes import Mode
from companion.mavlink.dialect import Message, dialect
from companion.services.outbox import Outbox
from companion.vehicle.vehicle import Vehicle

_PERIOD_S = 1.0

_BASE_MODE = {
    mode: dialect.MAV_MODE_FLAG_MANUAL_INPUT_ENABLED
    if mode.rules.is_by_hand
    else dialect.MAV_MODE_FLAG_GUIDED_ENABLED
    for mode in Mode
} | {Mode.HOLD: 0}


class HeartbeatService:
    """Announces the boat as an ArduPilot surface boat with Rover's modes."""

    def __init__(self, vehicle: Vehicle, outbox: Outbox, motor_test: MotorTest) -> None:
        self._vehicle = vehicle
        self._outbox = outbox
        self._motor_test = motor_test
        self._due_s = 0.0
        self._reported = (vehicle.mode, vehicle.armed)

    @property
    def _is_armed(self) -> bool:
        """Whether propellers may turn, including a motor test, as with ArduPilot."""
        return self._vehicle.armed or self._motor_test.is_running

    def message(self) -> Message:
        vehicle = self._vehicle
        base_mode = dialect.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED | _BASE_MODE[vehicle.mode]
        if self._is_armed:
            base_mode |= dialect.MAV_MODE_FLAG_SAFETY_ARMED
        # With ACTIVE, stations offer Return and go-to; in HOLD it is STANDBY, so that they offer Disarm
        is_active = vehicle.armed and vehicle.mode is not Mode.HOLD
        return dialect.MAVLink_heartbeat_message(
            type=dialect.MAV_TYPE_SURFACE_BOAT,
            autopilot=dialect.MAV_AUTOPILOT_ARDUPILOTMEGA,
            base_mode=base_mode,
            custom_mode=int(vehicle.mode),
            system_status=dialect.MAV_STATE_ACTIVE if is_active else dialect.MAV_STATE_STANDBY,
            mavlink_version=3,
        )

    def tick(self, now_s: float) -> None:
        if now_s >= self._due_s:
            self._due_s = now_s + _PERIOD_S
            self._broadcast()
        else:
            self.announce_change()

    def announce_change(self) -> None:
        reported, vehicle = self._reported, self._vehicle
        if vehicle.mode is not reported[0] or self._is_armed is not reported[1]:
            self._broadcast()

    def _broadcast(self) -> None:
        self._reported = (self._vehicle.mode, self._is_armed)
        self._outbox.broadcast(self.message())
