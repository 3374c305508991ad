"""The parameters' texts, fetched from real boats, and from boats that send odd files."""

import gzip
import json
import lzma
from collections.abc import Callable

import pytest
import qgc_metadata
from boat_rig import Rig
from shore_rig import Shore

from companion.mavlink.address import Address
from companion.mavlink.dialect import Message
from companion.mavlink.metadata_messages import ComponentInformation, ComponentMetadata
from companion.services.ftp.component_metadata import parameters_json
from mission_tools.station.ftp.jobs import FtpFailure
from mission_tools.station.parameters import fetching
from mission_tools.station.parameters.fetching import Fetching
from mission_tools.station.parameters.metadata import read_descriptions
from mission_tools.station.parameters.parameter_table import TableSnapshot, document

BOAT = Address(1, 1)
FILE = json.dumps({"version": 3, "parameters": [{"name": "A", "shortDesc": "The first"}]}).encode()


def until_texts(shore: Shore, limit_s: float) -> TableSnapshot:
    """As the page's requests do: snapshot, and read what has come."""
    shore.until(lambda: shore.boats.get(1) is not None, 30.0)
    shore.until(lambda: shore.boat().parameters.snapshot().texts in ("here", "none"), limit_s)
    packed = shore.boat().parameters.snapshot().packed
    if packed is not None:
        shore.boat().parameters.describe(packed, read_descriptions(*packed))
    return shore.boat().parameters.snapshot()


def test_every_parameter_of_a_real_boat_is_described_as_qgroundcontrol_reads_it() -> None:
    rig = Rig()
    shore = Shore(rig, loss=0.2, seed=2)
    seen = until_texts(shore, 120.0)
    facts = qgc_metadata.read(parameters_json(rig.boat.parameters.rows))
    rows = {row["name"]: row for row in json.loads(document(seen, list(seen.values.items())))["parameters"]}
    assert set(rows) == set(facts)
    for name, fact in facts.items():
        row = rows[name]
        assert (row["text"], row["unit"], row["type"]) == (fact.text, fact.units, fact.kind)
        numbers = [row["min"], row["max"], row["default"]]
        assert numbers == pytest.approx([fact.low, fact.high, fact.default], rel=1e-7)  # 32-bit floats
        assert {one["value"]: one["text"] for one in row["values"]} == fact.choices
        assert {1 << one["bit"]: one["text"] for one in row["bits"]} == fact.bits
        assert row["reboot_required"] == fact.needs_reboot
        assert row["changed"] == (not fact.is_default(seen.values[name].value or 0.0))


def test_a_boat_that_starts_again_with_the_same_texts_does_not_send_them_again() -> None:
    rig = Rig()
    shore = Shore(rig)
    first = until_texts(shore, 30.0)
    shore.boat().parameters.restart()
    shore.until(lambda: shore.boat().parameters.snapshot().texts == "here", 10.0)
    again = shore.boat().parameters.snapshot()
    assert again.packed is None  # nothing new to read
    assert again.descriptions is first.descriptions


class Files:
    """A boat of which a test says what it sends."""

    def __init__(self, files: dict[str, bytes]) -> None:
        self.sent: list[int] = []
        self.files = files
        self.read: list[str] = []
        self.fetching = Fetching(BOAT, self._send, self._read)
        self.now_s = 0.0

    def _send(self, message: Message) -> None:
        self.sent.append(int(message.param1))

    def _read(self, path: str, done: Callable[[bytes | FtpFailure], None], most_bytes: int) -> None:
        self.read.append(path)
        content = self.files.get(path)
        done(FtpFailure("none") if content is None or len(content) > most_bytes else content)

    def run(self, seconds: float) -> None:
        for _ in range(round(seconds / 0.05)):
            self.now_s += 0.05
            self.fetching.poll(self.now_s, is_wanted=True)

    def say(self, uri: str, crc: int) -> str:
        self.run(0.1)
        self.fetching.handle(ComponentMetadata(0, crc, uri.encode("ascii")), self.now_s)
        return self.fetching.state


def crc(content: bytes) -> int:
    """Of the MAVLink guide's FTP page: bit by bit, 0xEDB88320, from 0, not inverted."""
    value = 0
    for byte in content:
        value ^= byte
        for _ in range(8):
            value = value >> 1 ^ (0xEDB88320 if value & 1 else 0)
    return value


def general(uri: str, content: bytes | None = FILE, kind: int = 1) -> bytes:
    entry = {"type": kind, "uri": uri, **({} if content is None else {"fileCrc": crc(content)})}
    return json.dumps(
        {"version": 1, "metadataTypes": [{"type": 4, "uri": "https://x.example"}, entry]}
    ).encode()


def files(packed: bytes, uri: str = "mftp:///p", path: str = "/p", content: bytes | None = FILE) -> Files:
    return Files({"/g": general(uri, content), path: packed})


@pytest.mark.parametrize(
    "pack", [bytes, gzip.compress, lzma.compress, lambda one: lzma.compress(one, preset=6)]
)
@pytest.mark.parametrize("crc_of", ["plain", "packed", "none"])
def test_files_plain_or_packed_by_gzip_or_xz_are_read(pack: Callable[[bytes], bytes], crc_of: str) -> None:
    packed = pack(FILE)
    content = {"plain": FILE, "packed": packed, "none": None}[crc_of]
    boat = files(packed, content=content)
    assert boat.say("mftp:///g", crc(boat.files["/g"])) == "here"
    assert boat.fetching.packed is not None
    assert read_descriptions(*boat.fetching.packed).of("A").text == "The first"


@pytest.mark.parametrize(
    ("uri", "path"),
    [
        ("mftp:///p", "/p"),
        ("mftp://[;comp=1]p", "p"),
        ("mftp:///@ROMFS/p.json.xz", "/@ROMFS/p.json.xz"),
        ("mftp:p", "p"),
    ],
)
def test_the_forms_of_a_uri_in_use_are_read(uri: str, path: str) -> None:
    boat = files(FILE, uri, path)
    assert boat.say("mftp:///g", crc(boat.files["/g"])) == "here"
    assert boat.read == ["/g", path]


@pytest.mark.parametrize(
    "uri",
    [
        "https://x.example/p",
        "http://127.0.0.1/p",
        "mftp://[;comp=99]p",
        "",
        "file:///etc/passwd",
        "mftp:///a b",
    ],
)
def test_nothing_is_fetched_from_elsewhere(uri: str) -> None:
    boat = files(FILE, uri)
    assert boat.say("mftp:///g", crc(boat.files["/g"])) == "none"
    assert boat.read == ["/g"]
    other = files(FILE)
    assert other.say(uri, 0) == "none"
    assert other.read == []


def test_a_boat_without_texts_is_asked_for_both_messages_and_then_left_alone() -> None:
    boat = Files({})
    boat.run(60.0)
    assert boat.sent == [397] * fetching.ASKS + [395] * fetching.ASKS
    assert boat.fetching.state == "none"


def test_texts_that_cannot_be_read_are_fetched_again_and_then_left_alone() -> None:
    boat = files(b"no texts")
    for state in ("waiting", "waiting", "none"):
        boat.run(6.0)
        assert boat.say("mftp:///g", crc(boat.files["/g"])) == "here"
        boat.fetching.refuse()
        assert (boat.fetching.state, boat.fetching.packed) == (state, None)


def test_a_boat_that_starts_again_is_asked_again() -> None:
    boat = Files({})
    boat.run(60.0)
    boat.fetching.restart()
    boat.run(0.1)
    assert (boat.fetching.state, len(boat.sent)) == ("asking", 2 * fetching.ASKS + 1)


def test_the_older_message_leads_to_the_texts_too() -> None:
    boat = files(FILE)
    boat.run(0.1)
    message = ComponentInformation(0, crc(boat.files["/g"]), b"mftp:///g", 0, b"")
    boat.fetching.handle(message, boat.now_s)
    assert boat.fetching.state == "here"


@pytest.mark.parametrize("content", [b"", b"{", b"[]", b"\xff\xfe", b'{"metadataTypes": 5}', b"[" * 5_000])
def test_a_broken_general_file_is_tried_again_and_then_left_alone(content: bytes) -> None:
    boat = Files({"/g": content})
    for _ in range(10):
        boat.run(6.0)
        boat.say("mftp:///g", crc(content))
    assert boat.fetching.state == "none"
    assert boat.read == ["/g"] * fetching.TRIES


def test_a_damaged_general_file_is_not_used() -> None:
    boat = files(FILE)
    assert boat.say("mftp:///g", crc(boat.files["/g"]) ^ 1) == "waiting"
