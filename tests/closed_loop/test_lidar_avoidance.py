"""A boat whose eyes are a scanning lidar: its bytes, from the emulated water to the steering."""

import math

from boat_rig import Rig, waypoint
from twins.lidars import Ld06Twin
from twins.lines import MemoryLine

from companion.config.sensors import LidarPart
from companion.core.readings import SonarReading
from companion.hal.ranging.scanning_lidar import ScanningLidar
from sitl.world.world import World

PART = LidarPart(driver="ld06", yaw_rad=math.pi, blind_rad=((3.0, -3.0),))  # its cable ahead, a mast astern
BY_SIGHT: dict[str, object] = {
    "avoidance.by_sight": 1, "avoidance.lookahead_m": 8.0, "failsafe.gcs_enabled": False
}  # fmt: skip
ROCK = "map.obstacles=[{name='Rock', circle={centre=[0.4, 25.0], radius_m=1.0}}]"


class Afloat:
    """An LD06 over the boat's water, in the middle of the hull. Satisfies `Sonar`."""

    is_open = True

    def __init__(self) -> None:
        self.world: World | None = None
        self.wire = MemoryLine()
        self.twin = Ld06Twin(self._echo)
        self.driver = ScanningLidar(
            self.wire.port, lambda: 0.0 if self.world is None else self.world.time_s, PART
        )
        self.is_powered = True

    def _echo(self, angle_deg: float) -> tuple[int, int]:
        world = self.world
        assert world is not None
        truth = world.truth
        if angle_deg < 3.0 or angle_deg > 357.0:
            return 250, 200  # the mast
        bearing = truth.heading_rad + PART.yaw_rad + math.radians(angle_deg)
        range_m = world.shore.range_m(truth.east_m, truth.north_m, [bearing], 8.0)
        return (0, 0) if range_m > 8.0 else (round(1000.0 * range_m), 200)

    def read(self) -> list[SonarReading]:
        if self.world is not None and self.is_powered:
            self.wire.say(self.twin.say(0.02))
        self.driver.step()
        return list(self.driver.read())

    def set_sector(self, port_rad: float, starboard_rad: float) -> None:
        self.driver.set_sector(port_rad, starboard_rad)

    def close(self) -> None:
        self.driver.close()


def boat() -> tuple[Rig, Afloat]:
    lidar = Afloat()
    rig = Rig("open", ROCK, "seed=5", config=BY_SIGHT, sonar=None, lidar=lidar)
    lidar.world = rig.world
    return rig, lidar


def test_a_boat_with_a_lidar_alone_sails_round_a_rock_that_is_on_no_map() -> None:
    rig, _ = boat()
    rig.sail(waypoint(45.0, 0.0))
    nearest_m = math.inf
    while rig.mode == "AUTO":
        rig.step(5)
        truth = rig.world.truth
        (near_m,) = rig.world.shore.clearances_m([truth.east_m], [truth.north_m])
        nearest_m = min(nearest_m, near_m)
        assert rig.now_s < 120.0
    assert rig.offset_m(45.0, 0.0) < 3.0
    assert 0.4 < nearest_m < 3.0
    assert rig.world.groundings == 0
    assert rig.boat.guidance.perception.reach_m == 8.0


def test_a_lidar_that_falls_silent_is_told_and_its_return_too() -> None:
    rig, lidar = boat()
    rig.sail(waypoint(15.0, 0.0))
    rig.run(1.0)
    lidar.is_powered = False
    took_s = rig.until(lambda: "Failsafe: Lidar lost for 3 s" in rig.peer.texts, 5.0)
    assert took_s > 2.8
    lidar.is_powered = True
    rig.until(lambda: "Failsafe over: ranger pings again" in rig.peer.texts, 5.0)
    assert lidar.driver.reader.skipped == 0
