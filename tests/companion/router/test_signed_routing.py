"""Signing and forwarding: what passes between a link that is signed and one that is not."""

from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.app.composition import check_config, policy_of
from companion.config.boat_config import BoatConfig, LinkConfig
from companion.core.errors import ConfigError
from companion.links.memory import MemoryLink, MemoryPort, memory_pair
from companion.mavlink.address import Address
from companion.mavlink.codec import Encoder
from companion.mavlink.dialect import dialect
from companion.mavlink.signing import (
    Signatory,
    SignatureVerdict,
    SigningGuard,
    SigningPolicy,
    Stamps,
    is_signed,
    sign,
)
from companion.mavlink.signing_key import SigningKey
from companion.router.channel import Channel
from companion.router.channels import Channels
from companion.router.policy import Policy

OWN, STATION, OTHER_BOAT = Address(1, 1), Address(255, 190), Address(2, 1)
KEY = SigningKey.from_passphrase("correct horse")
HEARTBEAT = dialect.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3)


class Bridge:
    """An open link for a station, and a signed one on which another boat is."""

    def __init__(self, policy: SigningPolicy = "required") -> None:
        near, self.station = memory_pair("station")
        far, self.boat = memory_pair("boat")
        self.channels = Channels([MemoryPort(near), MemoryPort(far)], OWN)
        self.channels.accept()
        self.signed = self.channels.open[2]
        self.signed.set_guard(SigningGuard(Signatory(KEY, Stamps()), policy, 2))

    def pass_on(self) -> None:
        """Let what has come be routed."""
        list(self.channels.receive(0.0))


def heartbeat(sender: Address) -> bytes:
    return Encoder(sender).encode(HEARTBEAT)


def one(link: MemoryLink) -> bytes:
    (chunk,) = link.receive()
    return chunk


@pytest.mark.parametrize(("policy", "passes"), [("required", False), ("accept", True)])
def test_an_unsigned_message_is_passed_on_unchanged_where_unsigned_ones_are_accepted(
    policy: SigningPolicy, passes: bool
) -> None:
    bridge = Bridge(policy)
    frame = heartbeat(STATION)
    bridge.station.send(frame)
    bridge.pass_on()
    assert bridge.boat.receive() == [frame] * passes
    assert bridge.signed.withheld == (not passes)


@pytest.mark.parametrize(
    ("signed_with", "checks_with", "passes"), [(0, 0, True), (1, 1, False), (0, None, False)]
)
def test_a_link_that_requires_signatures_gets_what_was_verified_with_its_key(
    signed_with: int, checks_with: int | None, passes: bool
) -> None:
    keys = KEY, SigningKey.from_passphrase("another")
    bridge = Bridge()
    if checks_with is not None:
        bridge.channels.open[1].set_guard(SigningGuard(Signatory(keys[checks_with], Stamps()), "accept", 1))
    frame = sign(heartbeat(STATION), keys[signed_with], 9, 77)
    bridge.station.send(frame)
    bridge.pass_on()
    assert bridge.boat.receive() == [frame] * passes


def test_what_is_refused_is_not_passed_on_and_teaches_no_way() -> None:
    bridge = Bridge()
    signed = sign(heartbeat(Address(3, 1)), KEY, 9, 77)
    bridge.boat.send(signed)
    bridge.boat.send(heartbeat(OTHER_BOAT))
    bridge.pass_on()
    assert bridge.station.receive() == [signed], "to the bit"
    assert bridge.channels.router.routes.channels_of(OTHER_BOAT) == []
    assert bridge.signed.refused == 1


def test_a_stranger_with_our_own_address_is_not_signed_for_either() -> None:
    bridge = Bridge()
    bridge.station.send(heartbeat(OWN))
    bridge.pass_on()
    assert bridge.boat.receive() == []
    bridge.channels.send(HEARTBEAT, None)
    assert is_signed(one(bridge.boat)), "our own is, on the signed link only"
    assert not is_signed(one(bridge.station))


@given(st.lists(st.booleans(), max_size=60))
def test_timestamps_are_sent_in_order_on_a_slow_link(steps: list[bool]) -> None:
    near, far = memory_pair("radio", queue_frames=3)
    channel = Channel(1, near, OWN, Policy(LinkConfig(url="", max_bytes_s=100.0)))
    channel.set_guard(SigningGuard(Signatory(KEY, Stamps()), "required", 1))
    peer = Signatory(KEY, Stamps())
    for number, is_read in enumerate(steps):
        channel.send(HEARTBEAT, 0.05 * number)
        channel.drain(0.05 * number)
        if is_read:
            assert {peer.check(frame) for frame in far.receive()} <= {SignatureVerdict.GOOD}


def test_a_radio_s_budget_counts_the_signatures() -> None:
    sent = []
    for is_signed_link in (False, True):
        near, far = memory_pair("radio")
        channel = Channel(1, near, OWN, Policy(LinkConfig(url="", max_bytes_s=500.0)))
        if is_signed_link:
            channel.set_guard(SigningGuard(Signatory(KEY, Stamps()), "accept", 1))
        for tick in range(500):
            if channel.may_send(0.02 * tick):
                channel.send(HEARTBEAT, 0.02 * tick)
        sent.append(sum(map(len, far.receive())))
    assert sent[1] == pytest.approx(sent[0], rel=0.05)


@pytest.mark.parametrize(
    ("url", "trusted", "is_trusted"),
    [
        ("tcpin:127.0.0.1:5760", None, True),
        ("udpin:[::1]:14550", None, True),
        ("tcpin:localhost:5760", False, False),
        ("tcpin:0.0.0.0:5760", None, False),
        ("serial:/dev/ttyUSB0:57600", None, False),
        ("serial:/dev/ttyACM0:115200", True, True),
    ],
)
def test_loopback_is_trusted_with_keys_and_others_are_when_told(
    url: str, trusted: bool | None, is_trusted: bool
) -> None:
    assert policy_of(LinkConfig(url=url, trusted=trusted), "links[0]").is_trusted is is_trusted


def test_a_key_file_that_cannot_be_used_is_found_before_the_boat_sails(tmp_path: Path) -> None:
    path = tmp_path / "radio.key"
    link = LinkConfig(url="tcpin:127.0.0.1:5760", signing="required", key_file=str(path))
    with pytest.raises(ConfigError, match=r"radio\.key: the signing key cannot be read"):
        check_config(BoatConfig(links=(link,)))


def test_frames_of_a_further_component_are_signed_too() -> None:
    near, far = memory_pair("station")
    channel = Channel(1, near, OWN, Policy(LinkConfig(url="")), (100,))
    channel.set_guard(SigningGuard(Signatory(KEY, Stamps()), "required", 1))
    for component in (0, 100, 0):
        channel.send(HEARTBEAT, 0.0, component)
    peer = Signatory(KEY, Stamps())
    frames = far.receive()
    assert [frame[6] for frame in frames] == [1, 100, 1]
    assert {peer.check(frame) for frame in frames} == {SignatureVerdict.GOOD}
