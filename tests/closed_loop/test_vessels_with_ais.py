"""A ship that crosses the boat's leg at 4 m/s, told by its AIS long before the sonar could hear it."""

import math

import pytest
from boat_rig import Rig, waypoint

from companion.obstacles.planning.planner import KEEPING_CLEAR

pytestmark = pytest.mark.slow
# On a collision course with a boat that goes on
SHIP = "movers=[{start=[-168.0, 45.0], velocity_m_s=[4.0, 0.0], at_s=0.0, radius_m=3.0, ais='A'}]"


class Crossing:
    """A boat on a leg of 60 m, met half-way."""

    def __init__(self, seed: int, *, has_ais: bool) -> None:
        self.rig = Rig(
            "open",
            *(SHIP, f"seed={seed}", f"sensors.ais.fitted={str(has_ais).lower()}"),
            config={"avoidance.by_sight": 3, "failsafe.gcs_enabled": False},
        )
        self.nearest_m = math.inf

    def sail(self) -> "Crossing":
        rig = self.rig.sail(waypoint(60.0, 0.0))
        while rig.mode == "AUTO":
            rig.step(5)
            truth = rig.world.truth
            gap_m = rig.world.movers.gap_m(truth.east_m, truth.north_m, truth.time_s)
            self.nearest_m = min(self.nearest_m, gap_m)
            assert rig.now_s < 300.0
        return self


@pytest.mark.parametrize("seed", [9301, 9302])
def test_a_crossing_ship_is_kept_clear_of_with_ais_and_met_without(seed: int) -> None:
    blind, told = Crossing(seed, has_ais=False).sail(), Crossing(seed, has_ais=True).sail()
    assert told.nearest_m > 10.0
    assert told.rig.world.groundings == 0
    assert f"{KEEPING_CLEAR} MOVER 1" in told.rig.peer.texts
    assert blind.nearest_m < 4.0
    assert told.rig.peer.said("AIS_VESSEL")
