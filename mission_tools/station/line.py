"""A link with its framing, and with its signatures where there is a key."""

import logging
from collections.abc import Iterator
from typing import Final

from companion.links.interfaces import Link
from companion.mavlink.address import Address
from companion.mavlink.codec import Encoder
from companion.mavlink.dialect import Message
from companion.mavlink.finder import FrameFinder
from companion.mavlink.framing import Frame
from companion.mavlink.signing import Signatory, SigningGuard, Stamps, timestamp_at
from companion.mavlink.signing_key import SigningKey

_log: Final = logging.getLogger(__name__)
_LINK_ID: Final = 1  # one for all links: the stamps of a program count upwards over all of them


class Signatures:
    """The station's key, if any: it signs what leaves, and only what is signed with it comes in."""

    def __init__(self, key: SigningKey | None) -> None:
        self._signatory = Signatory(key, Stamps())
        self.guard = SigningGuard(self._signatory, "off" if key is None else "required", _LINK_ID)
        self._has_warned = False

    def poll(self, unix_s: float) -> None:
        """Tell the date, and once why nothing comes in."""
        self._signatory.stamps.clock = timestamp_at(unix_s)
        if self.guard.counters.refused and not self.guard.has_verified and not self._has_warned:
            self._has_warned = True
            _log.warning("what the boats say is not signed with this key; do they have the same one?")


class SignedLink:
    """A link. own: this station's address."""

    def __init__(self, link: Link, own: Address, signatures: Signatures) -> None:
        self.link = link
        self._finder = FrameFinder(link.is_datagram)
        self._encoder = Encoder(own)
        self._guard = signatures.guard

    def send(self, message: Message) -> None:
        """Send, signed if there is a key."""
        sealed = self._guard.seal(self._encoder.encode(message))
        if sealed is not None:
            self.link.send(sealed)

    def frames(self) -> Iterator[Frame]:
        """What has come in and may."""
        for chunk in self.link.receive():
            for frame in self._finder.feed(chunk):
                if self._guard.admits(frame.data):
                    yield frame
