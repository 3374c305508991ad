"""A link that loses, delays, reorders and doubles what it carries, the same way for the same seed."""

import heapq
import math
import random
from dataclasses import dataclass, fields
from typing import Annotated

from msgspec import Meta

from companion.config.section import NonNegative, Positive, Section, Share


@dataclass(frozen=True, slots=True)
class Quality:
    """What a channel does to a datagram.

    loss and duplication are probabilities, 0..1. Each copy arrives delay_s + up to jitter_s later (uniform),
    so that jitter reorders. bandwidth_bytes_s limits the flow, 0 for no limit; what would have to queue for
    longer than backlog_s is dropped, as a radio's full buffer drops it.
    """

    loss: float = 0.0
    delay_s: float = 0.0
    jitter_s: float = 0.0
    duplication: float = 0.0
    bandwidth_bytes_s: float = 0.0
    backlog_s: float = 2.0
    reordering: float = 0.0
    reordering_s: float = 0.1

    def with_(self, other: "Quality") -> "Quality":
        """Two channels one after the other."""
        return Quality(
            loss=1.0 - (1.0 - self.loss) * (1.0 - other.loss),
            delay_s=self.delay_s + other.delay_s,
            jitter_s=self.jitter_s + other.jitter_s,
            duplication=1.0 - (1.0 - self.duplication) * (1.0 - other.duplication),
            bandwidth_bytes_s=min(self.bandwidth_bytes_s, other.bandwidth_bytes_s)
            or max(self.bandwidth_bytes_s, other.bandwidth_bytes_s),
            backlog_s=min(self.backlog_s, other.backlog_s),
            reordering=1.0 - (1.0 - self.reordering) * (1.0 - other.reordering),
            reordering_s=max(self.reordering_s, other.reordering_s),
        )


WHOLE = Quality()


class LinkSettings(Section, frozen=True):
    """[link] of a scenario: what every link does each way, see `Quality`.

    outages: from when to when, in seconds of the world's time, nothing comes through. Raises ValueError: an
    outage that ends before it begins.
    """

    loss: Share = 0.0
    delay_s: NonNegative = 0.0
    jitter_s: NonNegative = 0.0
    duplication: Share = 0.0
    reordering: Share = 0.0
    reordering_s: NonNegative = 0.1
    bandwidth_bytes_s: NonNegative = 0.0
    backlog_s: Positive = 2.0
    outages: Annotated[tuple[tuple[float, float], ...], Meta(max_length=10_000)] = ()

    def __post_init__(self) -> None:
        super().__post_init__()
        for from_s, to_s in self.outages:
            if not 0.0 <= from_s < to_s:
                raise ValueError(f"outages: [{from_s}, {to_s}]: expected a begin from 0 up and a later end")

    @property
    def quality(self) -> Quality:
        """As a channel knows it."""
        return Quality(**{field.name: getattr(self, field.name) for field in fields(Quality)})


class Channel:
    """One direction of a link. A change of its quality holds for what is sent from then on."""

    def __init__(self, quality: Quality, seed: int) -> None:
        self.quality = quality
        self._random = random.Random(seed)
        self._in_flight: list[tuple[float, int, bytes]] = []
        self._sent = 0
        self._free_s = 0.0

    def send(self, data: bytes, now_s: float) -> None:
        """Put a datagram on its way."""
        quality = self.quality
        if quality.bandwidth_bytes_s:
            begin_s = max(now_s, self._free_s)
            if begin_s - now_s > quality.backlog_s:
                return
            self._free_s = begin_s + len(data) / quality.bandwidth_bytes_s
            now_s = self._free_s
        # A fixed number of draws per datagram: the fate of one does not depend on that of another.
        lost, doubled, early, late = (self._random.random() for _ in range(4))
        if lost < quality.loss:
            return
        held_s = 0.0
        if quality.reordering and self._random.random() < quality.reordering:
            held_s = quality.reordering_s
        for share in (early, late) if doubled < quality.duplication else (early,):
            self._sent += 1
            arrival_s = now_s + held_s + quality.delay_s + share * quality.jitter_s
            heapq.heappush(self._in_flight, (arrival_s, self._sent, data))

    def receive(self, now_s: float) -> list[bytes]:
        """What has arrived by now, in order of arrival."""
        arrived = []
        while self._in_flight and self._in_flight[0][0] <= now_s:
            arrived.append(heapq.heappop(self._in_flight)[2])
        return arrived

    @property
    def next_s(self) -> float:
        """When the next datagram arrives, infinite when nothing is on its way."""
        return self._in_flight[0][0] if self._in_flight else math.inf

    @property
    def is_empty(self) -> bool:
        """Whether nothing is on its way."""
        return not self._in_flight
