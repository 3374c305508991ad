"""Which new connections the server takes: so many at a time and so often, shared fairly among addresses."""

import asyncio
from collections import Counter
from collections.abc import Callable
from typing import Any, Final

from mission_tools.shore.web.connections.rates import Rate, Rates
from mission_tools.shore.web.connections.throttle import network_of

MOST_CONNECTIONS: Final = 256
MOST_OF_ADDRESS: Final = 64  # eight pages with six files each at the same time
_OFTEN: Final = Rate(burst=64, per_s=8.0)  # a page opens six and keeps them
_STRANGERS: Final = Rate(burst=128, per_s=32.0)
_FEW: Final = 4  # of an address: nothing is taken from it for another


class AccessControl:
    """The protocol factory's state. server: of aiohttp; is_known: whether an address has told the PIN."""

    def __init__(
        self,
        server: Any,  # noqa: ANN401 (aiohttp.web.Server in some versions is generic)
        is_known: Callable[[str], bool],
        now_s: Callable[[], float],
    ) -> None:
        self._server = server
        self._is_known = is_known
        self._now_s = now_s
        self._rates = Rates(_OFTEN, _STRANGERS)
        self._networks: dict[object, str] = {}  # of the server's connections

    def open(self) -> asyncio.Protocol:
        """For the next connection."""
        return _NewConnection(self)

    def admit(self, transport: asyncio.Transport) -> None:
        """Hand a connection to the server, or close it."""
        peer = transport.get_extra_info("peername")
        address = str(peer[0]) if peer else ""
        network, is_known = network_of(address), self._is_known(address)
        if not self._rates.allows(network, self._now_s(), is_known=is_known):
            transport.abort()
            return
        live = [one for one in self._server.connections if not _is_closing(one)]
        self._networks = {one: self._networks[one] for one in live}
        counts = Counter(self._networks.values())
        if counts[network] >= MOST_OF_ADDRESS:
            transport.abort()
            return
        if len(live) >= MOST_CONNECTIONS and not self._make_room(live, counts, network, is_known=is_known):
            transport.abort()
            return
        handler = self._server()
        self._networks[handler] = network
        transport.set_protocol(handler)
        handler.connection_made(transport)

    def _make_room(self, live: list[Any], counts: Counter[str], network: str, *, is_known: bool) -> bool:
        """Close the oldest connection of the address with most of them."""
        most, count = counts.most_common(1)[0]
        if count <= max(_FEW, counts[network] + 1) and not (is_known and most != network):
            return False
        oldest = next(one for one in live if self._networks[one] == most)
        oldest.transport.abort()
        return True


class _NewConnection(asyncio.Protocol):
    """A connection until it is admitted or closed."""

    def __init__(self, access_control: AccessControl) -> None:
        self._access_control = access_control

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        assert isinstance(transport, asyncio.Transport)  # noqa: S101 (of a stream)
        self._access_control.admit(transport)


def _is_closing(connection: Any) -> bool:  # noqa: ANN401 (as above)
    return connection.transport is None or bool(connection.transport.is_closing())
