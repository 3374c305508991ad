"""How well a scenario's links carry: its table [link]."""

from dataclasses import fields
from typing import Annotated

from msgspec import Meta

from companion.config.section import NonNegative, Positive, Section, Share
from sitl.radio.channel import Quality

_MOST_OUTAGES = 10_000


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
    outages: Annotated[tuple[tuple[float, float], ...], Meta(max_length=_MOST_OUTAGES)] = ()

    def __post_init__(self) -> None:
        super().__post_init__()
        for from_s, to_s in self.outages:
            if not 0.0 <= from_s < to_s:
                raise ValueError(f"outages: [{from_s}, {to_s}]: expected a begin from 0 up and a later end")

    @property
    def quality(self) -> Quality:
        """As a channel knows it."""
        return Quality(**{field.name: getattr(self, field.name) for field in fields(Quality)})
