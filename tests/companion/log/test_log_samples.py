"""Readings as records, by pymavlink's reader."""

import math
from collections.abc import Iterable
from pathlib import Path

import msgspec
import pytest
from boat_rig import nav_at
from log_rig import LogRig, OpenRig, Record, of_kind, read_log

from companion.core.geo import LatLon, LocalFrame, Point
from companion.core.readings import (
    BatteryReading,
    DepthReading,
    GnssFix,
    HeadingReading,
    ProbeReading,
    SonarReading,
)
from companion.core.tick_count import TickCount
from companion.log import samples
from companion.log.records import HEADER

pytest_plugins = ("log_fixtures",)

FIX = GnssFix(2.5, LatLon(50.0, -1.2), 3, 12, 0.9)
GPS_EPOCH_S, LEAP_S, WEEK_S = 315_964_800, 18, 604_800


def logged(folder: Path, records: Iterable[bytes], kind: str) -> list[Record]:
    path = folder / "1.bin"
    path.write_bytes(HEADER + b"".join(records))
    return of_kind(read_log(path), kind)


@pytest.mark.parametrize(
    ("used_mah", "left_percent"), [(0.0, 100), (1250.0, 75), (5000.0, 0), (6000.0, 0), (-10.0, 100)]
)
def test_the_pack_is_logged_with_the_share_of_its_charge(
    tmp_path: Path, used_mah: float, left_percent: int
) -> None:
    records = [samples.battery(BatteryReading(2.5, 11.5, 3.25), used_mah, 5000.0)]
    (pack,) = logged(tmp_path, records, "BAT")
    assert (pack.TimeUS, pack.Volt, pack.Curr, pack.CurrTot) == (2_500_000, 11.5, 3.25, used_mah)
    assert pack.RemPct == left_percent


def test_a_fix_is_logged_with_its_course_date_and_accuracy(tmp_path: Path) -> None:
    unix_s = GPS_EPOCH_S - LEAP_S + 2400 * WEEK_S + 3.125
    fix = msgspec.structs.replace(
        FIX, north_m_s=-3.0, east_m_s=-4.0, unix_time_s=unix_s, altitude_m=-12.5, heading_rad=-0.5,
        horizontal_accuracy_m=0.75, vertical_accuracy_m=1.5, speed_accuracy_m_s=0.25,
        heading_accuracy_rad=0.125,
    )  # fmt: skip
    (gps,) = logged(tmp_path, samples.gnss(fix), "GPS")
    assert (gps.I, gps.Status, gps.NSats, gps.HDop, gps.U) == (0, 3, 12, 0.9, 1)
    assert (gps.GWk, gps.GMS) == (2400, 3125)
    assert (gps.Lat, gps.Lng, gps.Alt) == pytest.approx((50.0, -1.2, -12.5))
    assert gps.Spd == 5.0
    assert gps.GCrs == pytest.approx(180.0 + math.degrees(math.atan2(4.0, 3.0)))
    assert gps.Yaw == pytest.approx(360.0 - math.degrees(0.5))
    (gpa,) = logged(tmp_path, samples.gnss(fix), "GPA")
    assert (gpa.VDop, gpa.HAcc, gpa.VAcc, gpa.SAcc) == (0.0, 0.75, 1.5, 0.25)
    assert gpa.YAcc == pytest.approx(math.degrees(0.125))
    assert gpa.SMS == 2500


def test_what_a_fix_lacks_or_a_field_cannot_hold_is_no_fault(tmp_path: Path) -> None:
    odd = msgspec.structs.replace(FIX, hdop=math.inf, altitude_m=-1e12, satellites=400, unix_time_s=-1e12)
    (gps,) = logged(tmp_path, samples.gnss(odd), "GPS")
    assert (gps.HDop, gps.Alt, gps.NSats) == pytest.approx((327.67, -(2**31 - 1) / 100.0, 255))
    assert gps.GWk == 0
    assert math.isnan(gps.Spd)
    assert logged(tmp_path, samples.gnss(odd), "GPA") == []


@pytest.mark.parametrize(
    ("bearing_deg", "range_m", "orientation", "status", "distance_m"),
    [(0.0, 1.25, 0, 4, 1.25), (45.0, None, 1, 3, 4.0), (-45.0, 2.0, 7, 4, 2.0), (-10.0, 2.0, 0, 4, 2.0)],
)
def test_a_ping_is_logged_in_its_eighth_and_with_its_bearing(
    tmp_path: Path,
    bearing_deg: float,
    range_m: float | None,
    orientation: int,
    status: int,
    distance_m: float,
) -> None:
    ping = SonarReading(2.5, math.radians(bearing_deg), range_m)
    (found,) = logged(tmp_path, samples.sonar(ping), "RFND")
    assert (found.TimeUS, found.Dist, found.Stat, found.Orient) == (
        2_500_000,
        distance_m,
        status,
        orientation,
    )
    (seen,) = logged(tmp_path, samples.sonar(ping), "SONR")
    assert seen.Brg == pytest.approx(bearing_deg)
    assert seen.Max == 4.0
    assert math.isnan(seen.Dist) if range_m is None else seen.Dist == range_m


@pytest.mark.parametrize(("quality", "percent"), [(0.97, 97), (0.0, 0), (None, -1)])
def test_a_sounding_is_logged_with_its_quality_and_its_transducers_depth(
    tmp_path: Path, quality: float | None, percent: int
) -> None:
    frame = LocalFrame(LatLon(50.0, -1.2))
    sounding = DepthReading(2.5, 3.25, 15.5, 0.125, quality=quality)
    record = samples.depth(sounding, nav_at(0.0, 0.0), frame)
    (found,) = logged(tmp_path, [record], "DPTH")
    assert (found.TimeUS, found.Inst, found.Depth, found.Temp) == (2_500_000, 1, 3.25, 15.5)
    assert (found.Quality, found.PosZ) == (percent, 0.125)
    assert (found.Lat, found.Lng) == (50.0, -1.2)


@pytest.mark.parametrize("lon_deg", [-1.2, 179.9999, -179.9999])
def test_a_probes_value_is_logged_at_its_time_where_the_boat_is(tmp_path: Path, lon_deg: float) -> None:
    frame = LocalFrame(LatLon(50.0, lon_deg))
    reading = ProbeReading(2.5, "turbidity", 3.5, "NTU")
    place = frame.to_global(Point(10.0, 20.0))
    (record,) = logged(tmp_path, [samples.probe(reading, nav_at(10.0, 20.0), frame)], "PROB")
    assert (record.TimeUS, record.Name, record.Value, record.Unit) == (2_500_000, "turbidity", 3.5, "NTU")
    assert (record.Lat, record.Lng) == pytest.approx((place.lat_deg, place.lon_deg), abs=2e-7)


def test_roll_pitch_and_the_heading_from_every_side_are_logged_in_degrees(
    open_rig: OpenRig, tmp_path: Path
) -> None:
    rig = open_rig(tmp_path)
    rig.ready().run(1.0)
    now = rig.boat.take_snapshot()
    assert now.vehicle.nav is not None
    rig.boat.sensors.compass = HeadingReading(2.5, 0.0, roll_rad=0.125, pitch_rad=-0.25)
    now.vehicle.nav = msgspec.structs.replace(now.vehicle.nav, heading_rad=-1e-9)
    records = list(samples.motion(now))
    (att,) = logged(tmp_path, records, "ATT")
    assert (att.Roll, att.Pitch) == pytest.approx((math.degrees(0.125), math.degrees(-0.25)))
    (estimate,) = logged(tmp_path, records, "XKF1")
    assert estimate.Yaw == 0.0, "360° is 0°"


def test_the_load_of_the_real_time_loop_is_logged(open_rig: OpenRig, tmp_path: Path) -> None:
    rig: LogRig = open_rig(tmp_path)
    timing = rig.log.timing = TickCount()
    rig.ready()
    rig.arm()
    timing.run, timing.late, timing.worst_s, rig.boat.load = 50, 2, 0.0125, 0.25
    rig.run(1.0)
    timing.run, timing.late = 100, 3
    rig.run(1.2)
    rig.boat.close()
    loads = of_kind(read_log(tmp_path / "00001.bin"), "PM")
    assert [(one.LR, one.NLon, one.NL) for one in loads[-2:]] == [(50, 1, 50), (0, 0, 0)]
    assert {one.MaxT for one in loads} == {12_500}
    assert [one.Load for one in loads] == [250] * len(loads)  # tenths of a percent
