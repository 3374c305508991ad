"""Read-back: every field counts, nothing else does."""

import math
import struct
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.core.geo import LatLon
from mission_tools.mission.mission import Command, Frame, MissionItem
from mission_tools.mission.wire import differences, same_float32

ITEM = MissionItem.at(LatLon(50.0, -1.2), Command.NAV_WAYPOINT, (1.0, 2.0, 3.0, math.nan), z=4.0)


def float32_bits(value: float) -> int:
    bits: int = struct.unpack("<I", struct.pack("<f", value))[0]
    return bits


@pytest.mark.parametrize(
    ("field", "changed"),
    [
        ("command", replace(ITEM, command=Command.NAV_LOITER_TIME)),
        ("frame", replace(ITEM, frame=Frame.GLOBAL)),
        ("x", replace(ITEM, x=ITEM.x + 1)),
        ("y", replace(ITEM, y=ITEM.y - 1)),
        ("z", replace(ITEM, z=4.5)),
        ("autocontinue", replace(ITEM, autocontinue=False)),
        ("param1", replace(ITEM, params=(1.5, 2.0, 3.0, math.nan))),
        ("param4", replace(ITEM, params=(1.0, 2.0, 3.0, 0.0))),
    ],
)
def test_a_change_in_any_field_is_found_and_named(field: str, changed: MissionItem) -> None:
    found = differences([ITEM, ITEM, ITEM], [ITEM, ITEM, changed], home_is_the_vehicles=True)
    assert [(difference.item, difference.field) for difference in found] == [(2, field)]


def test_home_is_left_out_only_where_it_is_the_vehicles() -> None:
    moved = replace(ITEM, x=7)
    assert differences([ITEM], [moved], home_is_the_vehicles=True) == []
    assert len(differences([ITEM], [moved], home_is_the_vehicles=False)) == 1


def test_missing_and_surplus_items_are_found() -> None:
    for sent, held in (([ITEM] * 3, [ITEM]), ([ITEM], [ITEM] * 3)):
        found = differences(sent, held, home_is_the_vehicles=False)
        assert [(difference.item, difference.field) for difference in found] == [(1, "number of items")]


def test_the_int_variant_of_a_frame_is_the_same_frame() -> None:
    other = replace(ITEM, frame=Frame.GLOBAL_RELATIVE_ALT_INT)
    assert differences([ITEM], [other], home_is_the_vehicles=False) == []


@given(st.floats(width=32, allow_nan=False, allow_infinity=False, min_value=2.0**-100, max_value=2.0**100))
def test_one_unit_in_the_last_place_is_allowed_and_two_are_not(value: float) -> None:
    bits = float32_bits(value)
    one, two = (struct.unpack("<f", struct.pack("<I", bits + step))[0] for step in (1, 2))
    assert same_float32(value, one)
    assert same_float32(-one, -value)
    assert not same_float32(value, two)


@given(st.floats())
def test_a_number_survives_the_wire_and_only_nan_equals_nan(value: float) -> None:
    try:
        held = struct.unpack("<f", struct.pack("<f", value))[0]
    except OverflowError:
        held = math.copysign(math.inf, value)
    assert same_float32(value, held)
    assert same_float32(value, math.nan) == math.isnan(value)


def test_both_zeros_are_the_same_and_tiny_numbers_of_either_sign_are_near() -> None:
    assert same_float32(0.0, -0.0)
    assert not same_float32(1e-45, -1e-45)
    assert not same_float32(1.0, -1.0)
