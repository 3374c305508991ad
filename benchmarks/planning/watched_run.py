"""A boat in lockstep whose planner watches the way ahead, as `mission-upload --watch` does over MAVSDK."""

import contextlib
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

from companion.core.geo import Point
from companion.mavlink.dialect import dialect
from companion.vehicle.vehicle import Vehicle
from mission_tools.errors import NoRoute
from mission_tools.mission.mission import Mission
from mission_tools.mission.route import mission_along
from mission_tools.station.outcome import Accepted, Outcome
from mission_tools.station.requests import BoatCommand
from mission_tools.vehicle.follow import LOOK_EVERY_S
from mission_tools.watch.watcher import WATCHED_HZ, Watcher
from sitl.courses.missions import wire_items
from sitl.run.lockstep import Lockstep
from sitl.run.station_commands import RunError, StationCommands
from sitl.run.timeline import Timeline
from sitl.scenarios.layers import Layer
from sitl.scenarios.scenario import load_scenario

IDS = {
    "GLOBAL_POSITION_INT": dialect.MAVLINK_MSG_ID_GLOBAL_POSITION_INT,
    "ATTITUDE": dialect.MAVLINK_MSG_ID_ATTITUDE,
    "OBSTACLE_DISTANCE": dialect.MAVLINK_MSG_ID_OBSTACLE_DISTANCE,
    "DISTANCE_SENSOR": dialect.MAVLINK_MSG_ID_DISTANCE_SENSOR,
    "MISSION_CURRENT": dialect.MAVLINK_MSG_ID_MISSION_CURRENT,
}
_CLEARANCE_M, _LIMIT_S, _SPEED_M_S = 3.0, 200.0, 1.0
_POND = """
[origin]
lat_deg = 50.0
lon_deg = -1.2
[map]
water = [[-20, -40], [120, -40], [120, 40], [-20, 40]]
[boat]
model = "lake"
start = [0.0, 0.0]
heading_deg = 90.0
"""


@dataclass
class SailedWatched:
    """What became of it.

    uploads: time of each, and how long before it the way ahead was found blocked: at the second sighting.
    """

    completed: bool = False
    touched: list[str] = field(default_factory=list)
    uploads: list[tuple[float, float]] = field(default_factory=list)
    missions: list[tuple[Point, ...]] = field(default_factory=list)
    track: list[Point] = field(default_factory=list)
    modes: set[str] = field(default_factory=set)


def sail_watched(
    folder: Path, route: Sequence[Point], obstacles: Sequence[tuple[float, float, float]], seed: int
) -> SailedWatched:
    """Sail a route in a pond with obstacles (east, north, radius) that its chart does not have. Raises
    RunError: the boat refused a mission, or did not start.
    """
    scenario_file = folder / "pond.toml"
    scenario_file.write_text(_POND)
    movers = [{"start": [east, north], "radius_m": radius} for east, north, radius in obstacles]
    scenario = load_scenario(
        str(scenario_file), over=(Layer("watched run", {"seed": seed, "movers": movers}),)
    )
    mission = mission_along([scenario.frame.to_global(point) for point in route], _SPEED_M_S)
    watcher = Watcher(scenario.chart, mission, _CLEARANCE_M)
    lockstep, timeline, sailed = Lockstep(scenario), Timeline(), SailedWatched()
    station = lockstep.station

    def step() -> None:
        lockstep.step()
        timeline.tick(lockstep)

    station.listen_to(*IDS.values())
    orders = StationCommands(lockstep, step)
    _start(orders, mission)
    taken: dict[str, object] = {}
    answers: list[Outcome] = []
    uploading, blocked_s, wait_until_s, looked_s = False, 0.0, 0.0, 0.0
    deadline_s = lockstep.time_s + _LIMIT_S
    vehicle: Vehicle = lockstep.boat.vehicle
    while lockstep.time_s < deadline_s and not vehicle.progress.finished:
        step()
        now_s = lockstep.time_s
        sailed.modes.add(vehicle.mode.name)
        sailed.track.append(Point(lockstep.world.truth.north_m, lockstep.world.truth.east_m))
        for name in WATCHED_HZ:
            message = station.latest.get(name)
            if message is not None and taken.get(name) is not message:
                taken[name] = message
                watcher.take(name, message.to_dict(), now_s)
        current = station.latest.get("MISSION_CURRENT")
        if answers:
            if not isinstance(answers[-1], Accepted):
                raise RunError(f"the boat refused the mission: {answers[-1].text}")
            answers.clear()
            uploading, wait_until_s = False, now_s + 0.5  # until MISSION_CURRENT is of the new mission
            sailed.uploads.append((now_s, now_s - blocked_s))
        if uploading or current is None or now_s < max(wait_until_s, looked_s + LOOK_EVERY_S):
            continue
        looked_s, found = now_s, None
        with contextlib.suppress(NoRoute):
            found = watcher.look(current.seq - 1, now_s)
        if found is not None:
            station.upload(wire_items(found), answers.append, now_s)
            uploading, blocked_s = True, now_s
            sailed.missions.append(tuple(scenario.frame.to_local(place) for place in found.places))
    sailed.completed = vehicle.progress.finished
    sailed.touched = list(timeline.touched)
    lockstep.close()
    return sailed


def _start(orders: StationCommands, mission: Mission) -> None:
    orders.until_armable()
    orders.upload(wire_items(mission))
    for name, rate_hz in WATCHED_HZ.items():
        orders.command(_interval(name, rate_hz), name)
    orders.command(_interval("MISSION_CURRENT", 5.0), "MISSION_CURRENT")
    orders.arm()
    orders.start_mission()


def _interval(name: str, rate_hz: float) -> BoatCommand:
    number = dialect.MAV_CMD_SET_MESSAGE_INTERVAL
    return BoatCommand(number, (float(IDS[name]), 1e6 / rate_hz), name, steers=False)
