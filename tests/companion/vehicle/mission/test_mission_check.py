"""Missions and go-tos against the fence."""

import pytest
from boat_rig import OK, Rig, waypoint
from fence_rig import L_WATER, box, fenced, polygon

from companion.mavlink.items import MissionItem
from companion.mavlink.transfer import Completed

HOME_ITEM = waypoint(0.0, 0.0)


@pytest.mark.parametrize(
    ("items", "fault"),
    [
        ([waypoint(0.0, 60.0), waypoint(60.0, 60.0)], ""),
        ([waypoint(0.0, 60.0), waypoint(60.0, 80.0)], "item 2 is outside the fence"),
        ([waypoint(0.0, 10.0), waypoint(60.0, 60.0)], "the way to item 2 leaves the fence"),
        ([waypoint(0.0, 10.0), waypoint(30.0, 30.0, command=18, param1=1.0)], "item 2 is outside the fence"),
    ],
)
def test_a_mission_that_leaves_the_fence_is_told_and_not_sailed(items: list[MissionItem], fault: str) -> None:
    rig = fenced(Rig().ready(), *polygon(L_WATER))
    assert isinstance(rig.upload([HOME_ITEM, *items]), Completed)
    rig.run(0.2)
    assert [text for text in rig.peer.texts if text.startswith("Mission: ")] == (
        [f"Mission: {fault}"] if fault else []
    )
    assert (rig.set_mode(10) == OK) is (not fault)
    if fault:
        assert f"AUTO: {fault}" in rig.peer.texts


def test_a_go_to_outside_the_fence_is_refused() -> None:
    rig = fenced(Rig().ready(), *polygon(box(-20.0, -20.0, 20.0, 20.0)))
    rig.run(0.1)
    assert rig.set_mode(15) == OK
    there = waypoint(50.0, 0.0)
    rig.peer.forget()
    rig.peer.command_int(192, -1, 1, 0, x=there.x, y=there.y)
    rig.receive()
    (ack,) = rig.peer.said("COMMAND_ACK")
    assert ack.result != OK
    assert "Go to: outside the fence" in rig.peer.texts
    assert rig.boat.vehicle.modes.guided.target is None
