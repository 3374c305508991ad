import numpy as np
import pytest
from boat_rig import HOME_ITEM, scenario, waypoint

from companion.core.modes import Mode
from sitl.run.lockstep import Lockstep
from sitl.run.mission_run import MissionRun
from sitl.run.recording.estimate_recorder import EVERY_S, Estimate
from sitl.run.timeline import Timeline

ITEMS = [HOME_ITEM, waypoint(20.0, 0.0), waypoint(20.0, 20.0)]
WALLED = (
    'map={water=[[-9,-9],[9,-9],[9,9],[-9,9]], obstacles=[{name="Rock", circle={centre=[0,6],radius_m=1}}]}'
)


@pytest.fixture(scope="module")
def mission_run() -> MissionRun:
    sailed = MissionRun(scenario("open", "environment.current_m_s=0.3"), ITEMS)
    sailed.run()
    return sailed


def test_a_run_says_when_the_boat_was_armed_changed_its_mode_and_reached_its_waypoints(
    mission_run: MissionRun,
) -> None:
    told = [(event.kind, event.text) for event in mission_run.timeline.events if event.kind != "text"]
    assert told == [
        ("mode", "HOLD"),
        ("arming", "armed"),
        ("mode", "AUTO"),
        ("waypoint", "item 1 reached"),
        ("mode", "LOITER"),
        ("waypoint", "item 2 reached"),
    ]
    times = [event.time_s for event in mission_run.timeline.events]
    assert times == sorted(times)
    assert "Mission complete" in [event.text for event in mission_run.timeline.events]


def test_faults_are_told_when_they_begin_and_when_they_are_over() -> None:
    fault = '[{what="gnss", kind="off", at_s=0.5, for_s=1.0}]'
    lockstep = Lockstep(scenario("open", f"faults={fault}"))
    timeline = Timeline()
    for _ in range(100):
        lockstep.step()
        timeline.tick(lockstep)
    told = [(round(event.time_s, 1), event.text) for event in timeline.events if event.kind == "fault"]
    assert told == [(0.5, "gnss off"), (1.5, "gnss off is over")]


def test_a_touch_is_told_with_what_was_touched() -> None:
    lockstep = Lockstep(scenario("open", WALLED, "boat.heading_deg=0"))
    timeline = Timeline()
    lockstep.boat.vehicle.armed = True
    lockstep.world.hardware.motors.write(1.0, 1.0)
    for _ in range(600):
        lockstep.world.step(0.02)
        timeline.tick(lockstep)
    assert timeline.touched == ["Rock"]


def test_a_motor_that_is_driven_though_the_boat_is_disarmed_is_counted_and_told_once() -> None:
    lockstep = Lockstep(scenario("open"))
    timeline = Timeline()
    lockstep.world.hardware.motors.write(0.1, 0.0)
    for _ in range(3):
        lockstep.world.step(0.02)
        timeline.tick(lockstep)
    lockstep.world.hardware.motors.stop()
    lockstep.world.step(0.02)
    timeline.tick(lockstep)
    assert timeline.late_commands == 3
    assert [event.kind for event in timeline.events] == ["mode", "motors"]


def test_the_boats_beliefs_are_kept_ten_times_a_second_beside_the_truth(mission_run: MissionRun) -> None:
    rows = mission_run.estimates.rows
    column = {name: rows[:, index] for index, name in enumerate(Estimate._fields)}
    assert len(rows) == pytest.approx(len(mission_run.recorder) * 0.02 / EVERY_S, abs=3)
    assert np.allclose(np.diff(column["time_s"]), EVERY_S)
    truth = {round(row[0], 3): row for row in mission_run.recorder.rows.tolist()}
    for time_s, north_m in zip(column["time_s"], column["north_m"], strict=True):
        assert truth[round(time_s, 3)][1] == pytest.approx(north_m, abs=2.0)
    assert column["armed"].all()
    assert set(column["mode"]) <= {float(Mode.AUTO), float(Mode.LOITER)}
    assert np.nanmax(column["demand_speed_m_s"]) > 1.0
