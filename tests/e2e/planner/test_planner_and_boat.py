"""`mission-upload` and `boat-sitl` as two processes that meet over MAVLink: what a person sees and gets."""

import json
import signal

import pytest
from mavutil_station import OpenStation, Place
from patience import JOB_S
from programs import Ended, RunBoat, RunProgram

pytestmark = pytest.mark.realtime
pytest_plugins = ("program_fixtures",)

AUTO, LOITER = 10, 5
GOAL = Place(16, 3, 500020857, -11969034)  # of the scenario `lake`
NEAR_GOAL = Place(16, 3, 499994606, -12010461)


def one_line(ended: Ended) -> str:
    """The single line that a failed program leaves on stderr."""
    assert ended.err.startswith("mission-upload: "), ended
    assert ended.err.count("\n") == 1, ended
    return ended.err.removeprefix("mission-upload: ").strip()


def test_a_planned_mission_is_uploaded_sailed_and_reported(
    running_boat: RunBoat, run_program: RunProgram, open_station: OpenStation
) -> None:
    boat = running_boat("lake", "--speedup", "40")
    goal = f"{NEAR_GOAL.lat_e7 * 1e-7:.7f},{NEAR_GOAL.lon_e7 * 1e-7:.7f}"
    options = (f"--goal={goal}", "--start", "--follow", "--json", "--preview", "lake.png")
    planner = run_program("mission-upload", "lake", "--connect", boat.url, *options)
    ended = planner.wait(JOB_S)
    assert ended.code == 0, ended
    report = json.loads(ended.out)
    assert (report["ok"], report["exit_code"], report["started"]) == (True, 0, True)
    waypoints = len(report["waypoints"])
    assert report["upload"]["items"] == waypoints + 1
    assert report["upload"]["read_back_equal"] is True
    assert report["upload"]["link"] == boat.url
    assert report["plan"]["min_clearance_m"] >= 4.0
    assert report["voyage"]["track_length_m"] == pytest.approx(report["plan"]["length_m"], rel=0.05)
    assert f"mission complete: {waypoints} of {waypoints} waypoints" in ended.err
    assert (planner.room / "lake.png").read_bytes().startswith(b"\x89PNG")

    station = open_station(boat.port)
    assert station.mode() == LOITER
    assert station.metres_from(NEAR_GOAL) < 5.0
    assert len(station.download()) == waypoints + 1


def test_ctrl_c_ends_the_planner_with_130_and_the_boat_sails_on(
    running_boat: RunBoat, run_program: RunProgram, open_station: OpenStation
) -> None:
    boat = running_boat("lake", "--speedup", "4")
    planner = run_program("mission-upload", "lake", "--connect", boat.url, "--start", "--follow")
    planner.wait_for("^waypoint 1 of")
    planner.send(signal.SIGINT)
    ended = planner.wait()
    assert (ended.code, one_line(ended)) == (130, "interrupted")
    station = open_station(boat.port)
    assert station.mode() == AUTO
    before_m = station.metres_from(GOAL)
    station.wait_for("VFR_HUD", lambda hud: hud.groundspeed > 1.0)
    station.wait_for(
        "GLOBAL_POSITION_INT", lambda _: station.metres_from(GOAL) < before_m - 2.0, timeout_s=JOB_S
    )
