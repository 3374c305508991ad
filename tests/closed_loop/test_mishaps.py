"""Whole missions with one mishap on the way, as the random campaigns draw them, against the truth."""

import pytest
from boat_rig import HOME_ITEM, scenario, waypoint

from companion.failsafe.table import Condition
from sitl.run.mission_run import MissionRun, Result

CURRENT = ("environment.current_m_s=0.5", "environment.current_to_deg=90.0")


def sail(fault: str, *settings: str, linger_s: float = 0.0) -> tuple[MissionRun, Result]:
    """Forty metres out and sixty across, with a fault."""
    items = [HOME_ITEM, waypoint(40.0, 0.0), waypoint(40.0, 60.0)]
    mission_run = MissionRun(scenario("open", *CURRENT, f"faults=[{{{fault}}}]", *settings), items)
    return mission_run, mission_run.run(linger_s=linger_s)


def said(mission_run: MissionRun) -> list[str]:
    return [event.text for event in mission_run.timeline.events if event.kind == "text"]


@pytest.mark.parametrize(("size", "at_s"), [(2.0, 15.0), (2.0, 15.12), (4.0, 15.06), (4.0, 15.18)])
def test_a_loop_that_hangs_finds_the_boat_again_at_the_next_fixes(size: float, at_s: float) -> None:
    mission_run, result = sail(f"what='clock', kind='wrong', size={size}, at_s={at_s}")
    assert result.completed
    assert result.cross_track_max_m is not None
    assert result.cross_track_max_m < 4.3
    nav = mission_run.lockstep.boat.nav
    assert nav is not None
    assert not nav.faults


def test_a_leap_of_the_clock_is_told_and_loses_no_operator() -> None:
    mission_run, result = sail("what='clock', kind='wrong', size=10.0, at_s=15.0")
    assert result.completed, said(mission_run)
    assert "Clock leapt by 10.0 s, or the program hung" in said(mission_run)
    assert not [text for text in said(mission_run) if "Failsafe" in text]


def test_an_operator_who_is_silent_before_and_after_a_leap_of_the_clock_is_lost() -> None:
    silent = "what='link', at_s=20.0}, {what='clock', kind='wrong', size=10.0, at_s=22.0"
    mission_run, _ = sail(silent)
    assert mission_run.lockstep.boat.vehicle.failsafes.is_active(Condition.OPERATOR_LOST)


def test_a_battery_monitor_that_talks_nonsense_ends_no_mission() -> None:
    deaf = ("battery_low_v=0.0", "battery_critical_v=0.0", "range_action=0")
    settings = [f"vehicle.failsafe.{setting}" for setting in deaf]
    mission_run, result = sail("what='battery', kind='garbage', at_s=25.0", *settings)
    assert result.completed, said(mission_run)


def test_with_one_motor_dead_the_boat_keeps_away_from_where_a_slow_current_sets_it() -> None:
    shares = []
    for seed in (1, 2, 3):
        slow = ("environment.current_m_s=0.2", f"seed={seed}")
        mission_run, result = sail("what='motor_left', at_s=15.0", *slow, linger_s=60.0)
        assert not result.completed
        assert any("Left motor gives no thrust" in text for text in said(mission_run))
        rows = mission_run.recorder.rows
        late = rows[rows[:, 0] > 60.0]
        adrift_m = 0.2 * float(late[-1, 0] - late[0, 0])
        assert adrift_m > 12.0
        shares.append(float(late[-1, 2] - late[0, 2]) / adrift_m)
    assert max(shares) < 0.55  # one run depends on when the motor check ends, by a tenth
    assert sum(shares) / len(shares) < 0.4


@pytest.mark.parametrize("seed", [1, 2])
def test_without_compass_and_gyro_the_boat_sails_on_by_its_course_and_keeps_station(seed: int) -> None:
    mission_run, result = sail("what='compass', at_s=30.0", f"seed={seed}", linger_s=60.0)
    assert result.completed, said(mission_run)
    assert any("Compass lost" in text for text in said(mission_run))
    assert said(mission_run).count("Failsafe: Heading lost") <= 2, "it does not come and go on station"
    rows = mission_run.recorder.rows
    late = rows[rows[:, 0] > rows[-1, 0] - 40.0]
    assert abs(late[:, 1] - late[0, 1]).max() < 3.0
    assert abs(late[:, 2] - late[0, 2]).max() < 3.0


@pytest.mark.parametrize("outage", ["", "}, {what='gnss', at_s=20.0, for_s=3.0"])
def test_without_compass_and_gyro_the_heading_is_kept_through_a_corner_and_the_boat_stays(
    outage: str,
) -> None:
    mission_run, result = sail(f"what='compass', at_s=15.0{outage}", linger_s=60.0)
    texts = said(mission_run)
    assert result.completed, texts
    assert "Failsafe: Heading lost" not in texts
    assert mission_run.lockstep.boat.vehicle.mode.name == "LOITER"
    rows = mission_run.recorder.rows
    late = rows[rows[:, 0] > rows[-1, 0] - 40.0]
    assert abs(late[:, 1] - late[0, 1]).max() < 3.0  # adrift it would be twenty
    assert abs(late[:, 2] - late[0, 2]).max() < 3.0


def test_a_heading_that_is_lost_without_compass_and_fixes_is_found_again_by_the_course() -> None:
    mission_run, _ = sail("what='compass', at_s=15.0}, {what='gnss', at_s=18.0, for_s=8.0", linger_s=20.0)
    texts = said(mission_run)
    lost = texts.index("Failsafe: Heading lost")
    assert "Failsafe over: heading known again" in texts[lost:]
    assert mission_run.lockstep.boat.vehicle.mode.name == "HOLD"  # the position was lost too


def test_a_sonar_that_talks_nonsense_is_not_believed_and_ends_no_mission() -> None:
    mission_run, result = sail("what='sonar', kind='garbage', at_s=15.0")
    assert result.completed, said(mission_run)
    assert any("Sonar lost" in text for text in said(mission_run))
