"""The way onto a mission, from wherever the water has carried the boat."""

import math

from boat_rig import Rig, waypoint
from fence_rig import EXCLUDED, L_WATER, box, fenced, margin_m, polygon

ROUND = "The way to the mission leads round the shore"


def sail_out(rig: Rig, limit_s: float) -> float:
    """To the end of the mission; how near the fence the boat came."""
    began_s, least = rig.now_s, math.inf
    while rig.mode == "AUTO":
        rig.run(0.2)
        least = min(least, margin_m(rig))
        assert rig.now_s - began_s < limit_s
    return least


def test_a_first_leg_that_would_leave_the_water_goes_round_the_corner() -> None:
    rig = fenced(Rig().ready(), *polygon(L_WATER))
    rig.sail(waypoint(60.0, 60.0))
    assert sail_out(rig, 120.0) > 2.0
    assert ROUND in rig.peer.texts
    assert rig.offset_m(60.0, 60.0) < 4.0


def test_a_boat_set_off_its_plan_keeps_clear_of_an_islet_beside_it() -> None:
    rig = Rig("open", "environment.current_m_s=0.8", "environment.current_to_deg=0.0").ready()
    fenced(rig, *polygon(box(-60.0, -60.0, 120.0, 120.0)), *polygon(box(5.0, 28.0, 15.0, 40.0), EXCLUDED))
    rig.run(5.0)  # the straight way from here leads over it
    rig.sail(waypoint(10.0, 80.0), waypoint(30.0, 80.0))
    assert sail_out(rig, 150.0) > 2.0
    assert ROUND in rig.peer.texts
    assert [message.seq for message in rig.peer.said("MISSION_ITEM_REACHED")] == [1, 2]


def test_a_clear_way_is_sailed_straight_from_where_the_boat_is() -> None:
    rig = fenced(Rig().ready(), *polygon(L_WATER))
    rig.sail(waypoint(0.0, 60.0), waypoint(60.0, 60.0))
    rig.run(0.5)
    line = rig.boat.vehicle.progress.leg_line()
    assert line is not None
    assert math.dist(line.start, (0.0, 0.0)) < 3.0
    assert sail_out(rig, 120.0) > 2.0
    assert ROUND not in rig.peer.texts


def test_where_there_is_no_roomier_way_it_takes_the_straight_one_and_says_so() -> None:
    walls = box(20.0, -40.0, 24.0, -2.5), box(20.0, 2.5, 24.0, 40.0)
    rig = fenced(
        Rig().ready(),
        *polygon(box(-30.0, -40.0, 70.0, 40.0)),
        *(corner for wall in walls for corner in polygon(wall, EXCLUDED)),
    )
    rig.sail(waypoint(50.0, 0.0))
    assert sail_out(rig, 120.0) > 1.5
    assert "The way to the mission leads near the fence" in rig.peer.texts
