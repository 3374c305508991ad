"""The page's station on a signed link, by pymavlink's signatures."""

import hashlib
import logging

import pytest
from pymavlink.dialects.v20 import all as peer
from shore_rig import UNIX_S, LossyEnd, Shore

from companion.links.memory import MemoryLink, memory_pair
from companion.mavlink.signing_key import SigningKey
from mission_tools.station.boats import Boats

KEY = hashlib.sha256(b"correct horse").digest()
EPOCH_S = 1_420_070_400  # of signatures: 1 January 2015


class SigningBoat:
    """A boat made of pymavlink, on a link to the station."""

    def __init__(self, shore: Shore, key: bytes | None = KEY) -> None:
        self.link, far = memory_pair("signed")
        shore.port.fresh.append(LossyEnd(far, 0.0, 1))
        self.mav = peer.MAVLink(None, 1, 1)
        if key is not None:
            self.mav.signing.secret_key = key
            self.mav.signing.sign_outgoing = True
            self.mav.signing.timestamp = int((UNIX_S - EPOCH_S) * 1e5)
        self.refused = 0

    def beat(self, *, armed: bool = False) -> None:
        message = self.mav.heartbeat_encode(11, 3, 128 if armed else 0, 0, 4)
        self.link.send(bytes(message.pack(self.mav)))

    def heard(self) -> list[str]:
        """The station's messages that pymavlink takes: signed with the key, each newer than the last."""
        names = []
        for chunk in self.link.receive():
            try:
                names += [message.get_type() for message in self.mav.parse_buffer(chunk) or []]
            except peer.MAVError:
                self.refused += 1
        return names


def signed_shore(key: bytes | None = KEY) -> Shore:
    shore = Shore()
    shore.boats = Boats(shore.port, key=None if key is None else SigningKey(key))
    return shore


def test_commands_are_signed_as_pymavlink_wants_it() -> None:
    shore = signed_shore()
    boat = SigningBoat(shore)
    for _ in range(20):
        boat.beat()
        shore.run(0.1)
    names = boat.heard()
    assert "HEARTBEAT" in names
    shore.send("arm")
    shore.run(0.1)
    assert "COMMAND_LONG" in boat.heard()
    assert boat.refused == 0


@pytest.mark.parametrize("key", [None, hashlib.sha256(b"another").digest()])
def test_a_boat_without_the_key_is_not_shown_and_that_is_said_once(
    key: bytes | None, caplog: pytest.LogCaptureFixture
) -> None:
    shore = signed_shore()
    boat = SigningBoat(shore, key)
    with caplog.at_level(logging.WARNING):
        for _ in range(20):
            boat.beat(armed=True)
            shore.run(0.1)
    assert shore.boats.names() == []
    (record,) = caplog.records
    assert "not signed with this key" in record.getMessage()


def test_what_was_recorded_on_the_link_is_not_heard_again() -> None:
    shore = signed_shore()
    boat = SigningBoat(shore)
    boat.beat()
    shore.run(0.1)
    recorded = bytes(boat.mav.heartbeat_encode(11, 3, 128, 0, 4).pack(boat.mav))
    boat.link.send(recorded)
    shore.run(0.1)
    assert shore.snapshot().armed is True
    boat.beat()
    shore.run(0.1)
    thief: MemoryLink = boat.link
    thief.send(recorded)
    shore.run(0.1)
    assert shore.snapshot().armed is False


def test_without_a_key_nothing_is_signed_and_everything_heard() -> None:
    shore = signed_shore(None)
    boat = SigningBoat(shore, None)
    boat.beat()
    shore.run(1.5)
    assert "HEARTBEAT" in boat.heard()
    assert len(shore.boats.names()) == 1
