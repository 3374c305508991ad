import hashlib

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pymavlink.dialects.v20 import all as dialect

from companion.mavlink.address import Address
from companion.mavlink.framing import Frame, build_frame, read_frame
from companion.mavlink.layout import LAYOUTS, Layout
from companion.mavlink.signing import (
    EPOCH_UNIX_S,
    MAX_STREAMS,
    NEVER,
    STREAM_LAG,
    TICKS_PER_S,
    Signatory,
    SignatureVerdict,
    SigningGuard,
    SigningPolicy,
    Stamps,
    is_signed,
    loggable,
    sign,
    timestamp_at,
    without_signature,
)
from companion.mavlink.signing_key import SigningKey

KEY = SigningKey.from_passphrase("correct horse")
OTHER = SigningKey.from_passphrase("battery staple")
NOW = timestamp_at(1.8e9)
HEARTBEAT = dialect.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3)
STATION = Address(255, 190)

layouts = st.sampled_from(sorted(LAYOUTS.values(), key=lambda layout: layout.message_id))
stamps48 = st.integers(0, NEVER)


def frame(sequence: int = 0, sender: Address = STATION) -> bytes:
    return build_frame(sender, sequence, LAYOUTS[0], LAYOUTS[0].pack(HEARTBEAT))


def guard(policy: SigningPolicy = "required", key: SigningKey | None = KEY, **options: bool) -> SigningGuard:
    return SigningGuard(Signatory(key, Stamps()), policy, 0, **options)


def signatory(now: int = NOW, key: SigningKey = KEY) -> Signatory:
    stamps = Stamps()
    stamps.clock = now
    return Signatory(key, stamps)


def signed_at(timestamp: int, link_id: int = 0, key: SigningKey = KEY, sender: Address = STATION) -> bytes:
    return sign(frame(sender=sender), key, link_id, timestamp)


@given(layouts, st.binary(max_size=255), st.integers(0, 255), stamps48)
def test_a_signed_frame_has_the_right_crc_flag_and_block(
    layout: Layout, payload: bytes, link_id: int, timestamp: int
) -> None:
    plain = build_frame(STATION, 7, layout, payload)
    signed = sign(plain, KEY, link_id, timestamp)
    found = read_frame(signed, 0)
    assert isinstance(found, Frame)
    assert found.data == signed
    assert len(signed) == len(plain) + 13
    assert is_signed(signed)
    assert not is_signed(plain)
    head = signed[:-6]
    assert head[-7:] == bytes([link_id]) + timestamp.to_bytes(6, "little")
    assert signed[-6:] == hashlib.sha256(KEY.reveal() + head).digest()[:6]
    assert without_signature(signed) == plain
    assert without_signature(plain) == plain


def test_pymavlink_takes_what_we_sign_and_we_take_what_pymavlink_signs() -> None:
    theirs = dialect.MAVLink(None, 255, 190)
    theirs.signing.secret_key = KEY.reveal()
    theirs.signing.timestamp, theirs.signing.link_id, theirs.signing.sign_outgoing = NOW, 3, True
    ours = SigningGuard(signatory(), "required", 9)
    for _ in range(300):  # the sequence wraps
        assert ours.admits(HEARTBEAT.pack(theirs))
        sealed = ours.seal(frame(sender=Address(1, 1)))
        assert sealed is not None
        assert theirs.parse_buffer(sealed) is not None
    assert theirs.signing.goodsig_count == ours.counters.verified == 300
    assert theirs.signing.badsig_count == ours.counters.refused == 0


@given(st.data())
def test_one_changed_bit_anywhere_is_refused(data: st.DataObject) -> None:
    signed = bytearray(signed_at(NOW))
    bit = data.draw(st.integers(0, len(signed) * 8 - 1))
    signed[bit // 8] ^= 1 << bit % 8
    assert not guard().admits(bytes(signed))


@given(st.lists(st.tuples(st.integers(0, 2), st.integers(NOW, NOW + 50))))
def test_each_stream_only_ever_counts_upwards(heard: list[tuple[int, int]]) -> None:
    mine, last = signatory(NOW), dict[int, int]()
    for link_id, timestamp in heard:
        is_new = timestamp > last.get(link_id, 0)
        assert (mine.check(signed_at(timestamp, link_id)) is SignatureVerdict.GOOD) is is_new
        if is_new:
            last[link_id] = timestamp


def test_a_new_stream_may_be_a_minute_behind_and_no_more() -> None:
    assert signatory().check(signed_at(NOW - STREAM_LAG)) is SignatureVerdict.GOOD
    assert signatory().check(signed_at(NOW - STREAM_LAG - 1)) is SignatureVerdict.OLD


def test_without_a_date_what_stations_prove_is_the_time() -> None:
    mine = signatory(now=0)
    assert mine.check(signed_at(NOW)) is SignatureVerdict.GOOD
    assert mine.check(signed_at(NOW - STREAM_LAG - 1, link_id=1)) is SignatureVerdict.OLD
    assert mine.stamps.take() == NOW


def test_forged_frames_leave_no_trace() -> None:
    mine = signatory(now=0)
    for system in range(1, 256):
        sender = Address(system, 1)
        assert mine.check(signed_at(NOW + STREAM_LAG, key=OTHER, sender=sender)) is SignatureVerdict.FORGED
    assert mine.stamps.seen == 0
    assert mine.check(signed_at(1, sender=Address(1, 1))) is SignatureVerdict.GOOD


def test_the_table_of_streams_is_bounded_and_forgets_only_what_is_out_of_date() -> None:
    mine = signatory()
    old = [signed_at(NOW, n % 256, sender=Address(1, 1 + n // 256)) for n in range(MAX_STREAMS)]
    for one in old:
        assert mine.check(one) is SignatureVerdict.GOOD
    assert mine.check(signed_at(NOW, sender=Address(9, 9))) is SignatureVerdict.OLD, "all streams are alive"
    mine.stamps.clock = NOW + STREAM_LAG + 1
    assert mine.check(signed_at(NOW + 1, sender=Address(9, 9))) is SignatureVerdict.GOOD
    mine.stamps.clock = NOW  # it jumps back, and what was forgotten is not new for that
    assert {mine.check(one) for one in old} == {SignatureVerdict.OLD}


@given(st.lists(st.one_of(stamps48, st.none())))
def test_our_timestamps_grow_with_any_clock_and_stations(events: list[int | None]) -> None:
    stamps, last = Stamps(), 0
    for number, event in enumerate(events):
        if event is None:
            stamp = stamps.take()
            assert stamp is not None
            assert last < stamp < NEVER
            last = stamp
        elif number % 2:
            stamps.clock = timestamp_at(EPOCH_UNIX_S + event / TICKS_PER_S)
        else:
            stamps.follow(event)


def test_no_frame_can_exhaust_the_timestamps() -> None:
    mine = signatory(now=0)
    assert mine.check(signed_at(NEVER)) is SignatureVerdict.GOOD
    assert mine.stamps.seen == 0
    assert timestamp_at(1e12) < NEVER - 364 * 86_400 * TICKS_PER_S


def test_no_stamp_at_the_limit_is_used() -> None:
    stamps = Stamps(first=5, limit=7)
    assert [stamps.take(), stamps.take(), stamps.take()] == [5, 6, None]
    mine = SigningGuard(Signatory(KEY, stamps), "accept", 0)
    assert mine.seal(frame()) is None
    assert mine.counters.unsendable == 1


def test_no_timestamp_lies_before_a_known_date() -> None:
    stamps = Stamps(limit=100)
    stamps.clock = NOW
    assert stamps.take() is None
    stamps.limit = NOW + 2
    assert [stamps.take(), stamps.take(), stamps.take()] == [NOW, NOW + 1, None]


@pytest.mark.parametrize(
    ("policy", "unsigned", "signed", "forged", "leaves_signed"),
    [
        ("off", True, True, True, False),
        ("accept", True, True, False, True),
        ("required", False, True, False, True),
    ],
)
def test_what_each_policy_admits(
    policy: SigningPolicy, unsigned: bool, signed: bool, forged: bool, leaves_signed: bool
) -> None:
    mine = guard(policy)
    assert mine.verifies_with(KEY) is (policy != "off")
    assert not mine.verifies_with(OTHER)
    assert mine.admits(frame()) is unsigned
    assert mine.counters.unsigned == (not unsigned)
    assert mine.admits(signed_at(NOW)) is signed
    assert mine.admits(signed_at(NOW + 1, key=OTHER)) is forged
    sealed = mine.seal(frame())
    assert sealed is not None
    assert is_signed(sealed) is leaves_signed


def test_a_link_that_asks_for_signatures_is_deaf_while_there_is_no_key() -> None:
    mine = guard(key=None)
    assert not mine.admits(frame())
    assert not mine.admits(signed_at(NOW))
    assert mine.seal(frame()) == frame(), "but the boat can be seen"


V1_HEARTBEAT = bytes.fromhex("fe09000101000a000000020351040348d9")


def test_version_1_cannot_be_signed_and_is_refused_where_it_must_be() -> None:
    assert not guard().admits(V1_HEARTBEAT)
    assert guard("accept").admits(V1_HEARTBEAT)
    assert guard().seal(V1_HEARTBEAT) == V1_HEARTBEAT


def test_what_another_system_has_signed_is_passed_on_untouched() -> None:
    theirs = signed_at(NOW, key=OTHER)
    assert guard().seal(theirs) == theirs


@pytest.mark.parametrize("version", [1, 2])
def test_only_a_radio_may_report_its_state_unsigned(version: int) -> None:
    report = dialect.MAVLink_radio_status_message(1, 1, 90, 1, 1, 0, 0)
    data = report.pack(dialect.MAVLink(None, 51, 68), force_mavlink1=version == 1)
    assert guard(is_radio=True).admits(data)
    assert not guard().admits(data)
    assert not guard(is_radio=True).admits(frame())


def test_a_log_holds_neither_signatures_nor_keys() -> None:
    assert loggable(signed_at(NOW)) == loggable(frame()) == frame()
    assert loggable(V1_HEARTBEAT) == V1_HEARTBEAT
    layout = LAYOUTS[dialect.MAVLINK_MSG_ID_SETUP_SIGNING]
    setup = build_frame(
        STATION, 0, layout, layout.pack(dialect.MAVLink_setup_signing_message(1, 1, KEY.reveal(), 9))
    )
    assert loggable(setup) == loggable(sign(setup, KEY, 0, NOW)) == b""


def test_a_clock_that_runs_ahead_of_the_limit_waits_for_it() -> None:
    stamps = Stamps(first=5, limit=8)
    stamps.clock = NOW
    assert [stamps.take() for _ in range(4)] == [5, 6, 7, None]
    stamps.limit = NOW + 1
    assert stamps.take() == NOW
