"""The boat's channels: every link to a station, with a codec and counters of its own."""

import logging
import struct
from collections.abc import Iterator, Sequence

from companion.hal.interfaces import Link, Port
from companion.mavlink.address import Address
from companion.mavlink.codec import Counters, Decoder, Encoder, Received
from companion.mavlink.dialect import Message

logger = logging.getLogger(__name__)


class Channel:
    """One link, its decoder for what comes and its encoder for what goes."""

    __slots__ = ("counters", "decoder", "dropped", "encoder", "faults", "link", "number")

    def __init__(self, number: int, link: Link, own: Address) -> None:
        self.number = number
        self.link = link
        self.counters = Counters()
        self.decoder = Decoder(datagram=link.is_datagram, counters=self.counters)
        self.encoder = Encoder(own, self.counters)
        self.dropped = 0  # frames that the link would not take
        self.faults = 0  # messages that could not be packed: a defect of ours, see the log

    def send(self, message: Message) -> None:
        """Send one message, or drop it whole. Never raises."""
        try:
            frame = self.encoder.encode(message)
        except (struct.error, OverflowError, TypeError, ValueError):
            self.faults += 1
            if self.faults == 1:
                logger.exception("%s: %s cannot be packed", self.link.name, message.get_type())
            return
        if not self.link.send(frame):
            self.dropped += 1


class Channels:
    """Takes in new links, forgets dead ones, moves messages. Channel numbers are never used twice."""

    def __init__(self, ports: Sequence[Port], own: Address) -> None:
        self._ports = list(ports)
        self._own = own
        self._next_number = 1
        self.open: dict[int, Channel] = {}

    def accept(self) -> list[int]:
        """Numbers of the channels that have come into being since the last call."""
        new: list[int] = []
        for port in self._ports:
            for link in port.accept():
                channel = Channel(self._next_number, link, self._own)
                self._next_number += 1
                self.open[channel.number] = channel
                new.append(channel.number)
                logger.info("link %s is up", link.name)
        return new

    def drop_closed(self) -> list[int]:
        """Numbers of the channels whose far side has gone; they are forgotten."""
        gone = [number for number, channel in self.open.items() if channel.link.is_closed]
        for number in gone:
            link = self.open.pop(number).link
            link.close()
            logger.info("link %s is down", link.name)
        return gone

    def receive(self) -> Iterator[tuple[int, Received]]:
        """Everything that has arrived, channel by channel."""
        for channel in list(self.open.values()):
            for chunk in channel.link.receive():
                for received in channel.decoder.feed(chunk):
                    yield channel.number, received

    def send(self, message: Message, number: int | None) -> None:
        """Send by one channel, or by all; a channel that has gone takes its messages with it."""
        if number is None:
            for channel in self.open.values():
                channel.send(message)
        elif (one := self.open.get(number)) is not None:
            one.send(message)

    def filenos(self) -> list[int]:
        """Descriptors that become readable when there is something to do."""
        numbers = [port.fileno() for port in self._ports]
        numbers += [channel.link.fileno() for channel in self.open.values()]
        return sorted({number for number in numbers if number >= 0})

    def close(self) -> None:
        """Close everything. May be called twice."""
        for channel in self.open.values():
            channel.link.close()
        self.open.clear()
        for port in self._ports:
            port.close()
