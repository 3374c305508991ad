"""What a campaign tells of a sensor that fails."""

from boat_rig import HOME_ITEM, scenario, waypoint

from sitl.experiments.campaign.fault_figures import fault_figures
from sitl.run.mission_run import MissionRun


def figures(*settings: str) -> dict[str, float | None]:
    mission_run = MissionRun(scenario("open", *settings), [HOME_ITEM, waypoint(60.0, 0.0)])
    mission_run.run(timeout_s=50.0)
    return fault_figures(mission_run)


def test_a_leap_of_the_receiver_shows_in_the_time_to_notice_and_leads_nobody_off_the_plan() -> None:
    found = figures("faults=[{what='gnss', kind='wrong', at_s=15.0}]")
    assert found["notice_s"] is not None
    assert 0.0 < found["notice_s"] < 2.0
    assert found["off_plan_m"] is not None
    assert 0.0 < found["off_plan_m"] < 2.0
    assert found["given_up_s"] is None


def test_a_receiver_that_is_silent_for_good_is_given_up() -> None:
    found = figures("faults=[{what='gnss', at_s=12.0}]", "vehicle.estimation.dead_reckoning_s=10.0")
    assert found["given_up_s"] is not None
    assert 9.0 < found["given_up_s"] < 13.0
    assert found["astray_share"] is not None
    assert found["astray_share"] < 0.05


def test_a_run_without_such_a_fault_has_no_such_figures() -> None:
    for settings in ((), ("faults=[{what='sonar', at_s=15.0}]",)):
        assert fault_figures(MissionRun(scenario("open", *settings), [])) == {}
