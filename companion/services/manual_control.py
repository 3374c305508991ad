"""MANUAL_CONTROL and RC_CHANNELS_OVERRIDE: the operator's hand on the boat, with Rover's axes."""

from companion.mavlink.dialect import Message
from companion.requests import ManualInput
from companion.units import clamp
from companion.vehicle.vehicle import Vehicle

_INVALID_AXIS = 0x7FFF
_RC_RELEASED = (0, 0xFFFF)  # "back to the radio" and "ignore": no radio here, so both leave the axis alone
_RC_CENTRE_US, _RC_SPAN_US = 1500.0, 500.0


class ManualControlService:
    """Turns stick positions into manual input. The vehicle lets it go stale by its own time-out."""

    def __init__(self, vehicle: Vehicle) -> None:
        self._vehicle = vehicle
        self._rc = ManualInput(0.0, 0.0)

    def on_manual_control(self, message: Message) -> None:
        """ArduPilot Rover's axes: y steers, z is the throttle, both ±1000."""
        if _INVALID_AXIS in (message.y, message.z):
            return
        self._vehicle.request(
            ManualInput(
                throttle=clamp(message.z / 1000.0, -1.0, 1.0), steering=clamp(message.y / 1000.0, -1.0, 1.0)
            )
        )

    def on_rc_override(self, message: Message) -> None:
        """Channel 1 steers, channel 3 is the throttle, 1000 to 2000 µs around 1500."""
        steering, throttle = message.chan1_raw, message.chan3_raw
        if steering in _RC_RELEASED and throttle in _RC_RELEASED:
            return
        self._rc = ManualInput(
            throttle=self._rc.throttle if throttle in _RC_RELEASED else _from_rc(throttle),
            steering=self._rc.steering if steering in _RC_RELEASED else _from_rc(steering),
        )
        self._vehicle.request(self._rc)


def _from_rc(pulse_us: int) -> float:
    return clamp((pulse_us - _RC_CENTRE_US) / _RC_SPAN_US, -1.0, 1.0)
