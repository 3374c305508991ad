"""What stations hear of things around the boat."""

import pytest
from boat_rig import OK, Rig

# Its near side at 3.8 m: within the 4 m that the sonar hears, also where the servo lags its bearing
ROCK = "map.obstacles=[{name='R', circle={centre=[0.0, 4.8], radius_m=1.0}}]"
OBSTACLE_DISTANCE_3D = 11037


def test_a_thing_ahead_is_told_by_direction_and_as_a_thing_of_its_own() -> None:
    rig = Rig("open", ROCK).ready()
    rig.run(6.0)
    heard = rig.peer.said("OBSTACLE_DISTANCE")[-1]
    assert min(heard.distances) == pytest.approx(380, abs=40)
    assert min(heard.distances[-2:] + heard.distances[:3]) <= min(heard.distances) + 3  # the sonar's noise
    rig.peer.forget()
    assert rig.ask(512, OBSTACLE_DISTANCE_3D) == OK
    rig.run(0.1)
    (thing,) = rig.peer.said("OBSTACLE_DISTANCE_3D")
    assert thing.x == pytest.approx(3.8, abs=0.5)
    assert abs(thing.y) < 0.7
    assert thing.obstacle_id > 0
