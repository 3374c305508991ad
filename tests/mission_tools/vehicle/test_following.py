"""A mission that is followed: what the screen shows, when it ends, and what another mission changes."""

import asyncio
import io
import json
import re
from collections.abc import AsyncIterator, Mapping, Sequence
from typing import Any, cast

import pytest
import shapely
from fake_clock import FakeClock
from rich.console import Console

from companion.core.geo import LatLon, LocalFrame, Point
from mission_tools.errors import LinkLost, NoRoute, VehicleError
from mission_tools.maps.chart import build_chart
from mission_tools.mission.mission import Mission, MissionItem, MissionType
from mission_tools.mission.route import mission_along
from mission_tools.vehicle.follow import Lookout, ProgressDisplay, follow, in_thread, looking_out
from mission_tools.vehicle.mission_monitor import MissionMonitor, Progress
from mission_tools.vehicle.state import VehicleState
from mission_tools.vehicle.vehicle import Vehicle
from mission_tools.watch.watcher import Watcher
from mission_tools.wording import Printer

FRAME = LocalFrame(LatLon(50.0, 10.0))
CHART = build_chart("pond", FRAME, shapely.box(-500, -500, 500, 500), ())
PATH = [FRAME.to_global(Point(north_m, 0.0)) for north_m in (0.0, 60.0, 100.0)]
MISSION = mission_along(PATH)
HERE = {"lat": 500000000, "lon": 100000000, "hdg": 0}
RANGES = {"distances": [300], "increment": 5, "min_distance": 20, "max_distance": 500}


class SailingVehicle:
    """Sails its mission at 10 m/s, by a clock that passes while somebody waits; says what it is given."""

    def __init__(self, clock: FakeClock, said: Sequence[object] = (), autopilot: int = 3) -> None:
        self.state = VehicleState(autopilot=autopilot, custom_mode=10, armed=True, current_item=1)
        self.uploads: list[tuple[MissionType, Sequence[MissionItem]]] = []
        self.rates_hz: Mapping[int, float] = {}
        self._clock, self._said = clock, said
        self.lost_s, self.is_endless = 1e9, False

    async def messages(self, name: str) -> AsyncIterator[str]:
        for fields in self._said:
            yield json.dumps(fields)
        if self.is_endless:
            await asyncio.Event().wait()

    async def upload(self, kind: MissionType, items: Sequence[MissionItem]) -> None:
        self.uploads.append((kind, items))
        self._clock.sleep(0.25)

    async def ask_for_rates(self, rates_hz: Mapping[int, float]) -> None:
        self.rates_hz = rates_hz

    def raise_if_lost(self, doing: str) -> None:
        if self._clock.time_s > self.lost_s:
            raise LinkLost(doing)

    async def sleep(self, seconds: float) -> None:
        """What everybody waits by."""
        self._clock.sleep(seconds)
        north_m = min(10.0 * self._clock.time_s, 100.0)
        self.state.position, self.state.speed_m_s = FRAME.to_global(Point(north_m, 0.0)), 10.0
        self.state.current_item = 1 if north_m < 60.0 else 2
        self.state.reached_item = 2 if north_m >= 100.0 else 1 if north_m >= 60.0 else -1


class ScriptedWatcher(Watcher):
    """Finds what it is given, look by look; keeps where it was asked to look from, and what it took in."""

    def __init__(self, *found: Mission | NoRoute | None) -> None:
        super().__init__(CHART, MISSION, 2.0)
        self.found, self.looks = [*found], list[int]()
        self.taken: Any = None

    def look(self, current: int, now_s: float) -> Mission | None:
        self.looks.append(current)
        found = self.found.pop(0) if self.found else None
        if isinstance(found, NoRoute):
            raise found
        return found

    def take(self, name: str, fields: Any, now_s: float) -> None:  # noqa: ANN401  as JSON has it
        super().take(name, fields, now_s)
        self.taken = fields


@pytest.fixture
def clock() -> FakeClock:
    """Of vehicle and planner."""
    return FakeClock()


def lookout_of(vehicle: SailingVehicle, watcher: Watcher, clock: FakeClock) -> tuple[Lookout, io.StringIO]:
    said = io.StringIO()
    return Lookout(cast(Vehicle, vehicle), watcher, Printer(said), clock.now_s), said


def test_messages_that_make_no_sense_do_not_end_the_listening(clock: FakeClock) -> None:
    watcher = ScriptedWatcher()
    fixes: tuple[object, ...] = ({}, [], None, HERE | {"lat": 10**12}, HERE | {"hdg": None}, HERE)
    asyncio.run(lookout_of(SailingVehicle(clock, fixes), watcher, clock)[0].hear("GLOBAL_POSITION_INT"))
    assert watcher.taken == HERE
    wrong = ({"frame": float("inf")}, {"min_distance": float("nan")}, {"distances": None}, {"increment": "5"})
    ranges = (*(RANGES | one for one in wrong), RANGES)
    asyncio.run(lookout_of(SailingVehicle(clock, ranges), watcher, clock)[0].hear("OBSTACLE_DISTANCE"))
    assert watcher.taken == RANGES


@pytest.mark.parametrize(("autopilot", "first"), [(3, 1), (12, 0)])
def test_another_mission_is_uploaded_and_its_items_counted_anew(
    clock: FakeClock, autopilot: int, first: int
) -> None:
    vehicle, watcher = SailingVehicle(clock, autopilot=autopilot), ScriptedWatcher(MISSION)
    vehicle.state.current_item, vehicle.state.reached_item = 4, 3
    lookout, said = lookout_of(vehicle, watcher, clock)
    assert asyncio.run(lookout.step()) is MISSION
    assert vehicle.uploads == [
        (MissionType.MISSION, MISSION.wire_lists(home_first=bool(first))[MissionType.MISSION])
    ]
    assert (vehicle.state.current_item, vehicle.state.reached_item) == (first, -1)
    assert said.getvalue() == "the way ahead is blocked: 2 waypoints uploaded 0.25 s after it was seen\n"
    clock.sleep(0.9)  # MISSION_CURRENT may still be of the old one
    assert asyncio.run(lookout.step()) is None
    assert watcher.looks == [4 - first]
    clock.sleep(0.2)
    assert asyncio.run(lookout.step()) is None
    assert watcher.looks == [4 - first, 0]


def test_a_way_that_is_blocked_for_good_is_said(clock: FakeClock) -> None:
    vehicle = SailingVehicle(clock)
    lookout, said = lookout_of(vehicle, ScriptedWatcher(NoRoute("shut in")), clock)
    assert asyncio.run(lookout.step()) is None
    assert said.getvalue() == "the way ahead is blocked: shut in\n"
    assert vehicle.uploads == []


def test_a_lookout_asks_for_what_it_needs_and_listens_until_its_end(clock: FakeClock) -> None:
    vehicle, watcher = SailingVehicle(clock, [HERE]), ScriptedWatcher()
    vehicle.is_endless = True

    async def look_out() -> None:
        async with looking_out(cast(Vehicle, vehicle), watcher, Printer(io.StringIO()), clock.now_s):
            await asyncio.sleep(0)
            assert len(asyncio.all_tasks()) == 5
        assert len(asyncio.all_tasks()) == 1

    asyncio.run(look_out())
    assert watcher.taken == HERE
    # GLOBAL_POSITION_INT, ATTITUDE, OBSTACLE_DISTANCE, DISTANCE_SENSOR, MISSION_CURRENT
    assert vehicle.rates_hz == {33: 10.0, 30: 10.0, 330: 5.0, 132: 10.0, 42: 5.0}


def test_a_lookout_whose_hearers_broke_ends_like_any_other(clock: FakeClock) -> None:
    vehicle = SailingVehicle(clock, [object()])

    async def look_out() -> None:
        async with looking_out(
            cast(Vehicle, vehicle), ScriptedWatcher(), Printer(io.StringIO()), clock.now_s
        ):
            await asyncio.sleep(0)

    asyncio.run(look_out())


def test_work_in_a_thread_returns_or_raises() -> None:
    async def work() -> int:
        with pytest.raises(ZeroDivisionError):
            await in_thread(lambda: 1 // 0)
        return await in_thread(lambda: 42)

    assert asyncio.run(work()) == 42


def followed(
    vehicle: SailingVehicle, clock: FakeClock, timeout_s: float = 1e9, watcher: Watcher | None = None
) -> tuple[MissionMonitor, list[str]]:
    """The last monitor, and what the screen showed."""
    shown = io.StringIO()
    lookout = None if watcher is None else lookout_of(vehicle, watcher, clock)[0]

    async def sail() -> MissionMonitor:
        await vehicle.sleep(0.0)
        monitor = MissionMonitor.of(vehicle.state, MISSION, clock.time_s)
        return await follow(cast(Vehicle, vehicle), monitor, shown, timeout_s, clock.now_s, lookout)

    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(asyncio, "sleep", vehicle.sleep)
        return asyncio.run(sail()), shown.getvalue().splitlines()


def test_off_a_terminal_each_waypoint_has_a_line(clock: FakeClock, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "20")
    monitor, lines = followed(SailingVehicle(clock), clock)
    assert [line.partition(":")[0] for line in lines] == [
        "waypoint 1 of 2",
        "waypoint 2 of 2",
        "mission complete",
    ]
    assert re.fullmatch(r"waypoint 2 of 2: (40|39)\.\d m left at 10\.00 m/s, 4 s to go", lines[1])
    assert lines[2] == "mission complete: 2 of 2 waypoints"
    assert monitor.track_length_m == pytest.approx(100.0, abs=0.5)


def test_a_mission_that_takes_too_long_or_falls_silent_is_left(clock: FakeClock) -> None:
    with pytest.raises(VehicleError, match=r"not ended within 5 s: 4\d\.\d m are left; the boat sails on"):
        followed(SailingVehicle(clock), clock, 5.0)
    assert clock.time_s == pytest.approx(5.1, abs=0.11)
    silent = SailingVehicle(clock)
    silent.lost_s = 7.0
    with pytest.raises(LinkLost, match="following the mission"):
        followed(silent, clock)


def test_another_mission_is_followed_on_the_same_track(clock: FakeClock) -> None:
    other = mission_along([PATH[0], FRAME.to_global(Point(50.0, 20.0)), PATH[2]])
    monitor, lines = followed(SailingVehicle(clock), clock, watcher=ScriptedWatcher(None, other))
    assert lines[1].startswith("waypoint 2 of 2: 39.5 m left")
    assert monitor.track[0].time_s == 0.0
    assert monitor.track_length_m == pytest.approx(100.0, abs=0.5)
    assert monitor._sequences == [1, 2]


def test_on_a_terminal_a_bar_is_shown_in_place_of_lines() -> None:
    shown = io.StringIO()
    with ProgressDisplay(Console(file=shown, force_terminal=True, width=100)) as display:
        display.show(Progress(1, 2, 40.0, 100.0, 1.0, 40.0))
        display.show(Progress(2, 2, 30.0, 100.0, 1.0, 30.0))
    assert "waypoint 2 of 2: 30.0 m left at 1.00 m/s, 30 s to go" in shown.getvalue()
    assert "70%" in shown.getvalue()
    assert "waypoint 1 of 2" not in shown.getvalue().rpartition("70%")[2]
