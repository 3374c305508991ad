"""`mission-upload` and `boat-sitl` as two processes that meet over MAVLink: what a person sees and gets."""

import json
import re
import signal
from pathlib import Path
from typing import Any

import pytest
from mavutil_station import OpenStation, Place
from patience import JOB_S
from programs import Ended, RunBoat, RunningBoat, RunProgram
from pymavlink.dialects.v20 import all as dialect
from wiretap import Wiretap

from companion.core.geo import LatLon, distance_m
from mission_tools.assembly.areas import load_fence
from mission_tools.maps import load_source
from mission_tools.maps.fenced import fenced

pytestmark = pytest.mark.realtime
pytest_plugins = ("program_fixtures",)

AUTO, LOITER = 10, 5
GOAL = Place(16, 3, 500020857, -11969034)  # of the scenario `lake`
ISLAND = "50.0,-1.2"  # Alder Island, on the same pond
FENCE = str(Path(__file__).parents[2] / "examples/maps/mill_pond_fence.geojson")


def one_line(ended: Ended) -> str:
    """The single line that a failed program leaves on stderr."""
    assert ended.err.startswith("mission-upload: "), ended
    assert ended.err.count("\n") == 1, ended
    return ended.err.removeprefix("mission-upload: ").strip()


def test_a_planned_mission_is_uploaded_sailed_and_reported(
    running_boat: RunBoat, run_program: RunProgram, open_station: OpenStation
) -> None:
    boat = running_boat("lake", "--speedup", "40")
    planner = run_program(
        "mission-upload",
        "lake",
        "--connect",
        boat.url,
        "--start",
        "--follow",
        "--json",
        "--preview",
        "lake.png",
    )
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
    assert station.metres_from(GOAL) < 5.0
    assert len(station.download()) == waypoints + 1


def test_a_mission_is_planned_and_sailed_inside_a_fence_that_goes_along(
    running_boat: RunBoat, run_program: RunProgram, open_station: OpenStation
) -> None:
    boat = running_boat("lake", "--speedup", "15")
    areas = ["--fence", FENCE, "--rally", FENCE, "--connect", boat.url]
    ended = run_program("mission-upload", "lake", *areas, "--start", "--follow", "--json").wait(JOB_S)
    assert ended.code == 0, ended
    report = json.loads(ended.out)
    assert report["upload"]["lists"] == {"mission": len(report["waypoints"]) + 1, "fence": 238, "rally": 2}
    assert report["upload"]["read_back_equal"] is True
    water = fenced(load_source("lake").chart, load_fence(Path(FENCE)).fence, FENCE)
    off = [water.obstruction(water.frame.to_local(LatLon(*place))) for _, *place in report["voyage"]["track"]]
    assert set(off) == {None}
    assert open_station(boat.port).mode() == LOITER
    assert run_program("mission-upload", "--fence", "none", "--connect", boat.url).wait(JOB_S).code == 0


def refused_by_a_boat(
    running_boat: RunBoat, run_program: RunProgram, setting: str
) -> tuple[RunningBoat, str]:
    boat = running_boat("lake", "--set", setting)
    ended = run_program("mission-upload", "lake", "--connect", boat.url, "--start", "--patience", "10").wait(
        JOB_S
    )
    assert ended.code == 1, ended
    assert "read back and found equal" in ended.out
    return boat, one_line(ended)


def test_a_boat_with_a_low_pack_is_not_armed_and_says_why(
    running_boat: RunBoat, run_program: RunProgram, open_station: OpenStation
) -> None:
    boat, told = refused_by_a_boat(running_boat, run_program, "battery.charge=0.0")
    assert re.search(r"refused to arm: Arm: Battery: \d+\.\d V is below 10\.5 V", told)
    heartbeat = open_station(boat.port).wait_for("HEARTBEAT", lambda beat: beat.get_srcSystem() == 1)
    assert not heartbeat.base_mode & dialect.MAV_MODE_FLAG_SAFETY_ARMED


def test_a_boat_without_a_fix_does_not_sail_says_why_and_is_not_left_armed(
    running_boat: RunBoat, run_program: RunProgram, open_station: OpenStation
) -> None:
    boat, told = refused_by_a_boat(running_boat, run_program, "sensors.gnss.fix_type=1")
    assert re.search(r"refused to .*(position|GPS)", told)
    heartbeat = open_station(boat.port).wait_for("HEARTBEAT", lambda beat: beat.get_srcSystem() == 1)
    assert not heartbeat.base_mode & dialect.MAV_MODE_FLAG_SAFETY_ARMED


def test_nobody_at_the_other_end_is_told_with_the_url(run_program: RunProgram) -> None:
    ended = run_program("mission-upload", "lake", "--connect", "tcp:127.0.0.1:9", "--patience", "1").wait(
        JOB_S
    )
    assert ended.code == 3
    assert one_line(ended).startswith("tcp:127.0.0.1:9: no vehicle within 1 s")


def test_a_goal_on_an_island_is_wrong_input_and_the_boat_keeps_its_mission(
    running_boat: RunBoat, run_program: RunProgram, open_station: OpenStation
) -> None:
    boat = running_boat("lake")
    ended = run_program("mission-upload", "lake", "--connect", boat.url, "--goal", ISLAND).wait(JOB_S)
    assert ended.code == 2
    assert "lies on Alder Island" in one_line(ended)
    assert open_station(boat.port).download() == []


def test_a_scenario_with_a_wrong_key_is_wrong_input_to_planner_and_emulator(run_program: RunProgram) -> None:
    planner = run_program("mission-upload", "wrong.toml", "--dry-run")
    emulator = run_program("boat-sitl", "serve", "wrong.toml", "--tcp", "0", "--no-udp")
    for program in (planner, emulator):
        (program.room / "wrong.toml").write_text("[route]\nclearence_m = 3.0\n", encoding="ascii")
    for program, name in ((planner, "mission-upload"), (emulator, "boat-sitl")):
        ended = program.wait(JOB_S)
        assert ended.code == 2, ended
        assert re.fullmatch(rf"{name}: wrong\.toml: .*clearence_m.*\n", ended.err), ended


def test_a_boat_that_dies_in_mid_upload_is_a_lost_link(
    running_boat: RunBoat, run_program: RunProgram
) -> None:
    boat = running_boat("lake")

    def cut(message: Any) -> None:  # noqa: ANN401 — pymavlink has no types
        if message.get_type() == "MISSION_ITEM_INT" and message.seq == 3:
            boat.program.kill()

    with Wiretap(boat.port, cut) as tap:
        ended = run_program("mission-upload", "lake", "--connect", tap.url).wait(JOB_S)
    assert not boat.program.is_running
    assert ended.code == 3, ended
    assert re.search(r"stopped answering while uploading the mission, after item \d", one_line(ended))


def test_a_boat_that_dies_on_its_way_is_a_lost_link(running_boat: RunBoat, run_program: RunProgram) -> None:
    boat = running_boat("lake")
    planner = run_program("mission-upload", "lake", "--connect", boat.url, "--start", "--follow")
    planner.wait_for("^waypoint 1 of")
    boat.program.kill()
    ended = planner.wait(JOB_S)
    assert ended.code == 3, ended
    assert "lost the vehicle while following the mission" in one_line(ended)


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


def test_the_planner_is_an_onboard_controller_that_does_not_stand_in_for_the_operator(
    running_boat: RunBoat, run_program: RunProgram, open_station: OpenStation
) -> None:
    boat = running_boat("lake")
    with Wiretap(boat.port) as tap:
        planner = run_program("mission-upload", "lake", "--connect", tap.url, "--start", "--follow")
        planner.wait_for("^waypoint 1 of")
        station = open_station(boat.port)
        station.heartbeat()  # the operator looks in once, and is never heard again
        station.wait_for("STATUSTEXT", lambda text: "Operator lost" in text.text, timeout_s=JOB_S)
        assert station.mode() == LOITER
        ended = planner.wait(JOB_S)
    assert ended.code == 1, ended
    assert re.search(r"left AUTO for LOITER .*\(Failsafe: Operator lost", one_line(ended))
    heartbeats = [message for message in tap.said if message.get_type() == "HEARTBEAT"]
    assert len(heartbeats) >= 4
    assert {message.type for message in heartbeats} == {dialect.MAV_TYPE_ONBOARD_CONTROLLER}
    assert {message.autopilot for message in heartbeats} == {dialect.MAV_AUTOPILOT_INVALID}
    senders = {(message.get_srcSystem(), message.get_srcComponent()) for message in tap.said}
    assert senders == {(246, dialect.MAV_COMP_ID_ONBOARD_COMPUTER)}


def test_a_route_on_a_scenario_starts_where_the_boat_is(
    running_boat: RunBoat, run_program: RunProgram
) -> None:
    """A boat that has left the scenario's start is planned for anew without going back there."""
    boat = running_boat("lake", "--start", "50.0010,-1.1975")
    ended = run_program("mission-upload", "lake", "--connect", boat.url, "--json").wait(JOB_S)
    assert ended.code == 0, ended
    report = json.loads(ended.out)
    lake = load_source("lake")
    to_local, goal = lake.chart.frame.to_local, lake.route.goal
    assert goal is not None
    start = to_local(LatLon(50.0010, -1.1975))
    assert distance_m(to_local(LatLon(*report["home"])), start) < 5.0  # the receiver's error
    assert report["plan"]["straight_m"] == pytest.approx(distance_m(start, goal), abs=5.0)
