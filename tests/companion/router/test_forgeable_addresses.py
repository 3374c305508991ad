"""What goes to an address that may be forged, before and after it has proved that it is heard there.

The station's side follows QGroundControl and MAVSDK: a PING to system 0 and component 0 is returned with the
same time and number, addressed to whoever asked; QGroundControl returns none before it has heard a heartbeat.
"""

import pytest
from boat_rig import BOAT, QGC, Peer, Rig

from companion.boat import Boat
from companion.config.boat_config import LinkConfig
from companion.core.errors import ConfigError
from companion.core.storage import MemoryStorage
from companion.links.interfaces import Link
from companion.links.memory import memory_pair
from companion.mavlink.address import Address
from companion.mavlink.dialect import Message, dialect
from companion.mavlink.signing import Signatory, SigningGuard, Stamps, timestamp_at
from companion.mavlink.signing_key import SigningKey
from companion.persistence.signing_store import KEY_FILE
from companion.router.admission import AmplificationLimit, Question
from companion.router.policy import ConfiguredPort, Policy

ELSEWHERE = "203.0.113.9"
HEARTBEAT_BYTES, PING_BYTES = 21, 26


class MeteredPeer(Peer):
    """A station that counts what it sends and gets, and answers as it is told to."""

    sent_bytes = 0
    got_bytes = 0
    answers = False

    def __init__(self, link: Link, address: Address) -> None:
        super().__init__(link, address)
        receive = link.receive

        def count() -> list[bytes]:
            chunks = receive()
            self.got_bytes += sum(map(len, chunks))
            return chunks

        link.receive = count  # type: ignore[method-assign]

    def send_raw(self, data: bytes) -> None:
        self.sent_bytes += len(data)
        assert self.link.send(data)

    def send(self, message: Message) -> None:
        self.send_raw(self._encoder.encode(message))

    def listen(self) -> list[Message]:
        new = super().listen()
        for message in new:
            is_question = (
                message.get_type() == "PING" and message.target_system == message.target_component == 0
            )
            if self.answers and is_question and self._by_name["HEARTBEAT"]:
                self.send(dialect.MAVLink_ping_message(message.time_usec, message.seq, *BOAT))
        return new


class OpenRig(Rig):
    """A boat that hears datagrams from anybody."""

    def __init__(
        self, host: str = ELSEWHERE, storage: MemoryStorage | None = None, **setting: object
    ) -> None:
        self.host = host
        self.setting = LinkConfig(url="", **setting)  # type: ignore[arg-type]
        super().__init__(storage=storage)

    def _build(self) -> Boat:
        port = ConfiguredPort(self.port, Policy(self.setting, accepts_any_source=True))
        return Boat(self.config, self.hardware, [port], self.storage)

    def connect(self, address: Address = QGC, is_datagram: bool = True) -> MeteredPeer:
        near, far = memory_pair(f"udp:{self.host}:{address.system}", is_datagram, host=self.host)
        self.port.offer(near)
        self.boat.receive(self.world.clock_s, (near.fileno(),))
        return MeteredPeer(far, address)

    @property
    def station(self) -> MeteredPeer:
        assert isinstance(self.peer, MeteredPeer)
        return self.peer

    def pass_time(self, seconds: float, *, beats: bool = True) -> None:
        """Second by second, with a heartbeat of the station's in each; its answers come a tick later."""
        for _ in range(round(seconds)):
            if beats:
                self.station.heartbeat()
            for _ in range(50):
                self.step()
                self.station.listen()


REQUESTS = [
    dialect.MAVLink_request_data_stream_message(*BOAT, 0, 50, 1),
    dialect.MAVLink_param_request_list_message(*BOAT),
    dialect.MAVLink_mission_request_list_message(*BOAT, 0),
    *(dialect.MAVLink_command_long_message(*BOAT, 511, 0, number, 20_000, 0, 0, 0, 0, 0)
      for number in (30, 33, 74, 148)),
    *(dialect.MAVLink_ping_message(1, number, 0, 0) for number in range(50)),
]  # fmt: skip


def test_an_address_that_has_sent_no_frame_gets_nothing() -> None:
    rig = OpenRig()
    for garbage in (b"\0", b"\xfd", bytes(1000), b"\xfd\x09\x00" * 30):
        rig.station.send_raw(garbage)
        rig.pass_time(5.0, beats=False)
    assert rig.station.got_bytes == 0


@pytest.mark.parametrize("requests", [[], REQUESTS], ids=["nothing", "all at once"])
def test_an_address_that_answers_nothing_gets_no_more_than_three_times_what_it_sent(
    requests: list[Message],
) -> None:
    rig = OpenRig()
    rig.station.heartbeat()
    rig.station.heartbeat()
    for message in requests:
        rig.station.send(message)
    for _ in range(8):
        rig.pass_time(1.0, beats=False)
        assert rig.station.got_bytes <= 3 * rig.station.sent_bytes
    rig.pass_time(8.0)
    assert rig.station.got_bytes <= 3 * rig.station.sent_bytes
    assert len(rig.station.said("HEARTBEAT")) >= 8, "it is still told that there is a boat"
    assert not rig.station.said("ATTITUDE")


def test_a_station_that_returns_the_ping_gets_everything_from_then_on() -> None:
    rig = OpenRig()
    rig.station.answers = True
    rig.pass_time(3.0)
    names = {one.get_type() for one in rig.station.heard}
    assert {"HEARTBEAT", "PING", "ATTITUDE", "GLOBAL_POSITION_INT", "SYS_STATUS"} <= names
    assert len(rig.station.said("PING")) == 1, "a station that has answered is asked no more"
    assert rig.station.heard[0].get_type() == "HEARTBEAT"


def test_a_parameter_list_that_was_asked_for_before_the_answer_comes_whole_after_it() -> None:
    rig = OpenRig()
    rig.station.send(dialect.MAVLink_param_request_list_message(*BOAT))
    rig.pass_time(2.0)
    assert not rig.station.said("PARAM_VALUE")
    rig.station.answers = True
    rig.pass_time(4.0)
    indexes = [one.param_index for one in rig.station.said("PARAM_VALUE")]
    assert indexes == list(range(len(rig.boat.parameters.rows)))


def test_answers_that_were_guessed_or_are_another_stations_prove_nothing() -> None:
    rig = OpenRig()
    rig.pass_time(2.0)
    (question, *_) = rig.station.said("PING")
    other = rig.connect(Address(254, 190))
    other.heartbeat()
    rig.step(3)
    theirs = other.said("PING")[0]
    assert (theirs.time_usec, theirs.seq) != (question.time_usec, question.seq)
    for time_usec, seq in (
        (theirs.time_usec, theirs.seq),
        (question.time_usec, question.seq ^ 1),
        (question.time_usec + 1, question.seq),
        (0, 0),
    ):
        rig.station.send(dialect.MAVLink_ping_message(time_usec, seq, *BOAT))
    rig.pass_time(3.0)
    assert not rig.station.said("ATTITUDE")
    rig.station.send(dialect.MAVLink_ping_message(question.time_usec, question.seq, *BOAT))
    rig.pass_time(2.0)
    assert rig.station.said("ATTITUDE"), "the right one, seconds late"


@pytest.mark.parametrize(
    ("host", "networks"),
    [
        ("127.0.0.1", ()),
        ("::ffff:127.0.0.1", ()),
        ("::ffff:203.0.113.9", ("203.0.113.7/24",)),
        ("fe80::1%eth0", ("fe80::/10", "10.0.0.0/8")),
    ],
)
def test_loopback_and_networks_of_the_configuration_need_not_prove_themselves(
    host: str, networks: tuple[str, ...]
) -> None:
    policy = Policy(LinkConfig(url="", local_networks=networks), accepts_any_source=True)
    assert not policy.is_forgeable(host)
    assert policy.is_forgeable("198.51.100.1")


def test_a_network_that_is_none_is_named_with_its_key() -> None:
    setting = LinkConfig(url="", local_networks=("192.168.1",))
    with pytest.raises(ConfigError, match=r"links\[1\]\.local_networks: '192.168.1' is not a network"):
        Policy(setting, "links[1]")


def test_a_good_signature_proves_the_address() -> None:
    key = SigningKey.from_passphrase("correct horse")
    storage = MemoryStorage()
    storage.content[KEY_FILE] = key.reveal().hex().encode()
    rig = OpenRig(storage=storage, signing="required")
    rig.pass_time(3.0)
    assert {one.get_type() for one in rig.station.heard} == {"HEARTBEAT"}, "and no question either"
    assert rig.station.got_bytes <= 3 * rig.station.sent_bytes
    stamps = Stamps()
    stamps.clock = timestamp_at(1.8e9)
    guard = SigningGuard(Signatory(key, stamps), "required", 0)
    beat = rig.station._encoder.encode(dialect.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3))
    sealed = guard.seal(beat)
    assert sealed is not None
    rig.station.send_raw(sealed)
    rig.pass_time(3.0, beats=False)
    assert rig.station.said("ATTITUDE")


def test_the_operator_is_told_once_of_a_host_that_does_not_answer(caplog: pytest.LogCaptureFixture) -> None:
    rig = OpenRig()
    friend = rig.connect(Address(254, 190))
    friend.answers = True
    friend.heartbeat()
    rig.step(3)
    friend.listen()
    rig.pass_time(5.0)
    assert "does not answer PING" not in caplog.text, "an answer may take its time"
    rig.pass_time(2.0)
    assert "does not answer PING" in caplog.text
    rig.pass_time(10.0)
    (text,) = [text for text in friend.texts if "does not answer PING" in text]
    assert ELSEWHERE in text
    assert "local_networks" in text
    assert caplog.text.count("does not answer PING") == 1


def test_three_times_is_the_limit_to_the_byte() -> None:
    limit = AmplificationLimit()
    assert not limit.spend(1, 0, is_essential=True)
    assert limit.spend(63, 21, is_essential=True)
    assert not limit.spend(1, 21, is_essential=True)
    assert not limit.spend(10, 40, is_essential=False), "the next announcement and question go before"
    assert not limit.spend(12, 49, is_essential=False)
    assert limit.spend(11, 49, is_essential=False)
    question = limit.question(5)
    assert limit.question(6) == question
    assert limit.is_answer(Question(*question))
    assert not AmplificationLimit().is_answer(question)
