"""The lockstep run has an operator, whose silence the boat notices."""

import math

from boat_rig import HOME_ITEM, scenario, waypoint

from sitl.run.mission_run import MissionRun


def texts(fault: str = "", silent_s: float = math.inf) -> list[tuple[float, str]]:
    """When the boat says what about its operator. silent_s: when that falls silent."""
    settings = [f"faults=[{{{fault}}}]"] if fault else []
    mission_run = MissionRun(scenario("open", *settings), [HOME_ITEM, waypoint(60.0, 0.0)])

    def tell(now_s: float, _: int) -> None:
        mission_run.lockstep.station.has_operator = now_s < silent_s

    mission_run.run(timeout_s=30.0, tell=tell, linger_s=30.0)
    events = mission_run.timeline.events
    return [(one.time_s, one.text) for one in events if one.kind == "text" and "perator" in one.text]


def test_an_operator_that_falls_silent_is_missed_then_and_not_before() -> None:
    (lost_s, lost), *_ = texts(silent_s=15.0)
    assert lost == "Failsafe: Operator lost for 5 s"
    assert 18.0 < lost_s < 22.0


def test_a_link_that_is_cut_costs_the_operator() -> None:
    heard = texts("what='link', kind='off', at_s=15.0, for_s=9.0")
    assert any("operator heard again" in text for _, text in heard)
