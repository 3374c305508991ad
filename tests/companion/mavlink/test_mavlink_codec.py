"""Encoder and decoder against the table of frames, pymavlink itself, and streams with dirt in them."""

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.mavlink.address import Address
from companion.mavlink.codec import Counters, Decoder, Encoder
from companion.mavlink.dialect import Message, crc16, dialect
from companion.mavlink.layout import LAYOUTS

VECTORS: list[dict[str, Any]] = json.loads(
    (Path(__file__).parents[2] / "vectors" / "frames.json").read_text(encoding="utf-8")
)
FRAMES = [row for row in VECTORS if "message" in row]
FLAWS = [row for row in VECTORS if "flaw" in row]
STATION = Address(255, 190)
LONGEST_FRAME = 280


def row_name(row: Mapping[str, Any]) -> str:
    return str(row.get("flaw") or f"{row['message']}-v{row['version']}{'-signed' * row['signed']}")


def build(name: str, fields: Mapping[str, Any]) -> Message:
    values = {
        key: math.nan if value is None else value.encode() if isinstance(value, str) else value
        for key, value in fields.items()
    }
    message: Message = getattr(dialect, f"MAVLink_{name.lower()}_message")(**values)
    return message


def plain(value: object) -> object:
    return None if isinstance(value, float) and math.isnan(value) else value


def heartbeat(custom_mode: int = 0) -> Message:
    message: Message = dialect.MAVLink_heartbeat_message(11, 3, 81, custom_mode, 4, 3)
    return message


def total_of_flaws(counters: Counters) -> int:
    return counters.bad_frames + counters.unknown


@pytest.mark.parametrize("datagram", [True, False], ids=["datagram", "stream"])
@pytest.mark.parametrize("row", FRAMES, ids=row_name)
def test_a_frame_of_the_table_decodes_to_its_fields(row: dict[str, Any], datagram: bool) -> None:
    decoder = Decoder(datagram)
    frame = bytes.fromhex(row["hex"])
    (received,) = decoder.feed(frame)
    assert received.message.get_type() == row["message"]
    assert received.sender == STATION
    assert received.frame == frame
    assert {name: plain(getattr(received.message, name)) for name in row["fields"]} == row["fields"]
    assert decoder.counters == Counters(bytes_in=len(frame), frames_in=1)


@pytest.mark.parametrize("row", [r for r in FRAMES if r["version"] == 2 and not r["signed"]], ids=row_name)
def test_a_message_of_the_table_encodes_to_its_frame(row: dict[str, Any]) -> None:
    encoder = Encoder(STATION)
    for _ in range(row["sequence"]):
        encoder.encode(heartbeat())
    assert encoder.encode(build(row["message"], row["fields"])).hex() == row["hex"]


@pytest.mark.parametrize("row", FLAWS, ids=row_name)
def test_a_flawed_datagram_is_counted_once_and_gives_no_message(row: dict[str, Any]) -> None:
    decoder = Decoder(datagram=True)
    assert decoder.feed(bytes.fromhex(row["hex"])) == []
    assert getattr(decoder.counters, row["counted_as"]) == 1
    assert total_of_flaws(decoder.counters) == 1


@pytest.mark.parametrize("row", FLAWS, ids=row_name)
def test_a_flaw_in_a_stream_costs_none_of_the_frames_behind_it(row: dict[str, Any]) -> None:
    encoder, decoder = Encoder(STATION), Decoder(datagram=False)
    stream = bytes.fromhex(row["hex"]) + b"".join(encoder.encode(heartbeat(n)) for n in range(40))
    assert [r.message.custom_mode for r in decoder.feed(stream)] == list(range(40))
    assert total_of_flaws(decoder.counters) == 1


@given(st.lists(st.binary(max_size=40), min_size=1, max_size=8), st.integers(1, 64))
def test_frames_survive_any_dirt_between_them_and_any_way_of_cutting_the_stream(
    dirt: list[bytes], chunk: int
) -> None:
    encoder, decoder = Encoder(STATION), Decoder(datagram=False)
    stream = b"".join(piece + encoder.encode(heartbeat(n)) for n, piece in enumerate(dirt))
    # What looks like the begin of a long frame holds back what follows until it is proved wrong.
    stream += bytes(LONGEST_FRAME)
    modes = [
        received.message.custom_mode
        for at in range(0, len(stream), chunk)
        for received in decoder.feed(stream[at : at + chunk])
        if received.message.get_type() == "HEARTBEAT" and received.sender == STATION
    ]
    assert modes == list(range(len(dirt)))
    assert decoder.counters.bytes_in == len(stream)


def test_every_message_of_the_dialect_packs_and_unpacks_as_pymavlink_does() -> None:
    packer = dialect.MAVLink(None, srcSystem=255, srcComponent=190)
    for message_id, layout in LAYOUTS.items():
        filled = bytes((37 * n + message_id) % 100 + 1 for n in range(layout.size))
        for payload in (filled, bytes(layout.size)):
            packer.seq = 0
            message = layout.unpack(payload.rstrip(b"\0"))
            assert layout.pack(message) == payload
            frame = message.pack(packer)
            assert Encoder(STATION).encode(message) == frame
            (ours,) = Decoder(datagram=True).feed(bytes(frame))
            assert repr(ours.message.to_dict()) == repr(packer.decode(bytearray(frame)).to_dict())
            assert ours.message.get_msgId() == message_id


def test_a_text_that_is_no_text_raises_nothing_and_goes_out_as_it_came() -> None:
    layout = LAYOUTS[dialect.MAVLINK_MSG_ID_STATUSTEXT]
    payload = b"\x04" + b"\xff\xfe\x80caf\xc3\xa9" + bytes(41) + b"\0\0\0"
    message = layout.unpack(payload)
    assert "caf" in message.text
    assert layout.pack(message).rstrip(b"\0") == payload.rstrip(b"\0")


def test_a_bad_frame_full_of_magic_bytes_is_counted_once_and_the_next_one_again() -> None:
    payload = b"\xfd\x01\x00\xfe\xff" * 10
    frame = bytearray(Encoder(STATION).encode(dialect.MAVLink_statustext_message(4, payload)))
    frame[-1] ^= 1
    decoder = Decoder(datagram=False)
    for n in (1, 2, 3):
        decoder.feed(bytes(frame))
        decoder.feed(Encoder(STATION).encode(heartbeat()))
        assert (decoder.counters.bad_frames, decoder.counters.bad_crc) == (n, n)
        assert decoder.counters.frames_in == n
    assert decoder.counters.unknown == 0


def test_a_frame_with_an_unknown_incompatibility_is_dropped_even_if_its_checksum_fits() -> None:
    layout = LAYOUTS[dialect.MAVLINK_MSG_ID_HEARTBEAT]
    body = bytearray(Encoder(STATION).encode(heartbeat()))[1:-2]
    body[1] = 0x02
    frame = b"\xfd" + bytes(body) + crc16(bytes(body) + layout.crc_extra).to_bytes(2, "little")
    decoder = Decoder(datagram=True)
    assert decoder.feed(frame + bytes(13)) == []  # as long as if the flag meant a signature
    assert decoder.counters.bad_frames == 1


def test_the_sequence_runs_round_and_gaps_are_counted_as_lost_per_sender() -> None:
    encoder, other, decoder = Encoder(STATION), Encoder(Address(2, 1)), Decoder(datagram=True)
    frames = [encoder.encode(heartbeat(n)) for n in range(600)]
    for n, frame in enumerate(frames):
        if n % 100 != 50:
            decoder.feed(frame)
        if n % 10 == 0:
            decoder.feed(other.encode(heartbeat(n)))
    assert decoder.counters.lost == 6
    assert decoder.counters.frames_in == 594 + 60


def test_a_stream_of_begun_frames_never_fills_the_memory() -> None:
    decoder = Decoder(datagram=False)
    header = bytes.fromhex("fdff0000000101000000")  # a HEARTBEAT that claims 255 bytes
    for _ in range(500):
        decoder.feed(header)
        assert len(decoder._finder._rest) < LONGEST_FRAME
    assert decoder.counters.bad_crc > 0
