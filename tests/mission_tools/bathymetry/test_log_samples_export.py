"""Samples of a log: at their own time and place, whatever is cut off, and as a table.

The log holds a boat that sails a circle; where its transducer was follows from the circle itself, in the
local frame of the companion. pymavlink's reader says what time each record has.
"""

import contextlib
import csv
import io
import math
import random
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from boat_rig import nav_at
from log_rig import of_kind, read_log
from pymavlink.DFReader import DFReader_binary

from companion.core.geo import LatLon, LocalFrame, Point, position_to_e7
from companion.core.readings import DepthReading, GnssFix, ProbeReading
from companion.core.units import wrap_two_pi
from companion.log import records as r
from companion.log import samples
from mission_tools.bathymetry.from_log import read_logs, read_samples, soundings_of
from mission_tools.bathymetry.sample_table import write_table
from mission_tools.cli.survey import run_program
from mission_tools.errors import LogError

RADIUS_M, SPEED_M_S, FORWARD_M, STARBOARD_M, LATENCY_S = 12.0, 1.5, -0.4, 0.25, 0.15
START_UNIX_S = 1_790_000_000.25
PLAN = [(50.001, -1.2), (50.002, -1.201), (50.001, -1.202)]


def circle(time_s: float) -> tuple[float, float, float]:
    """North, east and heading on the circle, clockwise."""
    angle = SPEED_M_S / RADIUS_M * time_s
    return RADIUS_M * math.cos(angle), RADIUS_M * math.sin(angle), angle + 0.5 * math.pi


def parameter(name: str, value: float) -> bytes:
    return r.PARM.pack(0, name.encode(), value, 0.0)


def item(number: int, command: int, lat_deg: float, lon_deg: float) -> bytes:
    return r.CMD.pack(0, 9, number, command, 0, 0, 0, 0, round(1e7 * lat_deg), round(1e7 * lon_deg), 0, 3)


def voyage(lon_deg: float = -1.2, seconds: int = 120, *, is_dated: bool = True) -> Iterator[bytes]:
    """The log's records: ten times a second the motion, five times a second a sounding."""
    frame = LocalFrame(LatLon(50.0, lon_deg))
    yield from (
        parameter("RNGFND2_POS_X", FORWARD_M), parameter("RNGFND2_POS_Y", STARBOARD_M),
        parameter("RNGFND2_LATENCY", LATENCY_S), parameter("RNGFND2_SOUND", 1450.0),
    )  # fmt: skip
    for plan in ([(50.5, 0.5)], PLAN):  # the second was uploaded later, and has a home and a speed
        yield item(0, 16, 50.0, lon_deg)
        yield from (item(n, 16, *place) for n, place in enumerate(plan, 1))
        yield item(9, 178, 0.0, 0.0)
    for tick in range(10 * seconds):
        us, (north_m, east_m, heading) = 100_000 * tick, circle(0.1 * tick)
        lat_e7, lon_e7 = position_to_e7(frame.to_global(Point(north_m, east_m)))
        yield r.ATT.pack(us, 0, 2.0, 0, -1.0, 0, math.degrees(wrap_two_pi(heading)), 0)
        yield r.EST.pack(us, 0, 0, 0.75, 0)
        yield r.XKF1.pack(
            us, 0, 0, 0, 0, SPEED_M_S * math.cos(heading), SPEED_M_S * math.sin(heading), *9 * [0]
        )
        yield r.POS.pack(us, lat_e7, lon_e7, 0.0, 0.0, 0.0)
        if tick % 10 == 0:
            unix_s = START_UNIX_S + 1e-6 * us if is_dated else None
            yield from samples.gnss(GnssFix(1e-6 * us, LatLon(50.0, 0.0), 3, 9, 1.0, unix_time_s=unix_s))
            reading = ProbeReading(1e-6 * us, "turb,1", 0.1 * tick, "NTU")
            yield samples.probe(reading, nav_at(north_m, east_m), frame)
        if tick % 2 == 0:
            depth_m = None if tick % 40 == 0 else 2.0 + 0.01 * tick
            sounding = DepthReading(1e-6 * us, depth_m, 14.5, 0.125, quality=0.5)
            yield samples.depth(sounding, nav_at(north_m, east_m), frame)


def written(path: Path, records: Iterator[bytes]) -> Path:
    path.write_bytes(r.HEADER + b"".join(records))
    return path


@pytest.mark.parametrize("lon_deg", [-1.2, 180.0])
def test_soundings_are_where_their_transducer_was_when_it_measured(tmp_path: Path, lon_deg: float) -> None:
    log = written(tmp_path / "1.bin", voyage(lon_deg))
    found = soundings_of(read_logs([log]))
    frame, told = LocalFrame(LatLon(50.0, lon_deg)), of_kind(read_log(log), "DPTH")
    assert len(told) == len(found.depth_m) == 600
    for number in range(5, 600, 11):
        north_m, east_m, heading = circle(0.2 * number - LATENCY_S)
        north_m += FORWARD_M * math.cos(heading) - STARBOARD_M * math.sin(heading)
        east_m += FORWARD_M * math.sin(heading) + STARBOARD_M * math.cos(heading)
        place = frame.to_local(LatLon(found.lat_deg[number], found.lon_deg[number]))
        assert place == pytest.approx((north_m, east_m), abs=0.02)  # 1e-7 degrees are 1.1 cm
        away = (found.heading_rad[number] - heading + math.pi) % math.tau - math.pi
        assert away == pytest.approx(0.0, abs=0.01)
        assert 0.0 <= found.heading_rad[number] < math.tau
        assert found.unix_s[number] == pytest.approx(START_UNIX_S + 0.2 * number - LATENCY_S, abs=2e-3)
    assert np.nanmax(np.abs(found.speed_m_s - SPEED_M_S)) < 0.01
    assert set(np.round(np.degrees(found.roll_rad[5:]), 3)) == {2.0}
    assert set(np.round(np.degrees(found.pitch_rad[5:]), 3)) == {-1.0}
    assert set(found.position_sd_m[5:]) == {0.75}
    assert set(found.quality) == {0.5}
    np.testing.assert_allclose(found.plans[0], PLAN, atol=1e-7)
    assert (found.transducer_m, found.sound_m_s, set(found.voyage)) == (0.125, 1450.0, {0})
    np.testing.assert_allclose(found.depth_m, [one.Depth for one in told])
    assert np.flatnonzero(np.isnan(found.depth_m)).tolist() == list(range(0, 600, 20))


def test_dates_are_those_that_pymavlink_gives_the_records(tmp_path: Path) -> None:
    log = written(tmp_path / "1.bin", voyage())
    found = read_samples(log)
    with DFReader_binary(str(log)) as reader:
        dates = []
        while (record := reader.recv_msg()) is not None:
            if record.get_type() == "PROB":
                dates.append(record._timestamp)
    np.testing.assert_allclose(found.probed.unix_s, dates, atol=2e-3)


def test_a_cut_at_any_byte_loses_no_whole_sample(tmp_path: Path) -> None:
    records = list(voyage(seconds=20))
    whole = r.HEADER + b"".join(records)
    ends = len(r.HEADER) + np.cumsum([len(record) for record in records])
    soundings = np.array([record[2] == r.DPTH.number for record in records])
    probes = np.array([record[2] == r.PROB.number for record in records])
    everything = read_samples(written(tmp_path / "whole.bin", iter(records)))
    cuts, path = random.Random(61), tmp_path / "cut.bin"
    for _ in range(150):
        at = cuts.randrange(len(r.HEADER), len(whole))
        path.write_bytes(whole[:at])
        found = read_samples(path)
        count = int(soundings[ends <= at].sum())
        np.testing.assert_array_equal(found.soundings.depth_m, everything.soundings.depth_m[:count])
        assert len(found.values) == probes[ends <= at].sum()
        assert bool(found.notes and "cut off" in found.notes[0]) is (at not in ends and at != len(r.HEADER))


def test_a_damaged_log_is_read_or_refused_and_never_a_traceback(tmp_path: Path) -> None:
    whole, damage, path = r.HEADER + b"".join(voyage(seconds=4)), random.Random(62), tmp_path / "damaged.bin"
    for count in 60 * (1, 5, 50, 400):
        data = bytearray(whole)
        for _ in range(count):
            data[damage.randrange(len(data))] = damage.randrange(256)
        path.write_bytes(data)
        with contextlib.suppress(LogError):
            samples_of = read_samples(path)
            write_table([samples_of], io.StringIO())
            soundings_of([samples_of])


def test_logs_become_one_as_if_with_one_transducer_and_one_speed_of_sound(tmp_path: Path) -> None:
    first = written(tmp_path / "1.bin", voyage(seconds=3))
    other = [
        parameter("RNGFND2_SOUND", 1500.0),
        samples.depth(
            DepthReading(0.0, 3.0, None, 0.325), nav_at(0.0, 0.0), LocalFrame(LatLon(50.0, 1.0)),
        ),
    ]  # fmt: skip
    second = written(tmp_path / "2.bin", iter(other))
    found = soundings_of(read_logs([first, second]))
    assert (found.names, found.voyage[-1]) == (("1.bin", "2.bin"), 1)
    assert found.depth_m[-1] == pytest.approx(3.0 * 1450.0 / 1500.0 + 0.325 - 0.125)
    assert (found.lat_deg[-1], found.lon_deg[-1]) == pytest.approx((50.0, 1.0))  # the record's own
    for unknown in (found.heading_rad, found.unix_s, found.roll_rad, found.quality, found.temperature_c):
        assert math.isnan(unknown[-1])


def test_a_log_of_ardupilots_rover_has_soundings_of_its_first_sounder_without_a_quality(
    tmp_path: Path,
) -> None:
    """Rover's DPTH as its Log.cpp writes it; the format letters are its own."""
    rovers = r.RecordKind(27, "DPTH", "QBLLff", "TimeUS,Inst,Lat,Lng,Depth,Temp", "s#DUmO", "F-GG00")
    gps = (3, 302_418_000, 2400, 9, 90, 500_000_000, -12_000_000, 0, 0.0, 0.0, 0.0, 0.0, 1)
    records = [
        parameter("RNGFND1_POS_X", 3.0), parameter("RNGFND1_POS_Z", 0.2), parameter("RNGFND2_POS_X", 99.0),
        r.GPS.pack(1_000_000, 0, *gps), r.GPS.pack(1_000_000, 1, 3, 0, 1200, *gps[3:]),
        *(r.ATT.pack(us, 0, 0.0, 0, 0.0, 0, 0.0, 0) for us in (1_000_000, 1_200_000)),
        *(r.POS.pack(us, 500_000_000, -12_000_000, 0.0, 0.0, 0.0) for us in (1_000_000, 1_200_000)),
        rovers.pack(1_100_000, 0, 500_000_000, -12_000_000, 4.5, 12.0),
        rovers.pack(1_100_000, 1, 500_000_000, -12_000_000, 7.5, 12.0),
        rovers.pack(1_200_000, 0, 500_000_000, -12_000_000, 0.0, 12.0),
    ]  # fmt: skip
    log = tmp_path / "rover.bin"
    log.write_bytes(r.file_header([rovers, r.GPS, r.ATT, r.POS, r.PARM]) + b"".join(records))
    found = soundings_of(read_logs([log]))
    assert [record.Depth for record in of_kind(read_log(log), "DPTH")] == [4.5, 7.5, 0.0]
    np.testing.assert_array_equal(found.depth_m, [4.5, np.nan])
    assert np.isnan([found.quality, found.roll_rad, found.pitch_rad, found.speed_m_s]).all()
    assert found.unix_s[0] == pytest.approx(315_964_800 - 18 + 2400 * 604_800 + 302_418 + 0.1, abs=1e-3)
    assert found.transducer_m == pytest.approx(0.2)
    assert found.sound_m_s == 1480.0
    assert 111_240.0 * (found.lat_deg[0] - 50.0) == pytest.approx(3.0, abs=0.02)  # m a degree at 50°


def test_the_table_has_a_row_a_value(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    log, out = written(tmp_path / "1.bin", voyage(seconds=20)), tmp_path / "survey.csv"
    assert run_program(["export", str(log), "--out", str(out)]) == 0
    assert capsys.readouterr().out == f"220 samples of 1 log saved in {out}\n"
    with out.open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["name"] for row in rows] == 100 * ["depth"] + 100 * ["temperature"] + 20 * ["turb,1"]
    deep, probe = rows[21], rows[-1]
    assert deep["time"] == "2026-09-21T14:13:24.300Z"
    assert float(deep["unix_s"]) == START_UNIX_S + 4.2 - LATENCY_S
    keys = (
        "log_s",
        "value",
        "unit",
        "quality",
        "transducer_m",
        "roll_deg",
        "speed_m_s",
        "position_sd_m",
        "log",
    )
    assert [deep[key] for key in keys] == [
        "4.050", "2.420", "m", "0.50", "0.125", "2.00", "1.500", "0.750", "1.bin",
    ]  # fmt: skip
    assert rows[20]["value"] == ""  # no bottom
    assert (probe["value"], probe["unit"], probe["log_s"], probe["quality"]) == ("19", "NTU", "19.000", "")
    assert run_program(["export", str(log)]) == 0
    assert capsys.readouterr().out == out.read_text(encoding="utf-8")


def test_each_unusable_log_is_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    def told(*paths: Path) -> tuple[int, str]:
        code = run_program(["export", *map(str, paths), "--out", str(tmp_path / "out.csv")])
        return code, capsys.readouterr().err

    foreign, empty, undated = tmp_path / "x.bin", tmp_path / "e.bin", tmp_path / "u.bin"
    foreign.write_text("no log")
    written(empty, iter(()))
    written(undated, voyage(seconds=2, is_dated=False))
    assert told(foreign) == (
        2, f"boat-survey: {foreign}: no DataFlash log: expected a .bin of the boat's folder logs\n"
    )  # fmt: skip
    assert told(tmp_path / "none.bin")[0] == 2
    code, text = told(empty)
    assert (code, text.count("\n")) == (2, 2)
    assert "without samples: no sounding (DPTH)" in text
    code, text = told(undated)
    assert (code, text.count("\n")) == (0, 1)
    assert "without a date" in text
    assert (tmp_path / "out.csv").read_text(encoding="utf-8").splitlines()[1].startswith(",,-0.150,50.0")
    (tmp_path / "out.csv").write_text("mine")
    assert told(undated)[0] == 2
    assert (tmp_path / "out.csv").read_text(encoding="utf-8") == "mine"
    with pytest.raises(LogError, match=r"e\.bin: no soundings \(DPTH\)"):
        soundings_of(read_logs([empty]))
