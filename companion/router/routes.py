"""Routes: which address was heard on which channel.

After the MAVLink guide, "Routing". A route expires when its component is silent; a flood of forged addresses
on one channel only displaces routes of that channel.
"""

from collections import OrderedDict

from companion.mavlink.address import ALL, Address
from companion.mavlink.dialect import dialect
from companion.mavlink.framing import Frame
from companion.mavlink.layout import LAYOUTS

EXPIRY_S = 60.0  # components send HEARTBEAT once a second; a radio may be out of range for a while
MAX_HEARD = 128  # addresses per channel
_REFRESH_S = 1.0  # younger routes are not updated
_REBOOT_S = 3.0  # decrease of the time since boot, more than by reordering
_MAX_CLOCKS = 256

_BOOT_MS_AT = 8  # offset in SYSTEM_TIME


class RouteTable:
    """`version` changes whenever a result of `channels_of` may have changed."""

    def __init__(self) -> None:
        self.version = 0
        self.flushes = 0  # detected reboots
        self._heard: dict[int, OrderedDict[Address, float]] = {}
        self._clock_ms: OrderedDict[Address, int] = OrderedDict()

    def open(self, channel: int) -> None:
        self._heard[channel] = OrderedDict()
        self.version += 1

    def forget(self, channel: int) -> None:
        """A channel has closed; remove its routes."""
        self._heard.pop(channel, None)
        self.version += 1

    def learn(self, channel: int, frame: Frame, now_s: float) -> None:
        """Record the sender of a received frame."""
        heard, sender = self._heard[channel], frame.sender
        if frame.message_id == dialect.MAVLINK_MSG_ID_SYSTEM_TIME:
            self._watch_clock(frame)
        heard_s = heard.get(sender)
        if heard_s is not None:
            if now_s - heard_s >= _REFRESH_S:
                heard[sender] = now_s
                heard.move_to_end(sender)
            return
        if len(heard) >= MAX_HEARD:
            heard.popitem(last=False)
        heard[sender] = now_s
        self.version += 1

    def channels_of(self, target: Address) -> list[int]:
        """Channels of a target, in order; those of its system if the component is unknown."""
        system = [
            (channel, address)
            for channel, heard in self._heard.items()
            for address in heard
            if address.system == target.system
        ]
        exact = [one for one in system if one[1].component == target.component]
        found = exact if exact and target.component != ALL else system
        return sorted({channel for channel, _ in found})

    def addresses_on(self, channel: int) -> list[Address]:
        """Addresses heard on a channel, least recent first."""
        return list(self._heard.get(channel, ()))

    def expire(self, now_s: float) -> None:
        """Remove silent addresses. Call once a second."""
        for heard in self._heard.values():
            while heard and now_s - heard[next(iter(heard))] > EXPIRY_S:
                heard.popitem(last=False)
                self.version += 1

    def _watch_clock(self, frame: Frame) -> None:
        """A decrease of the time since boot is a reboot: routes may have changed."""
        clock, sender = self._clock_ms, frame.sender
        boot_ms = int.from_bytes(frame.payload[_BOOT_MS_AT : _BOOT_MS_AT + 4], "little")
        if clock.pop(sender, 0) - boot_ms > _REBOOT_S * 1e3:
            self._flush(sender.system)
        if len(clock) >= _MAX_CLOCKS:
            clock.popitem(last=False)
        clock[sender] = boot_ms

    def _flush(self, system: int) -> None:
        self.flushes += 1
        self.version += 1
        for heard in self._heard.values():
            for address in [address for address in heard if address.system == system]:
                del heard[address]


EVERYBODY = Address(ALL, ALL)
_NOWHERE = 255  # beyond every field: reads as 0, like a truncated MAVLink 2 field


def _places() -> dict[int, tuple[int, int]]:
    """Offsets of target system and component in the payload, for all messages with a target."""
    places: dict[int, tuple[int, int]] = {}
    for message_id, layout in LAYOUTS.items():
        # in a payload of 0, 1, 2 …, a byte's value is its offset
        counted = layout.unpack(bytes(range(layout.size)))
        system = getattr(counted, "target_system", None)
        if system is not None:
            places[message_id] = system, getattr(counted, "target_component", _NOWHERE)
    # MANUAL_CONTROL has its target in another field
    steered = LAYOUTS[dialect.MAVLINK_MSG_ID_MANUAL_CONTROL]
    places[steered.message_id] = steered.unpack(bytes(range(steered.size))).target, _NOWHERE
    return places


_PLACES = _places()


def target_of(frame: Frame) -> Address:
    """Target system and component, 0 for all; a message without a target is for all."""
    places = _PLACES.get(frame.message_id)
    if places is None:
        return EVERYBODY
    system_at, component_at = places
    payload = frame.payload
    length = len(payload)
    if system_at >= length:
        return EVERYBODY if component_at >= length else Address(ALL, payload[component_at])
    return Address(payload[system_at], payload[component_at] if component_at < length else ALL)
