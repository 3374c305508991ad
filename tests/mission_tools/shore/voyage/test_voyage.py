"""A log as a voyage, compared with pymavlink's reader; and logs that are cut, foreign or hostile."""

import json
import math
import random
import struct
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pymavlink import DFReader

from mission_tools.shore.voyage.__main__ import _voyage as voyage_of
from mission_tools.shore.voyage.samples import MOST_SAMPLES, Sample, Samples
from mission_tools.shore.voyage.voyage import MOST_EVENTS, NoVoyageError, read_voyage

pytestmark = pytest.mark.slow

READER = [sys.executable, "-m", "mission_tools.shore.voyage"]


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Of a boat that sailed the end of a mission, for a minute."""
    file = tmp_path_factory.mktemp("log") / "sail.bin"
    near = "50.0012,-1.1980"
    command = [sys.executable, "-m", "sitl", "sail", "lake", "--start", near, "--log", str(file)]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return file


def by_pymavlink(file: Path) -> dict[str, list[Any]]:
    reader, found = DFReader.DFReader_binary(str(file)), {}  # type: ignore[var-annotated]
    while (message := reader.recv_msg()) is not None:
        found.setdefault(message.get_type(), []).append(message)
    reader.filehandle.close()
    return found


def apart_m(a: Any, b: Any) -> float:  # noqa: ANN401
    """On the ellipsoid's mean radius, by the haversine."""
    lat_a, lat_b = math.radians(a.Lat), math.radians(b.Lat)
    h = math.sin((lat_b - lat_a) / 2) ** 2
    h += math.cos(lat_a) * math.cos(lat_b) * math.sin(math.radians(b.Lng - a.Lng) / 2) ** 2
    return 2 * 6_371_008.8 * math.asin(math.sqrt(h))


def test_a_voyage_is_what_pymavlink_reads(log: Path) -> None:
    voyage, records = read_voyage(log.read_bytes()), by_pymavlink(log)
    places = records["POS"]
    length_m = sum(apart_m(a, b) for a, b in zip(places[::10], places[10::10], strict=False))
    assert length_m > 20.0
    assert voyage["distance_m"] == pytest.approx(length_m, rel=0.03)
    shown = ("MSG", "MODE", "ARM", "EV", "POS", "GPS", "BAT")
    first_s = min(one.TimeUS for name in shown for one in records[name]) / 1e6
    last = places[-1]
    assert voyage["track"][-1] == pytest.approx([last.Lng, last.Lat], abs=1e-7)
    assert voyage["times_s"][-1] == pytest.approx(last.TimeUS / 1e6 - first_s, abs=0.01)
    errors = [abs(message.XTrack) for message in records["NTUN"]]
    assert voyage["largest_cross_track_m"] == pytest.approx(max(errors), abs=0.01)
    speeds = [math.hypot(message.VN, message.VE) for message in records["XKF1"]]
    assert voyage["largest_speed_m_s"] == pytest.approx(max(speeds), abs=0.01)
    assert voyage["voltages_v"][-1] == pytest.approx(records["BAT"][-1].Volt, abs=0.01)
    told = [event["text"] for event in voyage["events"] if event["kind"] == "message"]
    assert sorted(told) == sorted(message.Message for message in records["MSG"])
    modes = [event["text"] for event in voyage["events"] if event["kind"] == "mode"]
    assert "AUTO" in modes
    assert [event["at_s"] for event in voyage["events"]] == sorted(e["at_s"] for e in voyage["events"])
    assert voyage["begun_s"] == pytest.approx(
        places[0]._timestamp - places[0].TimeUS / 1e6 + first_s, abs=1.0
    )
    assert not voyage["is_cut"]


def test_columns_have_one_length_and_wanted_speeds_are_those_of_the_log(log: Path) -> None:
    voyage, records = read_voyage(log.read_bytes()), by_pymavlink(log)
    names = ("times_s", "speeds_m_s", "wanted_m_s", "voltages_v", "percents", "obstacles_m")
    assert {len(voyage[name]) for name in names} == {len(voyage["track"])}
    wanted = {round(message.DesSpeed, 2) for message in records["THR"] if math.isfinite(message.DesSpeed)}
    assert set(voyage["wanted_m_s"]) - {None} <= wanted
    assert max(wanted) > 0.5


def test_a_log_that_is_cut_is_shown_as_far_as_it_goes(log: Path) -> None:
    whole, content = read_voyage(log.read_bytes()), log.read_bytes()
    half = read_voyage(content[: len(content) // 2 + 1])
    assert half["is_cut"]
    assert 0.2 * whole["duration_s"] < half["duration_s"] < whole["duration_s"]
    damaged = bytearray(content)
    damaged[len(content) // 2 : len(content) // 2 + 500] = bytes(500)
    healed = read_voyage(bytes(damaged))
    assert healed["is_cut"]
    assert healed["duration_s"] == whole["duration_s"]


def fmt(kind: int, name: str, letters: str, labels: str, length: int | None = None) -> bytes:
    size = {"Q": 8, "B": 1, "L": 4, "f": 4, "H": 2, "I": 4, "Z": 64}
    length = 3 + sum(size[one] for one in letters) if length is None else length
    fields = (kind, length, name.encode(), letters.encode(), labels.encode())
    return b"\xa3\x95\x80" + struct.pack("<BB4s16s64s", *fields)


def record(kind: int, letters: str, *values: float | bytes) -> bytes:
    types = "<" + letters.replace("L", "i").replace("Z", "64s")
    return b"\xa3\x95" + bytes([kind]) + struct.pack(types, *values)


# As ArduCopter writes them: no POS at first, two receivers and batteries, another order of fields
FOREIGN = (
    fmt(1, "GPS", "QBBIHLLf", "TimeUS,I,Status,GMS,GWk,Lat,Lng,Spd")
    + fmt(2, "MODE", "QBB", "TimeUS,Mode,ModeNum")
    + fmt(3, "MSG", "QZ", "TimeUS,Message")
    + fmt(4, "BAT", "QBf", "TimeUS,Inst,Volt")
    + fmt(5, "EV", "QB", "TimeUS,Id")
    + fmt(6, "ERR", "QBB", "TimeUS,Subsys,ECode")
)


def foreign() -> bytes:
    parts = [FOREIGN, record(3, "QZ", 900_000, b"ArduCopter V4.5.7"), record(2, "QBB", 1_000_000, 5, 5)]
    parts += [record(5, "QB", 1_000_000, 10), record(6, "QBB", 1_500_000, 16, 2)]
    for n in range(100):
        at_us = 1_000_000 + 200_000 * n
        lat = 500_000_000 + 90 * n  # 1 m
        parts.append(record(1, "QBBIHLLf", at_us, 0, 3, 345_600_000, 2399, lat, 100_000_000, 5.0))
        parts.append(record(1, "QBBIHLLf", at_us, 1, 3, 0, 0, 0, 100_000_000, 50.0))  # a second receiver
        parts.append(record(4, "QBf", at_us, 1, 99.0) + record(4, "QBf", at_us, 0, 12.5))
    return b"".join([*parts, record(5, "QB", 30_000_000, 11)])


def test_a_log_of_another_vehicle_is_shown_by_its_receiver() -> None:
    voyage = read_voyage(foreign())
    assert voyage["distance_m"] == pytest.approx(99.0, abs=4.0)
    assert voyage["largest_speed_m_s"] == 5.0
    assert set(voyage["voltages_v"]) == {None, 12.5}
    kinds = [(event["kind"], event["text"]) for event in voyage["events"]]
    assert kinds == [
        ("message", "ArduCopter V4.5.7"),
        ("armed", ""),
        ("mode", "mode 5"),
        ("error", "Estimator: error 2"),
        ("disarmed", ""),
    ]
    assert voyage["begun_s"] == pytest.approx(315_964_800 + 2399 * 604_800 + 345_600 - 18, abs=0.2)


@pytest.mark.parametrize(
    ("content", "key"),
    [
        (b"", "voyage.empty"),
        (b"\0" * 5000, "voyage.foreign"),
        (b"\xa3\x95" * 5000, "voyage.foreign"),
        (FOREIGN, "voyage.no_position"),
        (fmt(1, "POS", "QLL", "TimeUS,Lat,Lng", length=200) * 9, "voyage.no_position"),
        (fmt(1, "POS", "QLL", "TimeUS,Lat", length=19) * 9, "voyage.no_position"),
        (fmt(1, "POS", "QLL", "TimeUS,Lat,Lng") + record(1, "QLL", 1, 0, 0), "voyage.no_position"),
        (fmt(1, "POS", "QLL", "TimeUS,Lat,Lng") + record(1, "QLL", 2**63, 1, 1), "voyage.no_position"),
        (
            fmt(1, "POS", "QLL", "TimeUS,Lat,Lng") + record(1, "QLL", 1, 2_000_000_000, 1),
            "voyage.no_position",
        ),
    ],
)
def test_what_cannot_be_shown_has_a_sentence(content: bytes, key: str) -> None:
    with pytest.raises(NoVoyageError) as refused:
        read_voyage(content)
    assert refused.value.args[0].key == key


@settings(max_examples=200, deadline=None)
@given(seed=st.integers(0, 2**32), changes=st.integers(1, 300), cut=st.integers(0, 6000))
def test_a_damaged_log_never_fails_otherwise(seed: int, changes: int, cut: int) -> None:
    chance, content = random.Random(seed), bytearray(foreign())
    for _ in range(changes):
        content[chance.randrange(len(content))] = chance.randrange(256)
    try:
        voyage = read_voyage(bytes(content[: len(content) - cut]))
    except NoVoyageError:
        return
    assert all(-180 <= lon <= 180 and -90 <= lat <= 90 for lon, lat in voyage["track"])
    json.dumps(voyage, allow_nan=False)


def test_a_long_log_is_thinned_and_its_way_is_not() -> None:
    samples = Samples(1.0)
    for n in range(50_000):
        lat = 1e-5 * n if n % 2 else 1e-5 * (n - 1)
        samples.add(Sample(float(n), 0.0, lat, None, None, None, None, None))
    kept = samples.finish()
    assert 900 < len(kept) <= MOST_SAMPLES
    assert (kept[0].at_s, kept[-1].at_s) == (0.0, 49_999.0)
    assert samples.distance_m == pytest.approx(49_999 * 1.112, rel=0.01)


def test_a_flood_of_messages_is_cut_and_counted() -> None:
    flood = b"".join(record(3, "QZ", 2_000_000 + n, b"again") for n in range(MOST_EVENTS + 100))
    voyage = read_voyage(foreign() + flood)
    assert len(voyage["events"]) == MOST_EVENTS + 2  # armed and disarmed are kept apart
    assert voyage["events_left_out"] == 103


def test_the_program_prints_a_voyage_or_a_sentence(log: Path, tmp_path: Path) -> None:
    done = subprocess.run([*READER, str(log)], check=True, capture_output=True)
    assert json.loads(done.stdout) == read_voyage(log.read_bytes())
    refused = subprocess.run([*READER, str(tmp_path / "missing.bin")], check=False, capture_output=True)
    assert (refused.returncode, refused.stderr) == (1, b"")
    assert json.loads(refused.stdout)["key"] == "voyage.unreadable"


@pytest.mark.parametrize(("size", "key"), [(0, "voyage.empty"), (200_000_001, "voyage.too_large")])
def test_an_empty_or_too_large_file_is_refused(tmp_path: Path, size: int, key: str) -> None:
    file = tmp_path / "log.bin"
    with file.open("wb") as opened:
        opened.truncate(size)
    with pytest.raises(NoVoyageError) as refused:
        voyage_of(file)
    assert refused.value.args[0].key == key
    assert refused.value.args[0].values == ({"n": 200, "most": 200} if size else {})
