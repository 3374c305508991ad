"""Link statistics for the operator and the log."""

from msgspec import Struct

from companion.router.channel import Channel
from companion.router.channels import Channels


class LinkStatus(Struct, frozen=True):
    """Statistics of one link since it opened. Rates are since the last report.

    bad: invalid places in the stream; lost: gaps in sequence numbers; dropped: not taken by the link in time;
    withheld: by allow, deny and rate caps, and for unverified peers; refused: by signing.
    """

    number: int
    name: str
    address: str
    bytes_in: int
    bytes_out: int
    frames_in: int
    frames_out: int
    forwarded: int
    unknown: int
    bad: int
    lost: int
    dropped: int
    withheld: int
    refused: int
    waiting_bytes: int
    in_bytes_s: float
    out_bytes_s: float
    heard: tuple[str, ...]


class LinksStatus(Struct, frozen=True):
    """All links, and what was not routed."""

    time_s: float
    links: tuple[LinkStatus, ...]
    repeats: int
    echoes: int
    unreachable: int
    reboots: int


class Reporter:
    """Creates reports; keeps the last for the rates."""

    def __init__(self, channels: Channels) -> None:
        self._channels = channels
        self._latest: LinksStatus | None = None

    def report(self, now_s: float) -> LinksStatus:
        """The present statistics."""
        before = {} if self._latest is None else {link.number: link for link in self._latest.links}
        elapsed_s = 0.0 if self._latest is None else now_s - self._latest.time_s
        router = self._channels.router
        self._latest = LinksStatus(
            time_s=now_s,
            links=tuple(
                self._link(channel, before.get(channel.number), elapsed_s)
                for channel in self._channels.open.values()
            ),
            repeats=router.repeats,
            echoes=router.echoes,
            unreachable=router.unreachable,
            reboots=router.routes.flushes,
        )
        return self._latest

    def _link(self, channel: Channel, before: LinkStatus | None, elapsed_s: float) -> LinkStatus:
        counters = channel.counters
        rate = 1.0 / elapsed_s if before is not None and elapsed_s > 0.0 else 0.0
        heard = self._channels.router.routes.addresses_on(channel.number)
        return LinkStatus(
            number=channel.number,
            name=channel.policy.setting.name or channel.link.name,
            address=channel.link.name,
            bytes_in=counters.bytes_in,
            bytes_out=counters.bytes_out,
            frames_in=counters.frames_in,
            frames_out=counters.frames_out,
            forwarded=channel.forwarded,
            unknown=counters.unknown,
            bad=counters.bad_frames,
            lost=counters.lost,
            dropped=channel.queue.dropped,
            withheld=channel.withheld,
            refused=channel.refused,
            waiting_bytes=channel.queue.waiting_bytes,
            in_bytes_s=rate * (counters.bytes_in - (before.bytes_in if before is not None else 0)),
            out_bytes_s=rate * (counters.bytes_out - (before.bytes_out if before is not None else 0)),
            heard=tuple(f"{address.system}/{address.component}" for address in sorted(heard)),
        )
