"""What stations hear of things around the boat."""

import types
from typing import Any

import pytest
from boat_rig import OK, Rig, nav_at

from companion.core.geo import Point
from companion.core.readings import SonarReading
from companion.obstacles.perception.sonar_scan import SonarScan
from companion.services.telemetry.obstacle_messages import obstacle_distance

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


def test_what_is_remembered_is_told_where_the_sweep_sees_nothing() -> None:
    sweep = SonarScan()
    sweep.add(SonarReading(10.0, 0.0, 2.0, 0.2, 4.0))
    perception = types.SimpleNamespace(
        occupancy=types.SimpleNamespace(cell_m=0.2), solid=lambda: [Point(0.0, 3.0), Point(0.0, -9.0)]
    )
    now: Any = types.SimpleNamespace(
        now_s=10.0,
        boot_us=0,
        sensors=types.SimpleNamespace(sweep=sweep),
        guidance=types.SimpleNamespace(perception=perception),
        vehicle=types.SimpleNamespace(nav=nav_at()),
    )
    message = obstacle_distance(now)
    assert message is not None
    assert (message.distances[0], message.distances[18]) == (200, 300)
    assert message.distances[16] == message.distances[20] == 0xFFFF
    assert (message.min_distance, message.max_distance, message.increment) == (20, 400, 5)
    assert message.distances[54] == 0xFFFF, "beyond the sonar's reach"
