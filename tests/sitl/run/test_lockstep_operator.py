"""The lockstep run has an operator, whose silence the boat notices."""

from boat_rig import HOME_ITEM, scenario, waypoint

from sitl.run.mission_run import MissionRun

LOST = "Failsafe: Operator lost for 5 s"


def texts(fault: str = "", silent_s: float | None = None) -> list[str]:
    settings = [f"faults=[{{{fault}}}]"] if fault else []
    mission_run = MissionRun(scenario("open", *settings), [HOME_ITEM, waypoint(80.0, 0.0)])

    def tell(now_s: float, _: int) -> None:
        if silent_s is not None and now_s > silent_s:
            mission_run.lockstep.station.has_operator = False

    mission_run.run(timeout_s=60.0, tell=tell, linger_s=30.0)
    return mission_run.lockstep.station.texts


def test_an_operator_that_is_heard_is_not_missed() -> None:
    assert not any("Operator lost" in text for text in texts())


def test_an_operator_that_falls_silent_is_missed_though_the_station_goes_on() -> None:
    assert any(LOST in text for text in texts(silent_s=15.0))


def test_a_link_that_is_cut_costs_the_operator() -> None:
    heard = texts("what='link', kind='off', at_s=15.0, for_s=10.0")
    assert any("operator heard again" in text for text in heard)
