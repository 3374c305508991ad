"""The log's fast way from local metres to degrees is the exact one's, on both sides of the antimeridian."""

from pathlib import Path

import pytest
from boat_rig import nav_at
from log_rig import of_kind, read_log

from companion.core.geo import LatLon, LocalFrame, Point
from companion.core.readings import ProbeReading
from companion.log.linear_frame import LinearFrame
from companion.log.records import HEADER
from companion.log.samples import probe

NEAREST_E7 = 2  # 2 cm


@pytest.mark.parametrize("lon_deg", [-1.2, 179.9999, -179.9999, 180.0])
@pytest.mark.parametrize("here", [Point(0.0, 0.0), Point(10.0, 20.0), Point(-10.0, -20.0)])
def test_places_are_those_of_the_frame(lon_deg: float, here: Point) -> None:
    frame = LocalFrame(LatLon(-17.0, lon_deg))
    linear = LinearFrame(frame, here)
    assert linear.is_of(frame)
    assert not linear.is_of(LocalFrame(frame.origin))
    for north_m, east_m in ((0.0, 0.0), (30.0, 30.0), (-30.0, 15.0), (5.0, -25.0)):
        place = frame.to_global(Point(north_m, east_m))
        lat_e7, lon_e7 = linear.to_e7(north_m, east_m)
        assert abs(lat_e7 - place.lat_deg * 1e7) < NEAREST_E7
        assert abs(lon_e7) <= 1_800_000_000
        around = abs(lon_e7 - place.lon_deg * 1e7)
        assert min(around, 3_600_000_000 - around) < NEAREST_E7


def test_far_from_the_origin_in_the_north_meridians_converge() -> None:
    here, frame = Point(5000.0, 8000.0), LocalFrame(LatLon(70.0, 20.0))
    linear = LinearFrame(frame, here)
    for north_m, east_m in ((5030.0, 8030.0), (4970.0, 8015.0), (5005.0, 7975.0)):
        place = frame.to_global(Point(north_m, east_m))
        lat_e7, lon_e7 = linear.to_e7(north_m, east_m)
        assert abs(lat_e7 - place.lat_deg * 1e7) < NEAREST_E7
        assert abs(lon_e7 - place.lon_deg * 1e7) < 3 * NEAREST_E7  # a third of a metre's degrees at 70°


def test_a_probes_value_is_logged_at_its_time_where_the_boat_is(tmp_path: Path) -> None:
    frame, path = LocalFrame(LatLon(50.0, -1.2)), tmp_path / "1.bin"
    reading = ProbeReading(2.5, "turbidity", 3.5, "NTU")
    place = frame.to_global(Point(10.0, 20.0))
    path.write_bytes(HEADER + probe(reading, nav_at(10.0, 20.0), LinearFrame(frame, Point(0.0, 0.0))))
    (record,) = of_kind(read_log(path), "PROB")
    assert (record.TimeUS, record.Name, record.Value, record.Unit) == (2_500_000, "turbidity", 3.5, "NTU")
    assert (record.Lat, record.Lng) == pytest.approx((place.lat_deg, place.lon_deg), abs=2e-7)
