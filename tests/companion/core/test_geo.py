import math

import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from pyproj import Transformer

from companion.core.geo import (
    LatLon,
    Line,
    LocalFrame,
    Point,
    bearing_rad,
    distance_m,
)
from companion.core.units import TAU, deg_to_e7, e7_to_deg, wrap_pi, wrap_two_pi

origins = st.builds(LatLon, st.floats(-85.0, 85.0), st.floats(-180.0, 180.0))
offsets_m = st.floats(-14_000.0, 14_000.0)  # a square whose corners are 20 km away


def peer_of(origin: LatLon) -> Transformer:
    """PROJ's transverse Mercator with the same origin."""
    plane = f"+proj=tmerc +lat_0={origin.lat_deg!r} +lon_0={origin.lon_deg!r} +k=1 +ellps=WGS84 +units=m"
    return Transformer.from_crs("EPSG:4326", plane, always_xy=True)


@given(origins, offsets_m, offsets_m)
@example(LatLon(85.0, 10.0), 14_000.0, 14_000.0)
@example(LatLon(-85.0, 179.9), -14_000.0, 14_000.0)
@example(LatLon(60.0, 0.0), 0.0, 20_000.0)
def test_the_frame_agrees_with_proj_to_a_millimetre_within_20_km(
    origin: LatLon, north_m: float, east_m: float
) -> None:
    peer = peer_of(origin)
    lon_deg, lat_deg = peer.transform(east_m, north_m, direction="INVERSE")
    north, east = LocalFrame(origin).to_local(LatLon(lat_deg, lon_deg))
    assert math.hypot(north - north_m, east - east_m) < 1e-3


@given(origins, offsets_m, offsets_m)
def test_a_position_survives_the_round_trip(origin: LatLon, north_m: float, east_m: float) -> None:
    frame = LocalFrame(origin)
    north, east = frame.to_local(frame.to_global(Point(north_m, east_m)))
    assert math.hypot(north - north_m, east - east_m) < 1e-3


@pytest.mark.parametrize(("origin_deg", "at_deg", "side"), [(179.99, -179.99, 1), (-179.99, 179.99, -1)])
def test_the_antimeridian_is_no_edge(origin_deg: float, at_deg: float, side: int) -> None:
    frame = LocalFrame(LatLon(-17.0, origin_deg))
    east_m = frame.to_local(LatLon(-17.0, at_deg)).east_m
    assert east_m == pytest.approx(side * 2129.6, abs=1.0)
    back = frame.to_global(Point(0.0, east_m))
    assert back.lon_deg == pytest.approx(at_deg, abs=1e-6)


@pytest.mark.parametrize(
    ("lat_deg", "lon_deg", "word"),
    [
        (90.1, 0.0, "latitude"),
        (math.nan, 0.0, "latitude"),
        (0.0, -180.5, "longitude"),
        (0.0, math.inf, "longitude"),
    ],
)
def test_what_is_no_place_is_refused_by_name(lat_deg: float, lon_deg: float, word: str) -> None:
    with pytest.raises(ValueError, match=word):
        LatLon(lat_deg, lon_deg)


def test_bearings_turn_clockwise_from_north() -> None:
    here = Point(1.0, 1.0)
    around = [Point(2.0, 1.0), Point(1.0, 2.0), Point(0.0, 1.0), Point(1.0, 0.0)]
    degrees = [math.degrees(bearing_rad(here, there)) for there in around]
    assert degrees == pytest.approx([0.0, 90.0, 180.0, -90.0])


@given(*[st.floats(-1e3, 1e3)] * 6)
def test_along_and_cross_track_are_a_rotation(
    n0: float, e0: float, n1: float, e1: float, n: float, e: float
) -> None:
    along_m, cross_m = Line(Point(n0, e0), Point(n1, e1)).along_and_cross_track_m(Point(n, e))
    assert math.hypot(along_m, cross_m) == pytest.approx(distance_m(Point(n0, e0), Point(n, e)), abs=1e-6)


def test_starboard_of_the_line_is_positive() -> None:
    assert Line(Point(0, 0), Point(10, 0)).along_and_cross_track_m(Point(3, 2)) == pytest.approx((3.0, 2.0))
    assert Line(Point(0, 0), Point(0, 10)).along_and_cross_track_m(Point(3, 2)) == pytest.approx((2.0, -3.0))
    assert Line(Point(0, 0), Point(0, 0)).along_and_cross_track_m(Point(3, 2)) == pytest.approx((3.0, 2.0))


angles = st.floats(-1e4, 1e4)


@given(angles)
def test_a_wrapped_angle_lies_in_the_half_open_turn_and_points_the_same_way(angle_rad: float) -> None:
    wrapped = wrap_pi(angle_rad)
    assert -math.pi <= wrapped < math.pi
    assert math.cos(wrapped - angle_rad) == pytest.approx(1.0, abs=1e-9)


@given(angles)
def test_an_angle_wrapped_to_a_whole_turn_is_never_the_turn_itself(angle_rad: float) -> None:
    wrapped = wrap_two_pi(angle_rad)
    assert 0.0 <= wrapped < TAU
    assert math.cos(wrapped - angle_rad) == pytest.approx(1.0, abs=1e-9)


@given(st.integers(-1_800_000_000, 1_800_000_000))
def test_scaled_degrees_survive_the_round_trip(angle_e7: int) -> None:
    assert deg_to_e7(e7_to_deg(angle_e7)) == angle_e7
