"""`mission-upload` against a vehicle that misbehaves on request: what a person is told, and the exit code.

The vehicle is pymavlink over TCP, in this process; the program talks to it through MAVSDK.
"""

import json
from collections import Counter
from pathlib import Path

import pytest
from fake_vehicle import Behaviour, fake_vehicle, link, zigzag_plan
from pymavlink.dialects.v20 import all as dialect

from mission_tools.cli.upload import run_program

pytestmark = pytest.mark.realtime


@pytest.fixture
def plan(tmp_path: Path) -> str:
    """A mission file of six waypoints."""
    return zigzag_plan(tmp_path)


def test_a_mission_is_uploaded_started_and_followed_by_a_planner_that_is_no_ground_station(
    plan: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    picture = tmp_path / "voyage.png"
    with fake_vehicle(Behaviour(lose_reached=True)) as vehicle:
        options = ["--system-id", "77", "--start", "--follow", "--preview", str(picture), "--json"]
        assert run_program([plan, *link(vehicle), *options]) == 0
    told = capsys.readouterr()
    tree = json.loads(told.out)
    assert tree["started"] is tree["upload"]["read_back_equal"] is True
    assert tree["voyage"]["track_length_m"] == pytest.approx(
        190.0, rel=0.15
    )  # on a busy machine some places are not seen
    assert "mission complete: 6 of 6 waypoints" in told.err
    assert picture.read_bytes().startswith(b"\x89PNG")
    assert len(vehicle.mission) == 7
    assert [item.frame for item in vehicle.mission] == [0, 3, 3, 3, 3, 3, 3]
    heartbeats = [message for _, _, message in vehicle.heard if message.get_type() == "HEARTBEAT"]
    assert {message.type for message in heartbeats} == {dialect.MAV_TYPE_ONBOARD_CONTROLLER}
    assert {message.autopilot for message in heartbeats} == {dialect.MAV_AUTOPILOT_INVALID}
    assert {(system, component) for system, component, _ in vehicle.heard} == {(77, 191)}


@pytest.mark.parametrize(
    ("behaviour", "code", "said"),
    [
        (
            Behaviour(refuse_item=3, refuse_text="Mission: bad latitude"),
            1,
            "the vehicle refused item 3: x or latitude is invalid (Mission: bad latitude)",
        ),
        (
            Behaviour(hush_at_item=3),
            3,
            "after item 2; bring the vehicle nearer, or connect by UDP, and try again",
        ),
        (Behaviour(alter_item=4), 1, "does not hold what was sent: item 4: x sent"),
        (Behaviour(silent=True), 3, "no vehicle within 5 s"),
        (Behaviour(refuse_arming="Arm: no GNSS fix"), 1, "refused to arm: Arm: no GNSS fix"),
        (
            Behaviour(leave_auto_after=2),
            1,
            "left AUTO for HOLD on the way to waypoint 3 of 6 (GCS lost: HOLD)",
        ),
        (Behaviour(die_after=2), 3, "lost the vehicle while following the mission"),
    ],
)
def test_what_goes_wrong_is_told_in_one_line_with_its_exit_code(
    behaviour: Behaviour, code: int, said: str, plan: str, capsys: pytest.CaptureFixture[str]
) -> None:
    patience_s = 5 if behaviour.silent or behaviour.refuse_arming else 20  # what ends only with it
    with fake_vehicle(behaviour) as vehicle:
        found = run_program([plan, *link(vehicle, patience_s), "--start", "--follow"])
    told = capsys.readouterr().err.splitlines()
    assert len(told) == 1, told
    assert said in told[0]
    assert found == code


def test_an_upload_that_breaks_off_twice_is_tried_a_third_time(
    plan: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with fake_vehicle(Behaviour(hush_at_item=3, hushes=2)) as vehicle:
        assert run_program([plan, *link(vehicle)]) == 0
    told = capsys.readouterr().out
    assert told.count("no answer while uploading the mission, after item 2: trying again") == 2
    assert "read back and found equal" in told
    assert len(vehicle.mission) == 7


def test_a_vehicle_that_is_no_ardupilot_gets_no_home_item(plan: str) -> None:
    with fake_vehicle(Behaviour(autopilot=dialect.MAV_AUTOPILOT_PX4)) as vehicle:
        assert run_program([plan, *link(vehicle)]) == 0
    assert [item.frame for item in vehicle.mission] == [3] * 6


def test_a_fence_comes_up_alone_and_the_mission_stays(
    plan: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    ring = [[-1.2, 50.0], [-1.19, 50.0], [-1.19, 50.01], [-1.2, 50.0]]
    shapes: list[tuple[dict[str, object], dict[str, object]]] = [
        ({"type": "Polygon", "coordinates": [ring]}, {"kind": "inclusion"}),
        ({"type": "Point", "coordinates": [-1.192, 50.001]}, {"kind": "exclusion", "radius_m": 12.5}),
        ({"type": "Point", "coordinates": [-1.193, 50.001]}, {"kind": "rally"}),
    ]
    features = [{"type": "Feature", "geometry": shape, "properties": what} for shape, what in shapes]
    fence = str(tmp_path / "fence.geojson")
    Path(fence).write_text(json.dumps({"type": "FeatureCollection", "features": features}))
    with fake_vehicle() as vehicle:
        assert run_program([plan, *link(vehicle)]) == 0
        held = list(vehicle.mission)
        assert run_program(["--fence", fence, "--rally", fence, *link(vehicle), "--json"]) == 0
        assert vehicle.mission == held
        assert Counter(item.command for item in vehicle.fence) == {5001: 3, 5004: 1}
        assert vehicle.fence[-1].param1 == 12.5
        assert [item.command for item in vehicle.rally] == [5100]
        told = capsys.readouterr()
        assert run_program(["--fence", "none", "--rally", "none", *link(vehicle)]) == 0
        assert (vehicle.mission, vehicle.fence) == (held, [])
    assert "cleared the fence and the rally points of vehicle 1" in capsys.readouterr().out
    report = json.loads(told.out[told.out.index("{") :])
    assert report["upload"]["lists"] == {"fence": 4, "rally": 1}
    assert report["upload"]["read_back_equal"] is True
    assert "2 fence areas, 1 rally point" in told.err
