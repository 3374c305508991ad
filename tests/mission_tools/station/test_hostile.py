"""What strangers send: nothing raises, nothing grows without bound, no value that JSON cannot carry."""

import math
import random
from typing import Any

import msgspec
import pytest
from shore_rig import UNIX_S, ShorePort

from companion.links.memory import MemoryLink, memory_pair
from companion.mavlink.address import Address
from companion.mavlink.codec import Decoder, Encoder
from companion.mavlink.dialect import Message, dialect
from companion.mavlink.framing import build_frame
from companion.mavlink.layout import LAYOUTS
from mission_tools.station.boat import WANTED
from mission_tools.station.boats import Boats
from mission_tools.station.messages import Answer, PageRequest, Snapshot

BOAT = Address(1, 1)
NAN, INF = float("nan"), float("inf")


class Stranger:
    """Sends frames as any system, and hears what the station sends."""

    def __init__(self) -> None:
        self.link, far = memory_pair("stranger", queue_frames=1 << 20)
        self.port = ShorePort()
        self.port.fresh.append(far)
        self.boats = Boats(self.port)
        self.now_s = 0.0
        self.heard: list[Message] = []
        self._decoder = Decoder(datagram=True)

    def say(self, message: Message, sender: Address = BOAT) -> None:
        """One frame."""
        self.link.send(Encoder(sender).encode(message))

    def heartbeat(self, sender: Address = BOAT) -> None:
        """As a boat."""
        self.say(dialect.MAVLink_heartbeat_message(11, 3, 1, 4, 3, 3), sender)

    def run(self, seconds: float) -> None:
        """Time goes by."""
        for _ in range(round(seconds / 0.05)):
            self.now_s += 0.05
            self.boats.poll(self.now_s, UNIX_S + self.now_s)
            for chunk in self.link.receive():
                self.heard += [one.message for one in self._decoder.feed(chunk)]

    def seen(self) -> Snapshot:
        """The boat as the page shows it."""
        snapshot = self.boats.snapshot(1)
        assert snapshot is not None
        return snapshot

    def check(self) -> None:
        """All that the page reads is finite and encodable."""
        for name in self.boats.names():
            assert_finite(msgspec.to_builtins(self.seen()))
            for kind in ("mission", "fence", "rally"):
                assert_finite(self.boats.items(name.id, kind))
            boat = self.boats.get(name.id)
            assert boat is not None
            assert_finite(boat.view.track.points)


def assert_finite(value: Any) -> None:  # noqa: ANN401  whatever JSON has
    """No NaN and no infinity anywhere in it."""
    if isinstance(value, float):
        assert math.isfinite(value)
    elif isinstance(value, dict):
        for one in value.values():
            assert_finite(one)
    elif isinstance(value, list | tuple):
        for one in value:
            assert_finite(one)


@pytest.mark.parametrize("seed", range(2))
def test_random_payloads_never_raise(seed: int) -> None:
    chance, stranger = random.Random(seed), Stranger()
    stranger.heartbeat()
    stranger.run(0.1)
    for number in range(3000):
        layout = LAYOUTS[chance.choice(sorted(WANTED))]
        payload = chance.randbytes(layout.size)
        if chance.random() < 0.3:  # the floats at their worst
            payload = bytes(chance.choice((0x00, 0xFF, 0x7F, 0x80)) for _ in payload)
        stranger.link.send(build_frame(BOAT, number & 0xFF, layout, payload))
        if number % 100 == 0:
            stranger.run(0.1)
            stranger.check()
    stranger.run(15.0)
    stranger.check()


def test_values_that_are_not_numbers_are_left_out() -> None:
    stranger = Stranger()
    stranger.heartbeat()
    stranger.say(dialect.MAVLink_vfr_hud_message(NAN, INF, 90, 0, NAN, NAN))
    stranger.say(dialect.MAVLink_debug_vect_message(b"CURRENT", 0, NAN, 1.0, 0.0))
    stranger.say(dialect.MAVLink_ekf_status_report_message(0, NAN, NAN, NAN, NAN, NAN))
    stranger.say(dialect.MAVLink_param_value_message(b"CRUISE_SPEED", -INF, 9, 1, 0))
    stranger.say(dialect.MAVLink_distance_sensor_message(0, 0, 100, 50, 0, 0, 100, 0, NAN, NAN, [NAN] * 4, 0))
    stranger.say(dialect.MAVLink_obstacle_distance_message(0, 0, [10] * 72, 0, 0, 100, NAN, NAN, 12))
    stranger.run(1.0)
    stranger.check()
    seen = stranger.seen()
    assert (seen.current, seen.sonar, seen.obstacles, seen.speed_m_s) == (None, None, None, None)


def test_a_list_of_absurd_length_is_refused() -> None:
    stranger = Stranger()
    stranger.heartbeat()
    stranger.run(0.5)
    stranger.say(dialect.MAVLink_mission_count_message(250, 190, 65535, 0))
    stranger.run(1.0)
    stranger.check()
    assert stranger.boats.items(1, "mission") is None
    requests = [one for one in stranger.heard if one.get_type() == "MISSION_REQUEST_INT"]
    assert requests == []


def test_a_fence_of_absurd_corners_is_drawn_as_far_as_it_goes() -> None:
    stranger = Stranger()
    stranger.heartbeat()
    stranger.run(0.2)
    for kind in range(3):
        stranger.say(dialect.MAVLink_mission_count_message(250, 190, 3, kind))
        for seq in range(3):
            stranger.run(0.1)
            params = ((NAN, INF, 1e30)[seq], NAN, NAN, NAN)
            place = (2**31 - 1, -(2**31), NAN)
            stranger.say(
                dialect.MAVLink_mission_item_int_message(250, 190, seq, 3, 5001, 0, 1, *params, *place, kind)
            )
        stranger.run(0.3)
    stranger.check()
    fence = stranger.boats.items(1, "fence")
    assert fence is not None
    assert [one["geometry"] for one in fence["features"]] == [None, None, None]


def test_texts_in_pieces_that_never_end_are_dropped() -> None:
    stranger = Stranger()
    stranger.heartbeat()
    for number in range(1, 2000):
        stranger.say(dialect.MAVLink_statustext_message(4, b"x" * 50, number, number % 256))
    stranger.run(3.0)
    seen = stranger.seen()
    assert len(seen.lines) <= 30
    assert max(len(line.text) for line in seen.lines) <= 500


def test_control_characters_are_taken_out_of_texts() -> None:
    stranger = Stranger()
    stranger.heartbeat()
    stranger.say(dialect.MAVLink_statustext_message(4, b"\x1b[31m<script>\n\r\x07x"))
    stranger.run(0.2)
    seen = stranger.seen()
    assert seen.lines[0].text == "[31m<script>   x"


@pytest.mark.parametrize("target", [(9, 190), (250, 77)])
def test_an_answer_to_another_station_is_not_ours(target: tuple[int, int]) -> None:
    stranger, answers = Stranger(), list[Answer]()
    stranger.heartbeat()
    stranger.run(0.1)
    stranger.boats.ask(PageRequest(id="1", boat=1, what="arm"), answers.append)
    stranger.say(dialect.MAVLink_command_ack_message(400, 0, 0, 0, *target))
    stranger.run(1.0)
    assert answers == []
    stranger.say(dialect.MAVLink_command_ack_message(400, 0, 0, 0, 250, 190), Address(2, 1))
    stranger.run(1.0)
    assert answers == []
    stranger.say(dialect.MAVLink_command_ack_message(400, 0, 0, 0, 250, 190))
    stranger.run(1.0)
    assert [one.ok for one in answers] == [True]


def test_a_command_is_repeated_five_times_and_then_given_up() -> None:
    stranger, answers = Stranger(), list[Answer]()
    stranger.heartbeat()
    stranger.run(0.1)
    stranger.boats.ask(PageRequest(id="1", boat=1, what="hold"), answers.append)
    stranger.run(9.0)
    sent = [one for one in stranger.heard if one.get_type() == "COMMAND_LONG" and one.command == 176]
    assert [one.confirmation for one in sent] == [0, 1, 2, 3, 4]
    assert [one.ok for one in answers] == [False]


def test_a_command_that_must_not_be_done_twice_is_repeated_only_within_two_seconds() -> None:
    stranger = Stranger()
    stranger.heartbeat()
    stranger.run(0.1)
    stranger.boats.ask(PageRequest(id="1", boat=1, what="continue"), lambda _: None)
    stranger.run(1.5)
    early = [one for one in stranger.heard if one.get_type() == "COMMAND_LONG" and one.command == 193]
    stranger.run(7.0)
    late = [one for one in stranger.heard if one.get_type() == "COMMAND_LONG" and one.command == 193]
    assert (len(early), len(late)) == (3, 3)


def test_a_ping_is_returned_to_the_boat_that_checks_this_address() -> None:
    stranger = Stranger()
    stranger.say(dialect.MAVLink_ping_message(123, 4567, 0, 0))
    stranger.say(dialect.MAVLink_ping_message(123, 89, 1, 1))  # an answer to another
    stranger.run(0.2)
    (answer,) = [one for one in stranger.heard if one.get_type() == "PING"]
    assert (answer.seq, answer.target_system, answer.target_component) == (4567, 1, 1)


def test_bytes_that_are_no_frames_are_skipped() -> None:
    stranger = Stranger()
    chance = random.Random(5)
    for _ in range(200):
        stranger.link.send(chance.randbytes(300))
    stranger.link.send(b"\xfd" * 5000)
    stranger.heartbeat()
    stranger.run(0.2)
    assert [one.id for one in stranger.boats.names()] == [1]


def test_links_beyond_a_bound_replace_the_oldest() -> None:
    port = ShorePort()
    ends: list[MemoryLink] = []
    for number in range(100):
        near, far = memory_pair(str(number))
        ends.append(near)
        port.fresh.append(far)
    boats = Boats(port)
    boats.poll(1.0, UNIX_S)
    assert [bool(end.receive()) for end in ends] == [False] * 36 + [True] * 64


def test_the_reason_may_come_after_the_refusal() -> None:
    stranger, answers = Stranger(), list[Answer]()
    stranger.heartbeat()
    stranger.run(0.1)
    stranger.boats.ask(PageRequest(id="1", boat=1, what="arm"), answers.append)
    stranger.say(dialect.MAVLink_command_ack_message(400, 4, 0, 0, 250, 190))
    stranger.run(0.15)
    stranger.say(dialect.MAVLink_statustext_message(2, b"Arm: Kraken: near"))
    stranger.run(0.5)
    assert [one.text for one in answers] == ["Arm: Kraken: near"]


@pytest.mark.parametrize("accepts_at_s", [5.5, None])
def test_a_way_is_answered_for_within_ten_seconds_however_slow_the_boat(accepts_at_s: float | None) -> None:
    stranger, answers = Stranger(), list[Answer]()
    stranger.heartbeat()
    stranger.run(0.1)
    way = {"points": [[1.0, 50.0], [1.1, 50.0]]}
    stranger.boats.ask(PageRequest(id="1", boat=1, what="sail", arguments=way), answers.append)
    began_s, seq = stranger.now_s, 0
    while not answers and stranger.now_s - began_s < 10.0:
        if accepts_at_s is None or stranger.now_s - began_s < accepts_at_s:
            stranger.say(dialect.MAVLink_mission_request_int_message(250, 190, seq % 3, 0))
            seq += 1
        elif seq:
            stranger.say(dialect.MAVLink_mission_ack_message(250, 190, 0, 0))
            seq = 0
        stranger.run(0.25)
    assert [one.ok for one in answers] == [False]
