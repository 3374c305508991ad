"""Which system and component was heard on which channel, and so where a frame for it goes.

After the MAVLink guide, "Routing". A route lives as long as its component is heard; a flood of made-up
addresses on one channel displaces only what was heard on that channel.
"""

from collections import OrderedDict

from companion.mavlink.address import ALL, Address
from companion.mavlink.dialect import dialect
from companion.mavlink.framing import Frame

EXPIRY_S = 60.0  # every component says HEARTBEAT once a second; a radio may be out of reach for a while
MAX_HEARD = 128  # addresses a channel
_REFRESH_S = 1.0  # a route that is younger is not touched
_REBOOT_S = 3.0  # time since boot falls by more than frames can overtake each other
_MAX_CLOCKS = 256

_BOOT_MS_AT = 8  # in SYSTEM_TIME, behind the date in microseconds


class Routes:
    """What was heard where. `version` changes whenever an answer of `where` may have changed."""

    def __init__(self) -> None:
        self.version = 0
        self.flushes = 0  # systems found to have rebooted
        self._heard: dict[int, OrderedDict[Address, float]] = {}
        self._clock_ms: OrderedDict[Address, int] = OrderedDict()

    def open(self, channel: int) -> None:
        """A channel has come into being."""
        self._heard[channel] = OrderedDict()
        self.version += 1

    def forget(self, channel: int) -> None:
        """A channel has gone, and every route over it."""
        self._heard.pop(channel, None)
        self.version += 1

    def learn(self, channel: int, frame: Frame, now_s: float) -> None:
        """A frame has come in on a channel: its sender is there."""
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
        """The channels that a target was heard on, in order; a system's all where the component was not."""
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
        """Who was heard on a channel, the least lately heard first."""
        return list(self._heard.get(channel, ()))

    def expire(self, now_s: float) -> None:
        """Forget whom nobody has heard for long. To be called about once a second."""
        for heard in self._heard.values():
            while heard and now_s - heard[next(iter(heard))] > EXPIRY_S:
                heard.popitem(last=False)
                self.version += 1

    def _watch_clock(self, frame: Frame) -> None:
        """A time since boot that falls is a reboot: the system may now be found elsewhere."""
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
