"""The current item, its reports, and the go-to that travels as an item of no list."""

import math

import pytest
from boat_rig import BOAT, OK, Rig, waypoint
from mission_station import MISSION, loaded, result_of

from companion.mavlink.dialect import dialect
from companion.mavlink.items import MissionResult


@pytest.mark.parametrize("form", ["MISSION_ITEM", "MISSION_ITEM_INT"])
def test_the_old_go_to_sails_there_and_touches_no_list(form: str) -> None:
    rig = loaded(Rig().ready())
    there = waypoint(20.0, 0.0)
    assert rig.set_mode(15) == OK
    args = (*BOAT, 0, 3, 16, 2, 1, 0.0, 0.0, 0.0, math.nan)
    if form == "MISSION_ITEM":
        message = dialect.MAVLink_mission_item_message(*args, there.x / 1e7, there.y / 1e7, 50.0, 0)
    else:
        message = dialect.MAVLink_mission_item_int_message(*args, there.x, there.y, 50.0, 0)
    assert result_of(rig, message) is MissionResult.ACCEPTED
    target = rig.boat.vehicle.modes.guided.target
    assert target is not None
    assert target.lat_deg == pytest.approx(there.x / 1e7, abs=4e-6)  # a float32 degree is decimetres wide
    assert rig.items() == tuple(MISSION)


def test_the_current_item_is_set_and_told_at_once() -> None:
    rig = loaded()
    current = rig.answer_to(dialect.MAVLink_mission_set_current_message(*BOAT, 2), "MISSION_CURRENT")
    assert (current.seq, current.total) == (2, 3)
    current = rig.answer_to(dialect.MAVLink_mission_set_current_message(*BOAT, 9), "MISSION_CURRENT")
    assert current.seq == 2
    assert "Mission has no item 9 (last is 3)" in rig.peer.texts


def test_each_item_is_reported_once_and_in_order_with_the_current_item_moving_along() -> None:
    items = [waypoint(10.0, 0.0), waypoint(10.0, 10.0), waypoint(0.0, 10.0)]
    rig = Rig().sail(*items)
    rig.peer.forget()
    rig.until(lambda: rig.mode != "AUTO", 90.0)
    rig.run(0.5)
    assert [message.seq for message in rig.peer.said("MISSION_ITEM_REACHED")] == [1, 2, 3]
    seen = [message.seq for message in rig.peer.said("MISSION_CURRENT")]
    assert sorted(seen) == seen
    assert set(seen) == {1, 2, 3}
