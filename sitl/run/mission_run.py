"""One mission from boot to its end, in lockstep: upload, arm, run, measure."""

import math
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass

from companion.boat import TICK_S
from companion.core.geo import Point, distance_m
from companion.core.modes import Mode
from companion.log.logbook import Logbook
from companion.mavlink.items import MissionItem
from companion.vehicle.mission.steps import Wait, Waypoint, locate
from companion.vehicle.vehicle import Vehicle
from sitl.run.lockstep import Lockstep
from sitl.run.recording.estimate_recorder import EstimateRecorder
from sitl.run.recording.recorder import NO_LEG, Recorder, Rows
from sitl.run.station_commands import BOOT_S, StationCommands
from sitl.run.timeline import Timeline
from sitl.world.scenario import Scenario

_SLACK = 4.0  # a mission may take this many times its length at cruise speed, plus BOOT_S


@dataclass(frozen=True, slots=True)
class Result:
    """The figures of a run; lengths and errors are ground truth. None where there is nothing to measure."""

    scenario: str
    seed: int
    completed: bool
    sim_seconds: float
    cpu_seconds: float
    real_time_factor: float
    planned_length_m: float
    path_length_m: float
    time_s: float
    cross_track_rms_m: float | None
    cross_track_max_m: float | None
    min_clearance_m: float | None
    groundings: int
    waypoints: int
    waypoints_reached: int
    final_mode: str
    state_hash: str


class MissionRun:
    """A run under way. `recorder` holds the truth of every tick since the mission began, `estimates` what the
    boat believed meanwhile, `timeline` what happened since boot.
    """

    def __init__(
        self,
        scenario: Scenario,
        items: Sequence[MissionItem],
        logbook: Logbook | None = None,
        fence: Sequence[MissionItem] = (),
    ) -> None:
        """logbook: where the boat is to write its log, if anywhere. fence: uploaded before the mission."""
        self.scenario = scenario
        self.items = tuple(items)
        self._fence = tuple(fence)
        self.recorder = Recorder()
        self.estimates = EstimateRecorder(scenario.frame)
        self.timeline = Timeline()
        self.planned: list[Point] = []
        self.lockstep = Lockstep(scenario, logbook=logbook)
        self._leg_of_seq: dict[int, int] = {}
        self._holds_s = 0.0  # all waits of the mission
        self._sailed: int | None = None  # ticks before the mission was over

    def run(
        self,
        timeout_s: float | None = None,
        tell: Callable[[float, int], None] | None = None,
        linger_s: float = 0.0,
    ) -> Result:
        """Sail the mission to its end.

        timeout_s: simulated seconds after the start; by default a multiple of the planned time and the waits.
        linger_s: how long to watch a boat that has ended its mission, or has left it, within that time. tell:
        called about once a simulated second with the time and the current item. Raises RunError: the boat
        never became armable, refused the mission or the arming, or could not start.
        """
        began_s = time.process_time()
        self._prepare()
        started_s = self.lockstep.time_s
        planned_m = sum(distance_m(a, b) for a, b in zip(self.planned, self.planned[1:], strict=False))
        cruise_m_s = self.scenario.vehicle.speed.cruise_m_s
        limit_s = timeout_s or BOOT_S + _SLACK * planned_m / cruise_m_s + self._holds_s
        completed = self._sail(started_s + limit_s, tell, linger_s)
        cpu_s = time.process_time() - began_s
        lockstep = self.lockstep
        metrics = self.recorder.metrics(self.planned, lockstep.world.shore, self._sailed)
        result = Result(
            scenario=self.scenario.title,
            seed=self.scenario.seed,
            completed=completed,
            sim_seconds=lockstep.time_s,
            cpu_seconds=cpu_s,
            real_time_factor=lockstep.time_s / cpu_s,
            planned_length_m=planned_m,
            **asdict(metrics),
            waypoints=len(self.planned) - 1,
            waypoints_reached=len({seq for seq in lockstep.station.reached if seq in self._leg_of_seq}),
            final_mode=lockstep.boat.vehicle.mode.name,
            state_hash=self.recorder.state_hash(),
        )
        lockstep.close()
        return result

    def _prepare(self) -> None:
        lockstep = self.lockstep
        orders = StationCommands(lockstep, self._step)
        orders.until_armable()
        if self._fence:
            orders.upload(self._fence, "fence")
        orders.upload(self.items)
        orders.arm()
        orders.start_mission()
        truth = lockstep.world.truth
        self.planned = [Point(truth.north_m, truth.east_m)]
        for seq, step in enumerate(lockstep.boat.vehicle.progress.mission):
            if isinstance(step, Waypoint | Wait) and math.isfinite(step.hold_s):
                self._holds_s += step.hold_s
            if isinstance(step, Waypoint):
                self._leg_of_seq[seq] = len(self.planned) - 1
                self.planned.append(locate(step.position, self.scenario.frame, self.planned[-1]))

    def _step(self) -> None:
        self.lockstep.step()
        self.timeline.tick(self.lockstep)

    def _sail(self, deadline_s: float, tell: Callable[[float, int], None] | None, linger_s: float) -> bool:
        """Whether the mission was sailed to its end, the way home included where an item asks for that."""
        lockstep, world = self.lockstep, self.lockstep.world
        record, legs = self.recorder.record, self._leg_of_seq
        ticks_per_second = round(1.0 / TICK_S)
        ended_s, truth = math.nan, world.truth
        while truth.time_s < deadline_s:
            boat = lockstep.boat
            if _is_under_way(boat.vehicle):
                ended_s, self._sailed = math.nan, None
            elif math.isnan(ended_s):
                ended_s, self._sailed = truth.time_s, len(self.recorder)
            if truth.time_s - ended_s >= linger_s:
                break
            self._step()
            seq, truth = boat.vehicle.progress.current_seq, world.truth
            record(truth, legs.get(seq, NO_LEG) if math.isnan(ended_s) else NO_LEG)
            self.estimates.tick(boat, truth.time_s)
            if tell is not None and world.tick % ticks_per_second == 0:
                tell(truth.time_s, seq)
        for _ in range(ticks_per_second):  # receive the last messages
            self._step()
        vehicle = lockstep.boat.vehicle
        return vehicle.progress.finished and not _is_under_way(vehicle)

    @property
    def sailed_rows(self) -> Rows:
        """The truth of every tick of the mission, without what follows its end."""
        return self.recorder.rows[: self._sailed]

    def ending(self) -> str:
        """How the run ended: position in the mission and the boat's last messages."""
        vehicle = self.lockstep.boat.vehicle
        said = "; ".join(self.lockstep.station.texts[-3:]) or "nothing"
        where = (
            f"at item {vehicle.progress.current_seq} of {vehicle.progress.last_seq} in {vehicle.mode.name}"
        )
        return f"{where}; the boat said: {said}"


def _is_under_way(vehicle: Vehicle) -> bool:
    """Whether the boat is on its mission, or returning home by the mission's last item."""
    goes_home = vehicle.mode is Mode.RTL and vehicle.progress.go_home
    is_on_its_way = vehicle.mode is Mode.AUTO or (goes_home and not vehicle.route.has_arrived)
    return vehicle.armed and is_on_its_way
