"""MANUAL_CONTROL and RC_CHANNELS_OVERRIDE: manual input from stations, with Rover's axes.

RC transmitter input is suspended while a station's input is fresh (`rc/manual_input.py`). Of several
stations, the first one has control for as long as it sends; others are ignored and told once. After a
time-out another may take over.
"""

import math

from companion.config.rc import RcChannel
from companion.core.requests import ManualControl
from companion.core.status_text import Severity, StatusText
from companion.core.units import clamp
from companion.mavlink.dialect import Message
from companion.rc.pulses import deflection
from companion.services.outbox import Origin
from companion.services.telemetry.statustext import StatusTextService
from companion.vehicle.vehicle import Vehicle

_INVALID_AXIS = 0x7FFF
_RC_RELEASED, _RC_IGNORE = 0, 0xFFFF  # "back to the radio", zero without one; "unchanged"
_MOST_TOLD = 32


class ManualControlService:
    """Converts stick positions to manual input. The vehicle applies its time-out."""

    def __init__(self, vehicle: Vehicle, texts: StatusTextService) -> None:
        self._vehicle = vehicle
        self._texts = texts
        self._rc = ManualControl(0.0, 0.0)
        self._rc_s = -math.inf
        self._helm: Origin | None = None  # the station in control, and since when
        self._helm_s = -math.inf
        self._told: set[Origin] = set()  # stations that were told so

    def on_manual_control(self, message: Message, origin: Origin, now_s: float) -> None:
        """ArduPilot Rover's axes: y steers, z is the throttle, both ±1000."""
        if _INVALID_AXIS in (message.y, message.z) or not self._may_steer(origin, now_s):
            return
        throttle, steering = message.z / 1000.0, message.y / 1000.0
        self._vehicle.request(ManualControl(clamp(throttle, -1.0, 1.0), clamp(steering, -1.0, 1.0)))

    def on_rc_override(self, message: Message, origin: Origin, now_s: float) -> None:
        """The transmitter's channels (RCMAP_ROLL, RCMAP_THROTTLE) with its ranges, but without dead zones.

        A released axis returns to the transmitter, or to zero without one. An ignored axis keeps its value
        while that is fresh. With both released, control is released.
        """
        rc = self._vehicle.config.rc
        pulses = (message.chan1_raw, message.chan2_raw, message.chan3_raw, message.chan4_raw)
        steering, throttle = pulses[rc.steering_channel - 1], pulses[rc.throttle_channel - 1]
        if steering == throttle == _RC_IGNORE or not self._may_steer(origin, now_s):
            return
        fresh = now_s - self._rc_s <= self._vehicle.config.failsafe.manual_timeout_s
        released = None if self._vehicle.manual_input.rc.is_heard else 0.0
        before = self._rc if fresh else ManualControl(released, released)
        self._rc = ManualControl(
            _from_rc(throttle, rc.throttle, before.throttle, released),
            _from_rc(steering, rc.steering, before.steering, released),
        )
        self._rc_s = now_s
        self._vehicle.request(self._rc)
        if steering == throttle == _RC_RELEASED:
            self._helm_s = -math.inf

    def forget(self, channel: int) -> None:
        """A channel has closed."""
        self._told = {origin for origin in self._told if origin.channel != channel}
        if self._helm is not None and self._helm.channel == channel:
            self._helm_s = -math.inf

    def _may_steer(self, origin: Origin, now_s: float) -> bool:
        """Whether this is the operator and has control; it takes control if no station has."""
        if self._vehicle.config.identity.operator_system_id not in (0, origin.address.system):
            return False
        if origin == self._helm:
            self._helm_s = now_s
            return True
        if now_s - self._helm_s <= self._vehicle.config.failsafe.manual_timeout_s:
            self._send_busy(origin)
            return False
        last, self._helm, self._helm_s = self._helm, origin, now_s
        self._told.clear()
        if last is not None and last.address != origin.address:
            text = f"Helm: {_name(origin)} took over from {_name(last)}"
            self._texts.notify(Severity.NOTICE, text)
        return True

    def _send_busy(self, origin: Origin) -> None:
        # The same address on another link is probably the same station
        helm = self._helm
        if helm is None or origin.address == helm.address or origin in self._told:
            return
        if len(self._told) < _MOST_TOLD:
            self._told.add(origin)
            text = f"Helm: {_name(helm)} has it, your sticks are ignored"
            self._texts.send_to(origin.channel, StatusText(Severity.WARNING, text))


def _name(origin: Origin) -> str:
    return f"{origin.address.system}/{origin.address.component}"


def _from_rc(pulse_us: int, channel: RcChannel, before: float | None, released: float | None) -> float | None:
    if pulse_us in (_RC_RELEASED, _RC_IGNORE):
        return before if pulse_us == _RC_IGNORE else released
    return deflection(pulse_us, channel, 0)
