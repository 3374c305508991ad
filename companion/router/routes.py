"""Routes: which address was heard on which channel.

After the MAVLink guide, "Routing". A route expires when its component is silent; a flood of forged addresses
on one channel only displaces routes of that channel.
"""

from collections import OrderedDict

from companion.mavlink.address import ALL, Address
from companion.mavlink.dialect import dialect
from companion.mavlink.framing import Frame

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
        """A channel has opened."""
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
