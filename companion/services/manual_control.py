"""MANUAL_CONTROL and RC_CHANNELS_OVERRIDE: manual input from stations, with Rover's axes.

RC transmitter input is suspended while a station's input is fresh (`rc/manual_input.py`). Of several
stations, the first one has control for as long as it sends; others are ignored and told once. After a
time-out another may take over.

A value that is no command (a pulse that no servo takes, an axis beyond ±1000) means that the station's input
is lost: its sticks are stale at once, and the failsafe follows.
"""

import math
from typing import Final

from companion.core.requests import ManualControl
from companion.core.status_text import Severity, StatusText
from companion.mavlink.dialect import Message
from companion.rc.pulses import deflection, is_override
from companion.services.outbox import Origin
from companion.services.statustext import StatusTextService
from companion.vehicle.vehicle import Vehicle

_INVALID_AXIS: Final = 0x7FFF
_FULL: Final = 1000  # of an axis
# Of an override's channels 1 to 8 and 9 to 18: what gives them back to the receiver, what leaves them
_RELEASED: Final = (0, 0xFFFE)
_UNCHANGED: Final = ((0xFFFF,), (0, 0xFFFF))
_CHANNELS: Final = 18
_MOST_TOLD: Final = 32


class ManualControlService:
    """Converts stick positions to manual input. The vehicle applies its time-out."""

    def __init__(self, vehicle: Vehicle, texts: StatusTextService) -> None:
        self._vehicle = vehicle
        self._texts = texts
        self._helm: Origin | None = None  # the station in control, and since when
        self._helm_s = -math.inf
        self._told: set[Origin] = set()  # stations that were told so

    def on_manual_control(self, message: Message, origin: Origin, now_s: float) -> None:
        """ArduPilot Rover's axes: y steers, z is the throttle, both ±1000.

        An invalid axis is the transmitter's, or centred without one.
        """
        axes = (message.z, message.y)
        if axes == (_INVALID_AXIS, _INVALID_AXIS) or not self._may_steer(origin, now_s):
            return
        throttle, steering = (None if axis == _INVALID_AXIS else axis / _FULL for axis in axes)
        if max(abs(throttle or 0.0), abs(steering or 0.0)) > 1.0:
            self._vehicle.manual_input.invalidate()
            return
        self._vehicle.request(ManualControl(throttle, steering))

    def on_rc_override(self, message: Message, origin: Origin, now_s: float) -> None:
        """The transmitter's channels (RCMAP_ROLL, RCMAP_THROTTLE) with its ranges, but without dead zones.

        A released axis returns to the transmitter, or to zero without one. An ignored axis keeps its value
        while that is fresh. With both released, control is released. Other channels move the switches.
        """
        pulses_us = _override(message)
        if not pulses_us or not self._may_steer(origin, now_s):
            return
        sticks, config, rc = self._vehicle.manual_input, self._vehicle.config, self._vehicle.config.rc
        axes = (rc.throttle_channel, rc.steering_channel)
        good_us = {number: us for number, us in pulses_us.items() if us == 0 or is_override(us)}
        is_lost = 0 < pulses_us.get(rc.throttle_channel, 0) < rc.failsafe_us
        if is_lost or any(axis in pulses_us and axis not in good_us for axis in axes):
            sticks.invalidate()
            return
        sticks.override(good_us, now_s)
        if not any(axis in good_us for axis in axes):
            return
        held_us = sticks.overridden(config, now_s)
        released = None if sticks.rc.is_heard else 0.0
        throttle, steering = (
            deflection(held_us[axis], rc.stick(axis), 0) if axis in held_us else released for axis in axes
        )
        self._vehicle.request(ManualControl(throttle, steering))
        if all(good_us.get(axis) == 0 for axis in axes) and not any(good_us.values()):
            self._helm_s = -math.inf

    def forget(self, channel: int) -> None:
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


def _override(message: Message) -> dict[int, int]:
    """The channels that a message sets, in µs, and those that it releases: 0."""
    pulses_us: dict[int, int] = {}
    for channel in range(1, _CHANNELS + 1):
        raw: int = getattr(message, f"chan{channel}_raw")
        if raw not in _UNCHANGED[channel > 8]:
            pulses_us[channel] = 0 if raw == _RELEASED[channel > 8] else raw
    return pulses_us
