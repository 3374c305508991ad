"""What lies in the way and is on no map: sailed round, or waited before, judged by ground truth.

The boats here sail by sight (AVOID_SIGHT), as one should where the map is not to be trusted.
"""

import math

import pytest
from boat_rig import OK, Rig, waypoint

from companion.core.geo import Point
from companion.mavlink.items import MissionType
from companion.obstacles.planning.planner import Stage

BY_SIGHT: dict[str, object] = {"avoidance.by_sight": 1, "failsafe.gcs_enabled": False}
HALF_BEAM_M = 0.175
GUIDED = 15
Corner = tuple[float, float]


def disc(north_m: float, east_m: float, radius_m: float) -> str:
    return f"{{name='D{north_m}/{east_m}', circle={{centre=[{east_m}, {north_m}], radius_m={radius_m}}}}}"


def block(south_m: float, north_m: float, west_m: float, east_m: float) -> str:
    corners = f"[{west_m}, {south_m}], [{east_m}, {south_m}], [{east_m}, {north_m}], [{west_m}, {north_m}]"
    return f"{{name='B{south_m}/{west_m}', polygon=[{corners}]}}"


def rig_among(
    *things: str, config: dict[str, object] | None = None, current: str = "0.0", seed: int = 1
) -> Rig:
    settings = [
        f"map.obstacles=[{', '.join(things)}]",
        f"environment.current_m_s={current}",
        f"seed={seed}",
    ]
    return Rig("open", *settings, config={**BY_SIGHT, **(config or {})})


class Voyage:
    """Steps a rig and keeps what the truth says."""

    def __init__(self, rig: Rig) -> None:
        self.rig = rig
        self.track: list[Corner] = []
        self.nearest_m = math.inf

    def until(self, modes: tuple[str, ...], limit_s: float) -> bool:
        """Sail until the mode is another one; whether it ever was."""
        rig, until_s = self.rig, self.rig.now_s + limit_s
        while rig.mode in modes and rig.now_s < until_s:
            rig.step(5)
            truth = rig.world.truth
            self.track.append((truth.north_m, truth.east_m))
            (near_m,) = rig.world.shore.clearances_m([truth.east_m], [truth.north_m])
            self.nearest_m = min(self.nearest_m, near_m)
        return rig.mode not in modes

    @property
    def length_m(self) -> float:
        return sum(math.dist(a, b) for a, b in zip(self.track, self.track[1:], strict=False))

    @property
    def words(self) -> list[str]:
        return [text for text in self.rig.peer.texts if "Obstacle" in text]


@pytest.mark.parametrize(("radius_m", "east_m"), [(0.5, 0.0), (1.5, -0.6), (4.0, 0.6)])
def test_an_island_on_the_leg_is_sailed_round_and_the_leg_gone_on_with(
    radius_m: float, east_m: float
) -> None:
    rig = rig_among(disc(30.0, east_m, radius_m)).sail(waypoint(60.0, 0.0))
    voyage = Voyage(rig)
    assert voyage.until(("AUTO",), 150.0)
    assert rig.mode == "LOITER"
    assert rig.world.groundings == 0
    assert voyage.nearest_m > 0.5
    assert voyage.length_m < 62.0 + 3.0 * radius_m
    after = [abs(east) for north, east in voyage.track if north > 45.0]
    assert sum(after) / len(after) < 0.5  # on the mean: two false echoes may be rounded on the way
    assert any("passing to" in words for words in voyage.words)


def test_a_gap_in_a_wall_is_found() -> None:
    walls = [block(28.0, 29.0, west, east) for west, east in ((-60.0, -7.0), (-2.0, 2.0), (7.0, 60.0))]
    rig = rig_among(*walls)
    voyage = Voyage(rig.sail(waypoint(55.0, 0.0)))
    assert voyage.until(("AUTO",), 250.0)
    assert rig.world.groundings == 0
    through = [east for north, east in voyage.track if 28.0 < north < 29.0]
    assert through
    assert all(2.0 < abs(east) < 7.0 for east in through)


def test_an_end_with_no_way_on_is_told_and_waited_before_without_touching() -> None:
    walls = [block(30.0, 31.0, -15.0, 15.0), block(5.0, 31.0, -16.0, -15.0), block(5.0, 31.0, 15.0, 16.0)]
    shut = block(-8.0, -7.0, -16.0, 16.0), block(-8.0, 6.0, -16.0, -15.0), block(-8.0, 6.0, 15.0, 16.0)
    rig = rig_among(*walls, *shut, config={"avoidance.detour_m": 40.0}).sail(waypoint(55.0, 0.0))
    voyage = Voyage(rig)
    voyage.until(("AUTO",), 200.0)
    assert rig.mode == "AUTO"
    assert rig.world.groundings == 0
    assert "Obstacle: no way around, keeping station" in voyage.words


def test_a_pocket_is_left_again() -> None:
    pocket = [block(30.0, 31.0, -4.0, 4.0), block(24.0, 31.0, -5.0, -4.0), block(24.0, 31.0, 4.0, 5.0)]
    rig = rig_among(*pocket).sail(waypoint(55.0, 0.0))
    voyage = Voyage(rig)
    assert voyage.until(("AUTO",), 300.0)
    assert rig.mode == "LOITER"
    assert rig.world.groundings == 0


def test_what_stands_on_the_goal_itself_does_not_keep_the_boat_circling() -> None:
    rig = rig_among(disc(40.0, 0.0, 3.0), config={"guidance.waypoint_radius_m": 1.0})
    voyage = Voyage(rig.sail(waypoint(40.0, 0.0)))
    voyage.until(("AUTO",), 200.0)
    assert rig.world.groundings == 0
    assert "Obstacle: no way around, keeping station" in voyage.words
    assert voyage.length_m < 160.0


def test_with_the_fence_on_one_side_the_boat_takes_the_other() -> None:
    rig = rig_among(disc(30.0, -1.0, 2.0)).ready()  # the shorter way would be to starboard, over the line
    corners = [(-20.0, -20.0), (80.0, -20.0), (80.0, 2.5), (-20.0, 2.5)]
    fence = [waypoint(north, east, command=5001, param1=4.0) for north, east in corners]
    rig.upload(fence, mission_type=MissionType.FENCE)
    rig.sail(waypoint(60.0, 0.0))
    voyage = Voyage(rig)
    assert voyage.until(("AUTO",), 150.0)
    assert rig.mode == "LOITER"
    assert rig.world.groundings == 0
    assert max(east for _, east in voyage.track) < 2.5
    assert min(east for _, east in voyage.track) < -3.5


def test_between_the_fence_and_a_wall_the_boat_waits_and_says_so() -> None:
    rig = rig_among(block(30.0, 31.0, -8.0, 8.0), seed=3).ready()
    corners = [(-20.0, -6.0), (80.0, -6.0), (80.0, 6.0), (-20.0, 6.0)]
    fence = [waypoint(north, east, command=5001, param1=4.0) for north, east in corners]
    rig.upload(fence, mission_type=MissionType.FENCE)
    rig.sail(waypoint(60.0, 0.0))
    voyage = Voyage(rig)
    voyage.until(("AUTO",), 120.0)
    assert rig.mode == "AUTO"
    assert rig.world.groundings == 0
    assert max(abs(east) for _, east in voyage.track) < 6.0
    assert "Obstacle: no way around, keeping station" in voyage.words


def test_guided_goes_round_as_well() -> None:
    rig = rig_among(disc(20.0, 0.0, 1.0)).ready()
    assert rig.set_mode(GUIDED) == OK
    assert rig.arm() == OK
    rig.boat.vehicle.modes.guided.go_to(rig.scenario.frame.to_global(Point(40.0, 0.0)))
    voyage = Voyage(rig)
    rig.until(lambda: rig.offset_m(40.0, 0.0) < 3.0, 100.0)
    assert rig.world.groundings == 0
    assert any("passing to" in words for words in voyage.words)


def test_switched_off_it_changes_nothing() -> None:
    rig = rig_among(disc(20.0, 0.0, 1.0), config={"avoidance.enable": 1}).sail(waypoint(40.0, 0.0))
    voyage = Voyage(rig)
    voyage.until(("AUTO",), 60.0)
    assert rig.world.groundings > 0
    assert rig.boat.guidance.avoidance.stage is Stage.CLEAR


def test_told_to_stop_it_stops_before_the_thing() -> None:
    rig = rig_among(disc(20.0, 0.0, 2.0), config={"avoidance.goes_round": False}).sail(waypoint(40.0, 0.0))
    voyage = Voyage(rig)
    voyage.until(("AUTO",), 60.0)
    assert rig.mode == "AUTO"
    assert rig.world.groundings == 0
    assert rig.world.truth.north_m < 17.5
    assert "Obstacle ahead: keeping station" in voyage.words


def test_a_current_from_the_side_makes_no_difference() -> None:
    rig = rig_among(disc(30.0, 0.0, 1.5), current="0.5").sail(waypoint(60.0, 0.0))
    voyage = Voyage(rig)
    assert voyage.until(("AUTO",), 150.0)
    assert rig.world.groundings == 0
    assert voyage.nearest_m > HALF_BEAM_M
