"""Where a ranger on a servo looks, bearing by bearing."""

from itertools import pairwise

from hypothesis import given
from hypothesis import strategies as st

from companion.sensors.servo_scan import ServoScan

ACROSS = (-1.0, -0.5, 0.0, 0.5, 1.0)


def looks(swing: ServoScan, count: int) -> list[float]:
    out = []
    for _ in range(count):
        out.append(swing.bearing_rad)
        swing.turn()
    return out


def test_it_goes_to_and_fro_and_looks_at_each_end_once() -> None:
    assert looks(ServoScan(ACROSS), 9) == [-1.0, -0.5, 0.0, 0.5, 1.0, 0.5, 0.0, -0.5, -1.0]


def test_it_sweeps_its_way_to_a_sector_and_stays_within() -> None:
    swing = ServoScan(ACROSS)
    swing.set_sector(0.4, 1.2)
    assert looks(swing, 8) == [-1.0, -0.5, 0.0, 0.5, 1.0, 0.5, 1.0, 0.5]


def test_a_sector_between_two_bearings_is_looked_at_by_the_nearer_one() -> None:
    swing = ServoScan(ACROSS)
    swing.set_sector(-0.4, -0.2)
    assert looks(swing, 4)[2:] == [-0.5, -0.5]


@given(st.lists(st.tuples(st.floats(-4.0, 4.0), st.floats(0.0, 4.0)), max_size=8))
def test_it_never_leaps_over_a_bearing(sectors: list[tuple[float, float]]) -> None:
    swing, seen = ServoScan(ACROSS), list[float]()
    for port_rad, width_rad in sectors:
        swing.set_sector(port_rad, port_rad + width_rad)
        seen += looks(swing, 5)
    assert all(abs(then - first) <= 0.5 for first, then in pairwise(seen))
