"""A boat with one port that asks for signatures, and stations that sign."""

from boat_rig import QGC, Peer, Rig

from companion.boat import Boat
from companion.config.boat_config import LinkConfig
from companion.core.storage import MemoryStorage
from companion.links.interfaces import Link
from companion.links.memory import MemoryPort, memory_pair
from companion.mavlink.address import Address
from companion.mavlink.codec import Received
from companion.mavlink.dialect import Message
from companion.mavlink.signing import Signatory, SigningGuard, SigningPolicy, Stamps, timestamp_at
from companion.mavlink.signing_key import SigningKey
from companion.persistence.signing_store import KEY_FILE, STAMPS_FILE
from companion.router.policy import ConfiguredPort, Policy

KEY = SigningKey.from_passphrase("correct horse")
OTHER = SigningKey.from_passphrase("battery staple")
NOW = timestamp_at(1.8e9)


class SealedLink:
    """A station's end of a link, which signs what goes out and keeps it."""

    def __init__(self, link: Link, key: SigningKey | None) -> None:
        self.sent: list[bytes] = []
        stamps = Stamps()
        stamps.clock = NOW
        self._link = link
        self._guard = SigningGuard(Signatory(key, stamps), "accept" if key else "off", 0)
        self.is_datagram = link.is_datagram
        self.receive = link.receive

    def send(self, data: bytes) -> bool:
        sealed = self._guard.seal(data)
        assert sealed is not None
        self.sent.append(sealed)
        return self._link.send(sealed)


class GuardedRig(Rig):
    """A boat with one port that asks for signatures."""

    def __init__(
        self,
        signing: SigningPolicy,
        key: SigningKey | None = KEY,
        *,
        radio: bool = False,
        trusted: bool = False,
        storage: MemoryStorage | None = None,
        config: dict[str, object] | None = None,
        **parts: object,
    ) -> None:
        self.setting = LinkConfig(url="", signing=signing, radio=radio, trusted=trusted)
        storage = storage or MemoryStorage()
        if key is not None:
            storage.content[KEY_FILE] = key.reveal().hex().encode()
        super().__init__(storage=storage, config=config, **parts)  # type: ignore[arg-type]

    def _build(self) -> Boat:
        port = ConfiguredPort(self.port, Policy(self.setting))
        self.open_port = MemoryPort()
        boat = Boat(self.config, self.hardware, [port, self.open_port], self.storage)
        self.handled: list[Message] = []
        handle = boat.endpoint.handle

        def listen(channel: int, received: Received, now_s: float) -> None:
            self.handled.append(received.message)
            handle(channel, received, now_s)

        boat.endpoint.handle = listen  # type: ignore[method-assign]
        return boat

    def station(self, key: SigningKey | None, address: Address = QGC) -> Peer:
        """A further station, which signs with a key, or does not sign."""
        near, far = memory_pair("station")
        self.port.offer(near)
        self.receive()
        return Peer(SealedLink(far, key), address)  # type: ignore[arg-type]

    def onlooker(self) -> Peer:
        """A station on a link that asks for nothing, which hears what is told to everybody."""
        near, far = memory_pair("onlooker")
        self.open_port.offer(near)
        self.receive()
        return Peer(far, Address(200, 190))

    def state(self) -> tuple[object, ...]:
        """All that no stranger may change."""
        boat, storage = self.boat, self.storage
        assert isinstance(storage, MemoryStorage)
        files = {name: content for name, content in storage.content.items() if name != STAMPS_FILE}
        return self.fingerprint(), boat.signing.boat.key, files, boat.command
