"""The links' end of the data flow: messages in from every channel, messages out from the outbox."""

from collections.abc import Collection
from dataclasses import dataclass

from companion.log.logbook import Logbook
from companion.router.channels import Channels
from companion.services.endpoint import Endpoint


@dataclass(eq=False)
class StationLinks:
    """Between the channels and the endpoint."""

    _channels: Channels
    _endpoint: Endpoint
    _logbook: Logbook | None

    def receive(
        self, now_s: float, unix_s: float, ready: Collection[int] | None, *, accepts_links: bool
    ) -> bool:
        """Accept new links and handle what has arrived. Whether there was anything."""
        channels, is_news = self._channels, False
        if accepts_links:
            for number in channels.accept(ready):
                self._endpoint.open(number, channels.open[number].policy.setting.stream_hz)
                is_news = True
        if self._logbook is not None:
            self._logbook.follow(channels, unix_s)
        for number, received in channels.receive(now_s, ready):
            self._endpoint.handle(number, received, now_s)
            is_news = True
        return is_news

    def drop_closed(self, now_s: float) -> None:
        for number in self._channels.drop_closed():
            self._endpoint.forget(number, now_s)

    def flush(self) -> None:
        """Send what the services have to say."""
        outbox = self._endpoint.outbox
        if not outbox.is_empty:
            for message, channel, component in outbox.drain():
                self._channels.send(message, channel, component)
