"""Each request of the page, and what it changes on the boat."""

import pytest
from boat_rig import HOME_ITEM, Rig, waypoint
from shore_rig import Shore

from companion.core.geo import Point


def shore_with(*parts: str) -> tuple[Rig, Shore]:
    """A boat with a mission, armed if asked for, and its station."""
    rig = Rig().ready()
    rig.upload([HOME_ITEM, waypoint(60.0, 0.0), waypoint(60.0, 60.0)])
    shore = Shore(rig).ready()
    if "armed" in parts:
        assert shore.ask("arm").ok
    return rig, shore


def place(rig: Rig, north_m: float, east_m: float) -> dict[str, float]:
    """A place of the scenario as the page sends it."""
    start = rig.scenario.start
    at = rig.scenario.frame.to_global(Point(start.north_m + north_m, start.east_m + east_m))
    return {"lat": at.lat_deg, "lon": at.lon_deg}


def test_buttons_change_the_mode_and_the_speed() -> None:
    rig, shore = shore_with("armed")
    assert shore.ask("set_mode", {"mode": "GUIDED"}).ok
    assert shore.ask("speed", {"m_s": 0.7}).ok
    assert rig.boat.vehicle.speed_m_s == pytest.approx(0.7)
    buttons = {"hold": "LOITER", "return": "RTL", "start": "AUTO", "pause": "LOITER", "continue": "AUTO"}
    for what, mode in buttons.items():
        assert shore.ask(what).ok
        assert rig.mode == mode
        shore.run(2.0)
        assert shore.snapshot().mode == mode


def test_stop_switches_the_motors_off_at_once() -> None:
    rig, shore = shore_with("armed")
    assert shore.ask("start").ok
    shore.run(3.0)
    assert shore.ask("stop").ok
    assert not rig.boat.vehicle.armed
    assert "Disarmed by emergency stop" in [line.text for line in shore.snapshot().lines]


def test_sail_uploads_the_way_and_starts_it() -> None:
    rig, shore = shore_with("armed")
    points = [[at["lon"], at["lat"]] for at in (place(rig, 20.0, 0.0), place(rig, 20.0, 20.0))]
    answer = shore.ask("sail", {"points": points})
    assert (answer.ok, answer.text) == (True, "The boat sails the way")
    assert rig.mode == "AUTO"
    assert [(one.x, one.y) for one in rig.items()[1:]] == [
        (round(lat * 1e7), round(lon * 1e7)) for lon, lat in points
    ]
    shore.run(2.0)
    sailed = [one["geometry"]["coordinates"] for one in shore.features("mission")[1:]]
    assert sailed == [pytest.approx(point, abs=1e-6) for point in points]


def test_a_disarmed_boat_is_said_to_go_only_when_armed() -> None:
    _, shore = shore_with()
    assert shore.ask("start").text == "The boat sails the mission as soon as it is armed"


def test_a_refusal_is_answered_in_the_words_of_the_boat() -> None:
    rig = Rig().ready()
    shore = Shore(rig).ready()
    answer = shore.ask("start")
    assert (answer.ok, answer.text) == (False, "AUTO: no mission")
    assert rig.mode == "HOLD"


def test_bad_requests_are_answered_and_not_sent() -> None:
    rig, shore = shore_with()
    before = rig.fingerprint()
    bad: list[tuple[str, dict[str, object]]] = [("nonsense", {}), ("sail", {"points": []})]
    for what, arguments in bad:
        answer = shore.ask(what, arguments)
        assert not answer.ok
        assert answer.text
    shore.run(0.5)
    assert rig.fingerprint() == before
    answer = shore.ask("hold", boat=9)
    assert (answer.ok, answer.text) == (False, "Boat 9 was never heard")


def test_lost_frames_are_repeated() -> None:
    rig, shore = shore_with("armed")
    for seed, what, mode in ((0, "hold", "LOITER"), (1, "return", "RTL"), (2, "start", "AUTO")):
        shore.ends[0].reseed(seed, 0.33)  # a third of the frames is lost each way
        assert shore.ask(what).ok
        assert rig.mode == mode
    assert shore.ask("disarm").ok
    assert not rig.boat.vehicle.armed


def test_a_repetition_of_go_does_not_undo_hold() -> None:
    rig, shore = shore_with("armed")
    shore.ends[0].deafen()  # the boat hears, its answers are lost
    shore.send("go", place(rig, 30.0, 0.0))
    shore.run(0.2)
    assert rig.mode == "GUIDED"
    shore.send("hold")
    shore.run(9.0)
    assert rig.mode == "LOITER"
    assert shore.answers[-2].text == "Replaced by a newer request"


def test_restart_begins_the_boats_program_anew_and_is_noticed() -> None:
    rig, shore = shore_with()
    answer = shore.ask("restart")
    assert (answer.ok, answer.text) == (True, "The boat's program begins anew")
    assert shore.snapshot().starts == 0
    shore.until(lambda: rig.boat.wants_restart, 5.0)


def test_an_armed_boat_is_not_set_up() -> None:
    rig, shore = shore_with("armed")
    shore.run(1.5)
    for what in ("restart", "calibrate_gyro", "calibrate_accept", "motor"):
        answer = shore.ask(what)
        assert (answer.ok, answer.text) == (False, "The boat is armed: disarm it first.")
    shore.run(3.0)
    assert not rig.boat.wants_restart


def test_what_needs_a_disarmed_boat_is_refused_for_one_that_is_not_heard_any_more() -> None:
    _, shore = shore_with()
    assert shore.snapshot().armed is False
    shore.ends[0].loss = 1.0
    shore.run(6.0)
    press = {"motor": "left", "percent": 15.0, "press": "p", "held_s": 0.0}
    for what in ("restart", "calibrate_gyro", "calibrate_compass", "motor", "set_parameter"):
        answer = shore.ask(what, {"name": "CRUISE_SPEED", "value": 1.0} if what == "set_parameter" else press)
        text = "The boat is not heard, so it may be armed: wait until it is heard."
        assert (answer.ok, answer.text) == (False, text)
