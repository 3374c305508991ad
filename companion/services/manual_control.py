"""MANUAL_CONTROL and RC_CHANNELS_OVERRIDE: the operator's hand on the boat, with Rover's axes."""

import math

from companion.mavlink.dialect import Message
from companion.requests import ManualInput
from companion.units import clamp
from companion.vehicle.vehicle import Vehicle

_INVALID_AXIS = 0x7FFF
_RC_RELEASED, _RC_IGNORE = 0, 0xFFFF  # "back to the radio", which is nobody's hand here; "as it was"
_RC_CENTRE_US, _RC_SPAN_US = 1500.0, 500.0


class ManualControlService:
    """Turns stick positions into manual input. The vehicle lets it go stale by its own time-out."""

    def __init__(self, vehicle: Vehicle) -> None:
        self._vehicle = vehicle
        self._rc = ManualInput(0.0, 0.0)
        self._rc_s = -math.inf

    def on_manual_control(self, message: Message) -> None:
        """ArduPilot Rover's axes: y steers, z is the throttle, both ±1000."""
        if _INVALID_AXIS in (message.y, message.z):
            return
        self._vehicle.request(
            ManualInput(
                throttle=clamp(message.z / 1000.0, -1.0, 1.0), steering=clamp(message.y / 1000.0, -1.0, 1.0)
            )
        )

    def on_rc_override(self, message: Message, now_s: float) -> None:
        """Channel 1 steers, channel 3 is the throttle, 1000 to 2000 µs around 1500.

        A released axis is centred. One to be ignored keeps its value for as long as that is fresh.
        """
        steering, throttle = message.chan1_raw, message.chan3_raw
        if steering == throttle == _RC_IGNORE:
            return
        fresh = now_s - self._rc_s <= self._vehicle.config.failsafe.manual_timeout_s
        before = self._rc if fresh else ManualInput(0.0, 0.0)
        self._rc = ManualInput(_from_rc(throttle, before.throttle), _from_rc(steering, before.steering))
        self._rc_s = now_s
        self._vehicle.request(self._rc)


def _from_rc(pulse_us: int, before: float) -> float:
    if pulse_us in (_RC_RELEASED, _RC_IGNORE):
        return before if pulse_us == _RC_IGNORE else 0.0
    return clamp((pulse_us - _RC_CENTRE_US) / _RC_SPAN_US, -1.0, 1.0)
