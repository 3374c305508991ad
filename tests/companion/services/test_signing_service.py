"""Signing in the whole boat: what an unsigned link can do, what a key does, and who may bring one."""

import logging

import pytest
from boat_rig import BOAT, HOME_ITEM, OK, Peer, Silent, waypoint
from guarded_rig import KEY, NOW, OTHER, GuardedRig, SealedLink

from companion.links.memory import memory_pair
from companion.mavlink.address import Address
from companion.mavlink.dialect import Message, dialect
from companion.mavlink.layout import LAYOUTS
from companion.mavlink.signing import (
    TICKS_PER_S,
    SigningPolicy,
    is_signed,
    timestamp_at,
)
from companion.mavlink.signing_key import SigningKey
from companion.mavlink.transfer import Completed


def setup_signing(key: SigningKey | None, target: Address = BOAT) -> Message:
    secret = list(bytes(32) if key is None else key.reveal())
    message: Message = dialect.MAVLink_setup_signing_message(*target, secret, NOW)
    return message


def guarded(*, trusted: bool = False) -> GuardedRig:
    """A boat with a mission, on a link that asks for signatures."""
    rig = GuardedRig("required", trusted=trusted)
    friend = rig.station(KEY)
    rig.ready()
    items = [HOME_ITEM, waypoint(50.0, 0.0), waypoint(50.0, 50.0)]
    assert isinstance(rig.upload(items, peer=friend), Completed)
    rig.run(0.1)
    return rig


@pytest.mark.parametrize("key", [None, OTHER], ids=["unsigned", "another key"])
def test_no_message_of_the_dialect_gets_in_without_the_key(key: SigningKey | None) -> None:
    rig = guarded(trusted=True)
    stranger = rig.station(key)
    rig.step()
    before, handled = rig.state(), len(rig.handled)
    routes = rig.boat.channels.router.routes.version
    for layout in LAYOUTS.values():
        for fill in (0, 1, 0x3F):
            stranger.send(layout.unpack(bytes([fill]) * layout.size))
        rig.receive()
    rig.step(2)
    assert (rig.state(), len(rig.handled)) == (before, handled)
    assert rig.boat.channels.router.routes.version == routes, "the way to a station was changed"
    assert stranger.said("HEARTBEAT"), "but the boat can be seen"


def test_what_was_recorded_cannot_be_played_again_by_another_link_or_after_a_restart() -> None:
    rig = GuardedRig("required")
    rig.run(1.0)
    friend = rig.station(KEY, Address(254, 190))
    friend.heartbeat()
    friend.command(dialect.MAV_CMD_DO_SET_MODE, 1.0, 5.0)
    friend.send(dialect.MAVLink_param_set_message(*BOAT, b"CRUISE_SPEED", 0.3, 9))
    rig.step(2)
    assert len(rig.handled) == 3
    assert isinstance(friend.link, SealedLink)
    recorded = list(friend.link.sent)
    for _ in range(2):
        handled = len(rig.handled)
        near, far = memory_pair("replay")
        rig.port.offer(near)
        for frame in recorded:
            assert far.send(frame)
        rig.step(2)
        assert len(rig.handled) == handled
        rig.boat.close()
        rig.reboot()
        rig.step()


# SETUP_SIGNING


def offered(rig: GuardedRig, message: Message, peer: Peer | None = None) -> list[str]:
    """The texts that follow when a key is offered."""
    peer = peer or rig.peer
    rig.step()
    peer.forget()
    peer.send(message)
    rig.run(1.2)
    return peer.texts


def test_a_key_is_taken_on_a_trusted_link_stored_and_used_at_once() -> None:
    rig = GuardedRig("accept", None, trusted=True)
    assert "Signing key stored" in offered(rig, setup_signing(KEY))
    assert rig.boat.signing.boat.key == KEY
    assert rig.ask(dialect.MAV_CMD_DO_SET_MODE, 1.0, 0, peer=rig.station(KEY)) == OK
    rig.peer.link.receive()
    rig.step(60)
    assert all(is_signed(chunk) for chunk in rig.peer.link.receive())
    rig.reboot()
    assert rig.boat.signing.boat.key == KEY


@pytest.mark.parametrize("signing", ["off", "accept", "required"])
def test_no_key_comes_over_a_link_that_is_not_trusted(signing: SigningPolicy) -> None:
    rig = GuardedRig(signing)
    friend = rig.station(KEY)
    assert "Signing key refused: this link is not trusted with keys" in offered(
        rig, setup_signing(OTHER), friend
    )
    assert rig.boat.signing.boat.key == KEY


def test_a_key_is_never_passed_on() -> None:
    rig = GuardedRig("off", trusted=True)
    other_boat = rig.connect(Address(2, 1))
    rig.step()
    other_boat.heartbeat()
    rig.step(2)
    for target in (Address(0, 0), Address(2, 1), BOAT):
        rig.peer.send(setup_signing(OTHER, target))
    rig.peer.command(dialect.MAV_CMD_DO_SET_MODE, 1.0)
    rig.step(3)
    assert not other_boat.said("SETUP_SIGNING")


def test_neither_keys_nor_signatures_are_logged(caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level(logging.DEBUG):
        rig = GuardedRig("accept", None, trusted=True)
        seen: list[bytes] = []
        rig.step()
        for channel in rig.boat.channels.open.values():
            channel.tap = seen.append
        offered(rig, setup_signing(KEY))
        friend = rig.station(KEY)
        rig.step(2)
        friend.heartbeat()
        rig.step(2)
        for channel in rig.boat.channels.open.values():
            channel.tap = seen.append
        friend.heartbeat()
        rig.step(2)
    secret = KEY.reveal()
    assert "signing key set by 255/190" in caplog.text
    for told in (repr(secret), secret.hex(), str(list(secret))[1:-1]):
        assert told not in caplog.text
    assert seen
    assert not any(secret in frame or is_signed(frame) for frame in seen)
    assert any(frame[5] == 255 for frame in seen)


# What a station may say of the date


def test_an_unsigned_date_does_not_move_the_signing_clock() -> None:
    rig = GuardedRig("accept", gnss=Silent())
    liar, friend = rig.station(None), rig.station(KEY, Address(254, 190))
    rig.step()
    liar.heartbeat()
    far_s = timestamp_at(3.95e9)  # 2095
    for _ in range(5):
        liar.send(dialect.MAVLink_system_time_message(int(3.95e9 * 1e6), 0))
        rig.run(1.0)
    assert rig.boat._wall_time.unix_s(rig.now_s) > 3.9e9, (
        "it is the date for logs, as long as there is no better"
    )
    friend.heartbeat()
    rig.run(1.0)
    counters = rig.boat.channels.open[3].guard
    assert counters is not None
    assert (counters.counters.verified, counters.counters.old) == (1, 0)
    stamps = rig.boat.signing.stamps
    assert stamps.now < NOW + 60 * TICKS_PER_S < far_s
    assert stamps.last < NOW + 60 * TICKS_PER_S


# What the operator is told


@pytest.mark.parametrize(
    ("signing", "radio", "key", "told"),
    [
        ("off", True, KEY, "is not signed: anyone in range may steer"),
        ("accept", True, KEY, "accepts unsigned messages: anyone in range may steer"),
        ("required", True, KEY, ""),
        ("off", False, KEY, ""),
        ("required", False, None, "requires signatures, but has no key"),
    ],
)
def test_a_link_that_is_not_safe_is_told_of_once(
    signing: SigningPolicy, radio: bool, key: SigningKey | None, told: str, caplog: pytest.LogCaptureFixture
) -> None:
    rig = GuardedRig(signing, key, radio=radio)
    onlooker = rig.onlooker()
    for _ in range(3):
        again = rig.connect()
        rig.run(1.1)
    heard = [*rig.peer.texts, *again.texts, *onlooker.texts]
    texts = [text for text in heard if "steer" in text or "no key" in text]
    assert len(texts) == (1 if told and signing != "required" else 0), "a stranger is told nothing"
    assert all(told in text for text in texts)
    assert caplog.text.count(told) == 1 if told else "steer" not in caplog.text


def test_offers_of_keys_do_not_flood_the_operator() -> None:
    rig = GuardedRig("off")
    rig.step()
    for _ in range(200):
        rig.peer.send(setup_signing(OTHER))
        rig.step(2)
    rig.run(1.0)
    assert sum("key refused" in text for text in rig.peer.texts) == 1
