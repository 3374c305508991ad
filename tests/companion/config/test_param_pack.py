"""The packed parameter file, held against pymavlink's decoder and a file that ArduPilot sent."""

import struct

import pytest
from data_files import RECORDINGS
from hypothesis import example, given, settings
from hypothesis import strategies as st
from pymavlink import mavutil
from pymavlink.mavftp import MAVFTP

from companion.config.parameter_pack import PackedParameter, PackError, pack, unpack_upload
from companion.config.parameters import ParameterType

RECORDING = next(path for path in RECORDINGS if path.stem == "qgc44-ardurover-drive")
LIMITS = {ParameterType.INT8: 127, ParameterType.INT16: 32767, ParameterType.INT32: 2**31 - 1}
NUMBERS = {ParameterType.INT8: 1, ParameterType.INT16: 2, ParameterType.INT32: 3, ParameterType.REAL32: 4}


@st.composite
def entry_lists(draw: st.DrawFn) -> list[PackedParameter]:
    names = draw(st.lists(st.text("ABC_1", min_size=1, max_size=16), unique=True, max_size=60))
    entries = []
    for name in names:
        kind = draw(st.sampled_from(list(ParameterType)))
        limit = LIMITS.get(kind)
        values = st.floats(width=32, allow_nan=False) if limit is None else st.integers(-limit, limit)
        entries.append(PackedParameter(name, kind, float(draw(values)), float(draw(values))))
    return entries


def as_upload(entries: list[PackedParameter]) -> bytes:
    file = bytearray(pack(entries, 0))
    struct.pack_into("<H", file, 4, len(file))
    return bytes(file)


@settings(max_examples=15)  # pymavlink's decoder is slow
@given(entries=entry_lists(), with_defaults=st.booleans())
@example(
    entries=[
        PackedParameter("AB", ParameterType.INT8, 1.0, 1.0),
        PackedParameter("A", ParameterType.INT8, 2.0, 2.0),
    ],
    with_defaults=False,
)
def test_pymavlink_reads_every_name_value_and_default(
    entries: list[PackedParameter], with_defaults: bool
) -> None:
    decoded = MAVFTP.ftp_param_decode(pack(entries, len(entries), with_defaults=with_defaults))
    assert decoded is not None
    assert decoded.params == [(e.name.encode(), e.value, NUMBERS[e.kind]) for e in entries]
    if with_defaults and entries:
        assert decoded.defaults == [(e.name.encode(), e.default, NUMBERS[e.kind]) for e in entries]
    else:
        assert not decoded.defaults


@given(entries=entry_lists())
def test_what_a_station_uploads_is_read_back(entries: list[PackedParameter]) -> None:
    assert unpack_upload(as_upload(entries)) == [(entry.name, entry.value) for entry in entries]


@given(file=st.binary(max_size=300))
def test_a_file_that_is_none_is_refused_and_nothing_else(file: bytes) -> None:
    with pytest.raises(PackError):
        unpack_upload(file)


@given(entries=entry_lists(), at=st.integers(0), value=st.integers(0, 255), cut=st.integers(0, 20))
def test_a_damaged_file_is_refused_or_holds_possible_names(
    entries: list[PackedParameter], at: int, value: int, cut: int
) -> None:
    file = bytearray(as_upload(entries))
    file[at % len(file)] = value
    try:
        values = unpack_upload(bytes(file[: len(file) - cut]))
    except PackError:
        return
    assert all(0 < len(name) <= 16 and name.isascii() for name, _ in values)


@pytest.mark.parametrize(
    ("file", "reason"),
    [
        (b"\x1b\x67\x00", "3 bytes are too few"),
        (struct.pack("<HHH", 0x671C, 0, 6), "magic 0x671c"),
        (struct.pack("<HHH", 0x671B, 0, 7), "6 bytes, but the header says 7"),
        (struct.pack("<HHH", 0x671B, 1, 6), "0 entries, but the header says 1"),
        (struct.pack("<HHHBB", 0x671B, 1, 9, 5, 0) + b"A", "byte 6: 0x05 is not a value type"),
        (struct.pack("<HHHBB", 0x671B, 1, 10, 2, 0) + b"A\x01", "byte 6: an entry is cut short"),
        (struct.pack("<HHHBB", 0x671B, 1, 10, 1, 3) + b"A\x01", "byte 6: b'A' is not a parameter name"),
    ],
)
def test_the_reason_names_the_place(file: bytes, reason: str) -> None:
    with pytest.raises(PackError, match=reason):
        unpack_upload(file)


def recorded_file() -> bytes:
    """The file that ArduPilot's simulator sent, put together from the blocks of the burst."""
    blocks: dict[int, bytes] = {}
    log = mavutil.mavlink_connection(str(RECORDING))
    while (message := log.recv_match(type="FILE_TRANSFER_PROTOCOL")) is not None:
        payload = bytes(message.payload)
        _, _, opcode, size, request, _, _, offset = struct.unpack_from("<HBBBBBBI", payload)
        if (opcode, request) == (128, 15):
            blocks[offset] = payload[12 : 12 + size]
    log.close()
    return b"".join(blocks[offset] for offset in sorted(blocks))


def test_what_ardupilot_sent_comes_out_of_our_packer_byte_for_byte() -> None:
    theirs = recorded_file()
    magic, count, total = struct.unpack_from("<HHH", theirs)
    entries, at, last = [], 6, b""
    kinds = {number: kind for kind, number in NUMBERS.items()}
    formats = dict(zip(NUMBERS, ("<b", "<h", "<i", "<f"), strict=True))
    while at < len(theirs):
        if theirs[at] == 0:
            at += 1
            continue
        kind = kinds[theirs[at]]
        shared, new = theirs[at + 1] & 15, (theirs[at + 1] >> 4) + 1
        last = last[:shared] + theirs[at + 2 : at + 2 + new]
        (value,) = struct.unpack_from(formats[kind], theirs, at + 2 + new)
        entries.append(PackedParameter(last.decode(), kind, float(value), float(value)))
        at += 2 + new + struct.calcsize(formats[kind])
    assert (magic, count) == (0x671B, len(entries))
    assert len(entries) > 1000
    assert pack(entries, total) == theirs
