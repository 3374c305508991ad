"""The autotune stores the hull that its gains are for."""

import math

import msgspec
import pytest

from companion.calibration.heading import hull
from companion.core.state import NavState

AFLOAT = NavState(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


def test_the_hull_is_what_the_filter_has_learned() -> None:
    nav = msgspec.structs.replace(AFLOAT, yaw_accel_rad_s2=0.5, yaw_damping_per_s=0.4)
    found = {one.name: one.value for one in hull(nav)}
    assert found == pytest.approx({"HND_TURN_ACCEL": math.degrees(0.5), "HND_TURN_TIME": 2.5})
    undamped = msgspec.structs.replace(nav, yaw_damping_per_s=0.0)
    assert {one.name: one.value for one in hull(undamped)}["HND_TURN_TIME"] == pytest.approx(10.0)


def test_a_hull_that_is_not_known_is_not_stored() -> None:
    assert hull(AFLOAT) == []
