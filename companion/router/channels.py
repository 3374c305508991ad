"""The boat's channels: opens and closes links, moves frames between them and the endpoint."""

import logging
from collections import defaultdict
from collections.abc import Collection, Iterator, Sequence

from companion.links.interfaces import Port
from companion.mavlink.address import Address
from companion.mavlink.codec import Received
from companion.mavlink.dialect import Message
from companion.mavlink.framing import Frame
from companion.router.admission import excess_links
from companion.router.channel import Channel
from companion.router.policy import PLAIN, ConfiguredPort
from companion.router.router import Router

logger = logging.getLogger(__name__)

# Limits against floods. The excess waits in the system's buffers, which drop the flooding link's own bytes.
# A wasted check takes up to 4.4 µs on the benchmark machine, so garbage takes up to 1.1 ms of a call and
# 4.5 ms of a tick.
_FRAMES_PER_CALL = 256
_FRAMES_PER_LINK = 64  # of a call; then it is the next link's turn
_WASTED_LOOKS_PER_CALL = 256
_WASTED_LOOKS_PER_TICK = 1024

# Burst and rate limit of log lines about links, against forged addresses
_MOST_LINES, _LINES_PER_S = 40.0, 1.0


class Channels:
    """Channel numbers are unique.

    wanted: the messages that the endpoint handles; others are not unpacked. None: all.
    """

    def __init__(self, ports: Sequence[Port], own: Address, components: Collection[int] = ()) -> None:
        """components: further ones of our own, such as a camera."""
        self.open: dict[int, Channel] = {}
        self.router = Router(own, components)
        self.wanted: frozenset[int] | None = None
        self.has_more = False  # frames are left after the last `receive`
        self.taken = 0  # received frames, on all channels
        self._ports = list(ports)
        self._of_port: defaultdict[int, list[Channel]] = defaultdict(list)  # by index of the port
        self._own = own
        self._components = tuple(components)
        self._next_number = 1
        self._now_s = 0.0
        self._filenos: list[int] | None = None
        self._first = 0  # the channel that is served first
        self._order: tuple[Channel, ...] = ()  # the open ones; constant during a tick
        self._lines_left = _MOST_LINES
        self._lines_left_out = 0
        self._logged_s = 0.0
        self._share = _WASTED_LOOKS_PER_TICK  # wasted checks per link and tick

    def accept(self, ready: Collection[int] | None = None) -> list[int]:
        """Numbers of the channels opened since the last call. ready: only ports with these descriptors."""
        new: list[int] = []
        for index, port in enumerate(self._ports):
            if ready is not None and port.fileno() not in ready:
                continue
            self._make_room(index)
            for link in port.accept():
                policy = port.policy if isinstance(port, ConfiguredPort) else PLAIN
                channel = Channel(self._next_number, link, self._own, policy, self._components)
                self._next_number += 1
                self.open[channel.number] = channel
                self._of_port[index].append(channel)
                self.router.open(channel.number, policy.setting.forward)
                new.append(channel.number)
                self._has_changed()
                self._log(f"link {link.name} is up")
        return new

    def _make_room(self, port: int) -> None:
        """Close excess links of a port. New ones have sent something by then, if they had to."""
        self._of_port[port] = [one for one in self._of_port[port] if one.number in self.open]
        for channel in excess_links(self._of_port[port], self._now_s):
            self._log(f"link {channel.link.name} closed to make room")
            channel.link.close()

    def drop_closed(self) -> list[int]:
        """Remove the channels whose far side is closed, and return their numbers."""
        closed = [
            number for number, channel in self.open.items() if channel.link.is_closed and not channel.has_more
        ]
        for number in closed:
            link = self.open.pop(number).link
            link.close()
            self.router.forget(number)
            self._has_changed()
            self._log(f"link {link.name} is down")
        return closed

    def _log(self, text: str) -> None:
        """Log a line, rate-limited; the number of dropped lines is added to the next."""
        now_s = self._now_s
        self._lines_left = min(self._lines_left + _LINES_PER_S * (now_s - self._logged_s), _MOST_LINES)
        self._logged_s = now_s
        if self._lines_left < 1.0:
            self._lines_left_out += 1
            return
        self._lines_left -= 1.0
        if self._lines_left_out:
            text += f" ({self._lines_left_out} lines about other links were left out)"
            self._lines_left_out = 0
        logger.info(text)

    def _has_changed(self) -> None:
        self._filenos = None
        self._order = tuple(self.open.values())

    def receive(
        self, now_s: float = 0.0, ready: Collection[int] | None = None
    ) -> Iterator[tuple[int, Received]]:
        """Received messages for the boat, by channel; others are forwarded.

        ready: only channels with these descriptors or with leftovers. None, once a tick: all channels,
        including those blocked since the last tick.
        """
        self._now_s = now_s
        self.has_more = False
        if ready is None:
            self._begin_tick(now_s)
        frames_left, looks_left = _FRAMES_PER_CALL, _WASTED_LOOKS_PER_CALL
        passed_over: int | None = None  # the first whose turn it was
        channels = self._order
        if self._first:
            self._first %= len(channels) or 1
            channels = channels[self._first :] + channels[: self._first]
        for turn, channel in enumerate(channels):
            if channel.is_blocked or (
                ready is not None and not (channel.has_more or channel.link.fileno() in ready)
            ):
                continue
            if frames_left <= 0 or (looks_left <= 0 and channel.is_noisy):
                passed_over = turn if passed_over is None else passed_over
                continue
            if not channel.poll():  # the usual case
                continue
            before = channel.wasted_checks
            share_left = self._share - (before - channel.wasted_before)
            frames = channel.receive(min(frames_left, _FRAMES_PER_LINK), max(min(looks_left, share_left), 1))
            if channel.wasted_checks != before:
                looks_left -= channel.wasted_checks - before
                self._note_waste(channel)
            elif frames:
                channel.is_noisy = False
            self.has_more |= channel.has_more and not channel.is_blocked
            if frames:
                frames_left -= len(frames)
                self.taken += len(frames)
                yield from self._hand_on(channel, frames, now_s)
        if passed_over is not None:
            self.has_more = True
            self._first += passed_over

    def _begin_tick(self, now_s: float) -> None:
        """Send waiting frames, and share the limit of wasted checks among noisy links."""
        noisy = 0
        for channel in self._order:
            channel.drain(now_s)
            noisy += channel.is_noisy
            channel.wasted_before = channel.wasted_checks
            if channel.is_blocked:
                channel.is_blocked = False
                self._filenos = None
        self._share = max(_WASTED_LOOKS_PER_TICK // max(noisy, 1), 1)

    def _note_waste(self, channel: Channel) -> None:
        """Mark a link as noisy; block it if its share is used up."""
        channel.is_noisy = True
        if channel.wasted_checks - channel.wasted_before >= self._share:
            channel.is_blocked = True
            self._filenos = None

    def _hand_on(
        self, channel: Channel, frames: Sequence[Frame], now_s: float
    ) -> Iterator[tuple[int, Received]]:
        number, route, wanted, opened = channel.number, self.router.route, self.wanted, self.open
        for frame in frames:
            if not channel.accepts(frame, now_s):
                continue
            is_ours, others, is_addressed = route(number, frame, now_s)
            for other in others:
                opened[other].forward(frame, channel, is_addressed, now_s)
            if (
                is_ours
                and (layout := frame.layout) is not None
                and (wanted is None or frame.message_id in wanted)
            ):
                yield number, Received(layout.unpack(frame.payload), frame.sender, frame.data)

    def send(self, message: Message, number: int | None, component: int = 0) -> None:
        """Send on one channel, or on all; messages for a closed channel are dropped.

        component: the sender; 0: the autopilot.
        """
        if number is None:
            for channel in self.open.values():
                channel.send(message, self._now_s, component)
        elif (one := self.open.get(number)) is not None:
            one.send(message, self._now_s, component)

    def may_send(self, number: int, now_s: float) -> bool:
        """Whether telemetry on this channel would be sent at once."""
        channel = self.open.get(number)
        return channel is not None and channel.may_send(now_s)

    def room_bytes(self, number: int) -> int:
        """Bulk data that a channel takes now; 0 if it is closed."""
        channel = self.open.get(number)
        return 0 if channel is None else channel.room_bytes(self._now_s)

    def filenos(self) -> list[int]:
        """Descriptors to wait on between ticks."""
        if self._filenos is None:
            numbers = [port.fileno() for port in self._ports]
            numbers += [channel.link.fileno() for channel in self.open.values() if not channel.is_blocked]
            self._filenos = sorted({number for number in numbers if number >= 0})
        return self._filenos

    def close(self) -> None:
        for channel in self.open.values():
            channel.link.close()
        self.open.clear()
        self._has_changed()
        for port in self._ports:
            port.close()
