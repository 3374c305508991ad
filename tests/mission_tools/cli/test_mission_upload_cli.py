"""The programs as a person meets them: wrong input gives one clear line and the right exit code."""

import json
import re
import socket
from pathlib import Path

import pytest

from companion.core.geo import LatLon
from mission_tools.cli import check as check_cli
from mission_tools.cli import upload as upload_cli
from mission_tools.cli.arguments import position, with_places
from mission_tools.errors import UsageError
from mission_tools.mission.mission import Command
from mission_tools.mission.plan_file import load_mission

POND = """{"type": "FeatureCollection", "features": [
  {"type": "Feature", "properties": {"kind": "water", "name": "Pond"}, "geometry": {"type": "Polygon",
   "coordinates": [[[-1.2, 50.0], [-1.198, 50.0], [-1.198, 50.002], [-1.2, 50.002], [-1.2, 50.0]]]}},
  {"type": "Feature", "properties": {"kind": "island", "name": "Goose Island"}, "geometry": {
   "type": "Polygon",
   "coordinates": [[[-1.1993, 50.0008], [-1.1987, 50.0008], [-1.1987, 50.0012], [-1.1993, 50.0012],
                    [-1.1993, 50.0008]]]}}]}"""
SCENARIO = """
[map]
file = "pond.geojson"
[route]
start = { lat_deg = 50.0004, lon_deg = -1.199 }
goal = { lat_deg = 50.0016, lon_deg = -1.199 }
clearance_m = 4.0
"""
START, GOAL = "50.0004,-1.199", "50.0016,-1.199"


@pytest.fixture
def pond(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with a map, a scenario and things that cannot be used; also the working folder."""
    (tmp_path / "pond.geojson").write_text(POND)
    (tmp_path / "pond.toml").write_text(SCENARIO)
    (tmp_path / "bad_key.toml").write_text(SCENARIO.replace("clearance_m", "clearence_m"))
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize("name", ["pond.geojson", "pond.toml", "route.csv", "route.shp", "route"])
def test_a_mission_is_saved_in_a_known_format_only_and_never_over_the_map(pond: Path, name: str) -> None:
    before = {path: path.read_bytes() for path in pond.iterdir()}
    arguments = ["pond.geojson", "--start-at", START, "--goal", GOAL, "--dry-run", "--save", name]
    assert upload_cli.run_program(arguments) == 2
    assert {path: path.read_bytes() for path in pond.iterdir()} == before


@pytest.mark.parametrize("option", ["--save", "--preview"])
def test_what_is_read_is_not_written_over(
    pond: Path, option: str, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = ["pond.toml", "--dry-run", "--save", "first.plan"]
    assert upload_cli.run_program(arguments) == 0
    before = (pond / "first.plan").read_bytes()
    (pond / "again.png").symlink_to("first.plan")
    name = "./first.plan" if option == "--save" else "again.png"
    assert upload_cli.run_program(["first.plan", "--dry-run", "--speed", "1", option, name]) == 2
    assert f"{option} {Path(name)}: would overwrite first.plan" in capsys.readouterr().err
    assert (pond / "first.plan").read_bytes() == before
    assert upload_cli.run_program(["pond.toml", "--dry-run", "--save", "FIRST.PLAN"]) == 0
    assert load_mission(pond / "FIRST.PLAN").places == load_mission(pond / "first.plan").places


@pytest.fixture
def nobody() -> str:
    """A port on which nobody listens."""
    with socket.create_server(("127.0.0.1", 0)) as server:
        return f"tcp:127.0.0.1:{server.getsockname()[1]}"


@pytest.mark.parametrize(
    ("arguments", "code", "said"),
    [
        ("nowhere.geojson --goal " + GOAL, 2, "nowhere.geojson: "),
        ("nowhere.plan", 2, "nowhere.plan: cannot be read: No such file"),
        ("no_such_scenario", 2, "no_such_scenario: no such scenario"),
        ("bad_key.toml --dry-run", 2, "bad_key.toml: .*clearence_m"),
        ("pond.toml --goal 50.001,-1.199 --dry-run", 2, "goal 50.001000,-1.199000 lies on Goose Island"),
        ("pond.toml --clearance 60 --dry-run", 2, "clearance of 60 m"),
        (
            "pond.toml --dry-run --save route.csv",
            2,
            r"route.csv: missions are written as \.plan .*\.waypoints",
        ),
        ("pond.toml --clearance wide", 2, "Invalid value for '--clearance'"),
        ("pond.toml --heuristic luck --dry-run", 2, "heuristic 'luck'"),
        ("pond.toml --goal 91,0", 2, "--goal '91,0': latitude 91.0 is outside"),
        ("pond.toml --connect carrier-pigeon", 2, "--connect 'carrier-pigeon': it names no port"),
        ("pond.toml --preview map.txt --dry-run", 2, "--preview map.txt: expected a name"),
        ("pond.toml --preview pond.toml/map.png --dry-run", 2, "pond.toml/map.png: pond.toml is no folder"),
        ("pond.toml --connect NOBODY --patience 0.3", 3, "NOBODY: no vehicle within 0.3 s: is the boat"),
        (
            "pond.toml --connect /dev/ttyMISSING --patience 0.3",
            3,
            "/dev/ttyMISSING: .*is the radio plugged in",
        ),
    ],
)
def test_wrong_input_gives_one_line_and_its_exit_code(
    arguments: str, code: int, said: str, pond: Path, nobody: str, capsys: pytest.CaptureFixture[str]
) -> None:
    found = upload_cli.run_program(arguments.replace("NOBODY", nobody).split())
    told = capsys.readouterr().err.splitlines()
    assert found == code, told
    assert len(told) == 1
    assert re.search(rf"^mission-upload: .*{said.replace('NOBODY', nobody)}", told[0]), told[0]


def test_a_dry_run_plans_reports_and_saves_without_a_vehicle(
    pond: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = ["pond.toml", "--dry-run", "--speed", "1.5", "--save", "route.plan"]
    assert upload_cli.run_program(arguments) == 0
    assert re.match(r"Pond: \d waypoints, 1[45]\d m \(straight 133 m\)", capsys.readouterr().out)
    mission = load_mission(pond / "route.plan")
    assert mission.home == LatLon(50.0004, -1.199)
    assert mission.items[0].command == Command.DO_CHANGE_SPEED
    assert mission.places[-1] == LatLon(50.0016, -1.199)
    assert check_cli.run_program(["route.plan", "--map", "pond.toml"]) == 0


def test_json_is_alone_on_stdout(pond: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert upload_cli.run_program(["pond.toml", "--dry-run", "--json"]) == 0
    tree = json.loads(capsys.readouterr().out)
    assert tree["ok"] is True
    assert tree["waypoints"][-1] == [50.0016, -1.199]
    assert tree["plan"]["length_m"] > tree["plan"]["straight_m"] > 130.0
    assert tree["plan"]["min_clearance_m"] >= 3.99
    assert tree["upload"] is None


def test_debug_keeps_the_traceback(pond: Path) -> None:
    with pytest.raises(UsageError):
        upload_cli.run_program(["pond.toml", "--connect", "x", "--debug"])


@pytest.mark.parametrize(
    ("typed", "meant"),
    [
        (["--start", "50.1,-1.2"], ["--start-at", "50.1,-1.2"]),
        (["--start=50.1,-1.2"], ["--start-at=50.1,-1.2"]),
        (["lake", "--start"], ["lake", "--start"]),
        (["--start", "--follow"], ["--start", "--follow"]),
        (["--start", "lake"], ["--start", "lake"]),
        (["--start", "-33.8,151.2", "--start"], ["--start-at", "-33.8,151.2", "--start"]),
    ],
)
def test_start_with_a_position_names_a_place(typed: list[str], meant: list[str]) -> None:
    assert with_places(typed) == meant


def test_check_lists_findings_and_fails(pond: Path, capsys: pytest.CaptureFixture[str]) -> None:
    row = "\t".join(["{}", "0", "{}", "16", "0", "0", "0", "0", "{}", "-1.199", "0", "1"])
    rows = [row.format(0, 0, 50.0004), row.format(1, 3, 50.0016)]
    (pond / "over.waypoints").write_text("\n".join(["QGC WPL 110", *rows]))
    assert check_cli.run_program(["over.waypoints"]) == 0
    assert check_cli.run_program(["over.waypoints", "--map", "pond.geojson", "--json"]) == 1
    out = capsys.readouterr().out
    assert "1 item, no findings" in out
    findings = json.loads(out[out.index("{") :])["findings"]
    assert [finding["item"] for finding in findings] == [1]
    assert "Goose Island is in the way" in findings[0]["text"]


FENCE = """{"type": "Feature", "properties": {"kind": "%s"}, "geometry": {"type": "Polygon", "coordinates":
  [[[-1.1993, 50.0001], [-1.1986, 50.0001], [-1.1986, 50.0014], [-1.1993, 50.0014], [-1.1993, 50.0001]]]}}"""


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ("--dry-run", "nothing to upload: expected a SOURCE, --fence FILE or --rally FILE"),
        ("--fence none --start", "no SOURCE: --start would need"),
        ("--fence none --clearance 3", "no SOURCE: options about the route would need"),
        ("pond.toml --fence gone.geojson --dry-run", "gone.geojson: cannot be read"),
        ("pond.toml --rally in.geojson --dry-run", "in.geojson: no rally point in it"),
        (
            "pond.toml --fence in.geojson --dry-run",
            "goal 50.001600,-1.199000 lies in the water outside the fence",
        ),
        ("pond.toml --fence out.geojson --dry-run", "start 50.000400,-1.199000 lies in the fence polygon 1"),
    ],
)
def test_a_fence_that_does_not_go_is_told_in_a_line(
    pond: Path, arguments: str, said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    (pond / "in.geojson").write_text(FENCE % "inclusion")
    (pond / "out.geojson").write_text(FENCE % "exclusion")
    assert upload_cli.run_program(arguments.split()) == 2
    told = capsys.readouterr().err
    assert said in told
    assert told.count("\n") == 1


def test_a_mission_that_leaves_its_fence_is_noted_by_item(
    pond: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert upload_cli.run_program(["pond.toml", "--dry-run", "--save", "r.plan"]) == 0
    (pond / "in.geojson").write_text(FENCE % "inclusion")
    assert upload_cli.run_program(["r.plan", "--fence", "in.geojson", "--dry-run", "--save", "f.plan"]) == 0
    assert re.search(r"note: item \d: lies in the water outside the fence", capsys.readouterr().out)
    assert len(load_mission(Path("f.plan")).fence.polygons) == 1


@pytest.mark.parametrize(
    "text",
    [
        "50.0005,-1.1990",
        "50.0005 -1.1990",
        "50.0005; -1.1990",
        "N 50 00.03 W 1 11.94",
        "n50 00.03, w001 11.94",
        "50 00.03, -1 11.94",
        "50°00.03'N 1°11.94'W",
        "50° 0′ 1.8″ N, 1° 11′ 56.4″ W",
        "50:00:01.8N 1:11:56.4W",
        "50.0005N 1.1990W",
    ],
)
def test_a_place_is_read_in_the_notations_of_charts_and_receivers(text: str) -> None:
    found = position("--goal", text)
    assert found is not None
    assert (found.lat_deg, found.lon_deg) == pytest.approx((50.0005, -1.1990))


def test_south_and_west_are_negative_whatever_the_degrees() -> None:
    assert position("--goal", "0 30 S 0 30 W") == LatLon(-0.5, -0.5)
    assert position("--goal", "-0 30, -0 30") == LatLon(-0.5, -0.5)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("50.0005", "expected LAT,LON in degrees"),
        ("W 1 11.94 N 50 00.03", "expected LAT,LON in degrees"),
        ("50 60.0, -1 11.94", "'50 60.0' has minutes or seconds of 60 or more"),
        ("50.5 30.0, -1 11.94", "'50.5 30.0' has a fraction before its last part"),
        ("N 95 00.03 W 1 11.94", "latitude 95.0005 is outside"),
        ("50 1 2 3, -1", "expected LAT,LON in degrees"),
    ],
)
def test_what_is_no_place_says_what_is_wrong(text: str, said: str) -> None:
    with pytest.raises(UsageError, match=said):
        position("--goal", text)


def test_a_place_in_two_words_is_one() -> None:
    given = ["pond.kml", "--start", "50.0", "-1.2", "--goal", "50.0005", "-1.1990", "--speed", "2", "--start"]
    assert with_places(given) == [
        "pond.kml", "--start-at", "50.0,-1.2", "--goal", "50.0005,-1.1990", "--speed", "2", "--start"
    ]  # fmt: skip
    assert with_places(["--start", "--goal", "50.0,-1.2", "-1.0"]) == [
        "--start",
        "--goal",
        "50.0,-1.2",
        "-1.0",
    ]


@pytest.mark.parametrize("option", ["--diff", "--if-changed"])
def test_a_dry_run_says_that_it_compares_with_nothing(
    option: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert upload_cli.run_program(["lake", option, "--dry-run"]) == 0
    assert (
        f"note: {option} compares with what is on board, and --dry-run asks no vehicle"
        in capsys.readouterr().out
    )
    assert upload_cli.run_program(["lake", "--dry-run"]) == 0
    assert "compares" not in capsys.readouterr().out
