"""Files of component metadata: what the schema of the MAVLink project allows, and what it does not."""

import gzip
import json
import lzma
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mission_tools.station.parameters.metadata import (
    MOST_BYTES,
    NOTHING,
    Bit,
    Choice,
    MetadataError,
    parse,
    read_descriptions,
    unpack,
)


def parsed(*entries: dict[str, Any]) -> Any:  # noqa: ANN401
    return parse(json.dumps({"version": 3, "parameters": entries}).encode())


WHOLE = {
    "name": "TEST_ALL", "type": "Int16", "shortDesc": "Short", "longDesc": "Long\nof two", "units": "m/s",
    "default": 3, "decimalPlaces": 2, "min": -1, "max": 4.5, "increment": 0.5, "rebootRequired": True,
    "group": "Group", "category": "Advanced", "volatile": True, "readOnly": True,
    "values": [{"value": 1, "description": "One"}], "bitmask": [{"index": 3, "description": "Three"}],
}  # fmt: skip


def test_every_key_of_the_schema_is_read() -> None:
    one = parsed(WHOLE).of("TEST_ALL")
    assert (one.text, one.long, one.unit, one.default) == ("Short", "Long\nof two", "m/s", 3.0)
    assert (one.low, one.high, one.step, one.decimals) == (-1.0, 4.5, 0.5, 2)
    assert (one.values, one.bits) == ([Choice(1.0, "One")], [Bit(3, "Three")])
    assert (one.group, one.needs_restart, one.read_only) == ("Group", True, True)


def test_a_name_with_an_index_describes_each_of_its_parameters() -> None:
    texts = parsed(
        {"name": "FOO{n}_BAR", "shortDesc": "Description for foo element {n}", "longDesc": "{n}!", "max": 5},
        {"name": "FOO7_BAR", "shortDesc": "Its own"},
    )
    assert texts.of("FOO3_BAR").text == "Description for foo element 3"
    assert (texts.of("FOO3_BAR").long, texts.of("FOO12_BAR").high) == ("3!", 5.0)
    assert texts.of("FOO7_BAR").text == "Its own"
    assert texts.of("FOO_BAR") == NOTHING


@pytest.mark.parametrize(
    "wrong",
    [
        {"name": 5}, {"name": ""}, {"name": "A B"}, {"name": "<b>"}, {"shortDesc": "no name"},
        {"name": "A", "min": "low"},
        {"name": "A", "values": [{"description": "no value"}]}, {"name": "A", "bitmask": 5}, 7, None, [],
    ],
)  # fmt: skip
def test_an_entry_that_breaks_the_schema_does_not_spoil_the_others(wrong: Any) -> None:  # noqa: ANN401
    texts = parsed(wrong, {"name": "GOOD", "shortDesc": "Here"})
    assert texts.of("GOOD").text == "Here"
    assert list(texts.by_name) == ["GOOD"]


def test_odd_numbers_do_no_harm() -> None:
    texts = parsed(
        {"name": "A", "min": 5, "max": 1, "increment": -1, "decimalPlaces": 900},
        {"name": "B", "increment": 0, "decimalPlaces": -4, "bitmask": [{"index": 99}, {"index": -1}]},
    )
    a, b = texts.of("A"), texts.of("B")
    assert (a.low, a.high, a.step, a.decimals) == (None, None, None, 9)
    assert (b.step, b.decimals, b.bits) == (None, 0, [])
    assert parse(b'{"parameters": [{"name": "C", "min": 1e999}]}').by_name == {}


def test_texts_become_short_lines_without_control_characters() -> None:
    one = parsed(
        {"name": "A", "shortDesc": "a\x00b", "units": "m\n\x1b[0m", "longDesc": "x\x07\n\n" + "y" * 9000}
    ).of("A")
    assert (one.text, one.unit) == ("a", "m  [0m")
    assert one.long.startswith("x\n")
    assert len(one.long) < 5000


@pytest.mark.parametrize(
    "content", [b"", b"null", b"[]", b"{}", b'{"parameters": {}}', b"\xff", b'{"parameters":' + b"[" * 9000]
)
def test_a_file_that_is_none_is_refused_in_a_sentence(content: bytes) -> None:
    with pytest.raises(MetadataError, match="JSON"):
        parse(content)


@given(st.binary(max_size=300))
def test_no_bytes_raise_anything_else(content: bytes) -> None:
    for one in (content, b"\x1f\x8b\x08" + content, b"\xfd7zXZ\x00" + content):
        try:
            read_descriptions(one, None)
        except MetadataError:
            continue


@pytest.mark.parametrize("pack", [gzip.compress, lzma.compress])
def test_a_small_file_that_unpacks_to_a_large_one_is_refused(pack: Any) -> None:  # noqa: ANN401
    with pytest.raises(MetadataError, match="more than 8000 kB"):
        unpack(pack(bytes(MOST_BYTES + 1)))
    with pytest.raises(MetadataError, match="too early"):
        unpack(pack(b"x" * 5000)[:-12])


def test_a_file_whose_dictionary_needs_much_memory_is_refused() -> None:
    filters = [{"id": lzma.FILTER_LZMA2, "preset": 9, "dict_size": 1 << 26}]
    with pytest.raises(MetadataError, match="broken"):
        unpack(lzma.compress(b"x", filters=filters))


def test_a_damaged_file_is_refused() -> None:
    content = json.dumps({"version": 3, "parameters": [WHOLE]}).encode()
    with pytest.raises(MetadataError, match="checksum"):
        read_descriptions(content, 12345)
