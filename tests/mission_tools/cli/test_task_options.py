"""Tasks and costs on the command line."""

import json
import re
from pathlib import Path
from typing import Any

import pytest

from mission_tools.cli.check import run_program as run_check
from mission_tools.cli.plan import run_program as run_plan
from mission_tools.cli.upload import run_program as run_upload
from mission_tools.geojson import collection, feature
from mission_tools.mission.plan_file import load_mission

SOUTH_WEST, SOUTH_EAST = "50.0002,-1.1998", "50.0002,-1.1982"
NORTH_WEST, NORTH_EAST = "50.0018,-1.1998", "50.0018,-1.1982"
RINGS = {
    "water": [[-1.2, 50.0], [-1.198, 50.0], [-1.198, 50.002], [-1.2, 50.002], [-1.2, 50.0]],
    "island": [[-1.1993, 50.0008], [-1.1987, 50.0008], [-1.1987, 50.0012], [-1.1993, 50.0012],
               [-1.1993, 50.0008]],
}  # fmt: skip
POND = collection([feature("Polygon", [ring], kind=kind) for kind, ring in RINGS.items()])
AREA = [[-1.2, 50.0], [-1.1994, 50.0], [-1.1994, 50.002], [-1.2, 50.002], [-1.2, 50.0]]


@pytest.fixture
def pond(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A pond of 143 × 222 m with an island, and an area in its west; the working folder."""
    (tmp_path / "pond.geojson").write_text(json.dumps(POND))
    (tmp_path / "west.geojson").write_text(json.dumps({"type": "Polygon", "coordinates": [AREA]}))
    monkeypatch.chdir(tmp_path)


@pytest.fixture
def plan(pond: None, capsys: pytest.CaptureFixture[str]) -> Any:  # noqa: ANN401
    """Plans from the south-west and gives the report; the mission is in out.plan."""

    def run(*arguments: str) -> dict[str, Any]:
        common = ["pond.geojson", "--start", SOUTH_WEST, "--clearance", "3", "--json", "--out", "out.plan"]
        assert run_plan([*common, *arguments]) == 0
        report: dict[str, Any] = json.loads(capsys.readouterr().out)
        assert run_check(["out.plan", "--map", "pond.geojson", "--clearance", "3"]) == 0
        capsys.readouterr()
        return report

    return run


def test_stations_hold_for_their_time(plan: Any) -> None:  # noqa: ANN401
    report = plan("--via", f"{NORTH_EAST}@45", "--goal", NORTH_WEST, "--hold", "60")
    assert report["task"]["hold_s"] == 105.0
    holds = [item.params[0] for item in load_mission(Path("out.plan")).items]
    assert [hold for hold in holds if hold] == [45.0, 60.0]


def test_a_survey_covers_the_area_of_a_file(plan: Any) -> None:  # noqa: ANN401
    report = plan("--survey", "west.geojson", "--footprint", "8", "--overlap", "0.25", "--angle", "0")
    assert re.search(r"lines 6\.00 m apart, \d+ tracks on 0°", report["task"]["notes"][-1])
    assert {"track", "shore"} <= {leg["kind"] for leg in report["task"]["legs"]}
    assert max(lon for _, lon in report["waypoints"]) < -1.1993
    tracks_only = plan(
        "--survey", "west.geojson", "--footprint", "8", "--overlap", "0.25", "--shore-passes", "0"
    )
    assert "shore" not in {leg["kind"] for leg in tracks_only["task"]["legs"]}


def test_gaps_are_filled_without_passes_and_tracks_lie_along_the_current(plan: Any) -> None:  # noqa: ANN401
    report = plan(
        "--fill-gaps", "west.geojson", "--spacing", "8", "--angle", "current", "--current", "0.3,210"
    )
    assert "8.00 m apart" in report["task"]["notes"][-1]
    assert "tracks on 30°" in report["task"]["notes"][-1]
    assert "shore" not in {leg["kind"] for leg in report["task"]["legs"]}


def test_tracks_lie_along_a_tide_that_turns(plan: Any) -> None:  # noqa: ANN401
    """Flood to the north-east, a weaker ebb back: their mean points one way, their axis is the same."""
    rows = [(0, 0.4, 0.4), (18_000, 0.0, 0.0), (36_000, -0.3, -0.3), (72_000, 0.0, 0.0)]
    text = "east_m,north_m,time_s,current_east_m_s,current_north_m_s\n"
    for east_m, north_m in ((-200, -200), (-200, 200), (200, -200), (200, 200)):
        text += "".join(f"{east_m},{north_m},{t},{east},{north}\n" for t, east, north in rows)
    Path("tide.csv").write_text(text)
    report = plan("--survey", "all", "--spacing", "12", "--angle", "current", "--current", "tide.csv")
    assert "tracks on 45°" in report["task"]["notes"][-1]


def test_a_search_begins_at_its_datum_and_takes_images_along_its_line(plan: Any) -> None:  # noqa: ANN401
    arguments = ("--survey", "all", "--footprint", "12", "--trigger", "camera:4", "--at", NORTH_EAST)
    report = plan(*arguments, "--pattern", "expanding-square")
    first = next(leg for leg in report["task"]["legs"] if leg["kind"] == "track")
    assert first["length_m"] > 0.0
    commands = [item.command for item in load_mission(Path("out.plan")).items]
    at = commands.index(206)
    lat, lon = (float(text) for text in NORTH_EAST.split(","))
    assert report["waypoints"][at - 1] == pytest.approx([lat, lon], abs=2e-6)
    assert commands.count(206) % 2 == 0


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ("--spacing 5", "--spacing: only with --survey"),
        ("--distance 5", "--distance: only with --follow-shore"),
        (f"--survey all --spacing 5 --goal {NORTH_EAST}", "--goal: not with --survey"),
        (f"--survey all --follow-shore {NORTH_EAST}", "two tasks"),
        (f"--follow-shore {NORTH_EAST}", "--follow-shore: expected --distance M as well"),
        (f"--follow-shore {NORTH_EAST} --distance 5 --return", "--return: not with --follow-shore"),
        ("--survey all", "--survey: expected --spacing M or --footprint M as well"),
        ("--survey gone.geojson --spacing 5", "gone.geojson: cannot be read"),
        (f"--via {NORTH_EAST}@soon", "expected LAT,LON or LAT,LON@SECONDS"),
        ("--via there", "--via 'there': expected LAT,LON"),
        (f"--goal {NORTH_EAST} --hold -1", "hold time is -1 s"),
        ("--any-order", "names no goal"),
        ("--shore-to left", "--shore-to"),
        (f"--goal {NORTH_EAST} --at {NORTH_WEST}", "--at: only with --pattern"),
        (f"--goal {NORTH_EAST} --lead 5", "--lead: only with --survey"),
        (f"--goal {NORTH_EAST} --trigger camera:5", "--trigger: only with --survey or --follow-shore"),
        ("--survey all --spacing 9 --trigger sonar", "--trigger 'sonar': expected camera:METRES"),
        ("--survey all --fill-gaps west.geojson --spacing 9", "--survey and --fill-gaps are two surveys"),
        ("--survey all --spacing 9 --angle current", "--angle current: add --current M/S,DEG or a file"),
        ("--survey all --spacing 9 --lead -5", "lead is -5 m: expected 0 or more"),
        ("--survey all --spacing 9 --pattern spiral --lead 5", "--lead: not with --pattern"),
        ("--survey all --spacing 9 --pattern spiral --at 10,10", "--at: 10.000000,10.000000 is nowhere near"),
    ],
)
def test_options_that_do_not_go_together_are_told_in_a_line(
    arguments: str, said: str, pond: None, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run_plan(["pond.geojson", "--start", SOUTH_WEST, *arguments.split()]) == 2
    told = capsys.readouterr().err
    assert said in told
    assert told.count("\n") == 1


def test_a_mission_that_is_ready_takes_no_task(plan: Any, capsys: pytest.CaptureFixture[str]) -> None:  # noqa: ANN401
    plan("--goal", NORTH_EAST)
    assert run_plan(["out.plan", "--return", "--via", NORTH_WEST, "--follow-shore", NORTH_WEST]) == 2
    assert "--via, --return, --follow-shore would plan one" in capsys.readouterr().err


def test_a_turn_radius_gives_a_survey_turns(plan: Any) -> None:  # noqa: ANN401
    straight = plan("--survey", "all", "--footprint", "6")
    rounded = plan("--survey", "all", "--footprint", "6", "--turn-radius", "5")
    assert length_of_m(rounded, "track") == pytest.approx(length_of_m(straight, "track"))
    by_boat = plan("--survey", "all", "--footprint", "6", "--boat", "lake", "--one-way")
    assert by_boat["task"]["legs"] == straight["task"]["legs"]  # two motors turn it on the spot
    assert length_of_m(rounded, "transit") > 1.5 * length_of_m(straight, "transit")


def length_of_m(report: dict[str, Any], kind: str) -> float:
    """Of the legs of one kind."""
    return float(sum(leg["length_m"] for leg in report["task"]["legs"] if leg["kind"] == kind))


def test_the_quickest_route_in_a_current_is_told_with_its_time(plan: Any) -> None:  # noqa: ANN401
    report = plan("--goal", NORTH_EAST, "--current", "1,180", "--boat", "lake")
    assert any(note.startswith("takes ") for note in report["plan"]["notes"])
    still = plan("--goal", NORTH_EAST, "--boat", "lake")
    assert report["budget"]["charge_mah"] > 1.2 * still["budget"]["charge_mah"]
    # A top speed of 2.86 m/s leaves 1.86 m/s where the current of 1 m/s is right ahead, in place of 2
    assert 1.01 < report["budget"]["time_s"] / still["budget"]["time_s"] < 1.04


@pytest.mark.parametrize(
    ("arguments", "code", "said"),
    [
        ("--current 5,0", 1, "current or wind is too strong for the boat on every way"),
        ("--current strong", 2, "--current strong: expected SPEED,TO_DEG"),
        ("--least time", 2, "--least: add --current"),
        ("--least charge --current 0.5,0", 2, "--least charge: add --boat"),
        ("--open-water 0", 2, "--open-water 0: expected more than 0"),
        ("--open-water 5 --return", 2, "only for a way from place to place"),
        ("--boat canoe", 2, "--boat canoe: no such boat"),
    ],
)
def test_costs_that_cannot_be_had_are_told_in_a_line(
    arguments: str, code: int, said: str, pond: None, capsys: pytest.CaptureFixture[str]
) -> None:
    common = ["pond.geojson", "--start", SOUTH_WEST, "--goal", NORTH_EAST]
    assert run_plan([*common, *arguments.split()]) == code
    told = capsys.readouterr().err
    assert said in told
    assert told.count("\n") == 1


def test_a_plan_that_does_not_come_home_is_refused_and_not_saved(
    pond: None, capsys: pytest.CaptureFixture[str]
) -> None:
    Path("small.toml").write_text("[battery]\ncapacity_mah = 150.0\ncruise_a = 2.7\nidle_a = 0.6\n")
    common = ["pond.geojson", "--start", SOUTH_WEST, "--goal", NORTH_EAST, "--out", "far.plan"]
    assert run_plan([*common, "--boat", "small.toml"]) == 1
    told = capsys.readouterr()
    assert "the boat does not come home: its point of no return is " in told.err
    assert "point of no return: after " in told.out
    assert not Path("far.plan").exists()
    assert run_plan([*common, "--boat", "small.toml", "--one-way"]) == 0
    assert Path("far.plan").exists()
    capsys.readouterr()
    Path("tiny.toml").write_text("[battery]\ncapacity_mah = 20.0\ncruise_a = 2.7\nidle_a = 0.6\n")
    assert run_plan([*common, "--boat", "tiny.toml", "--one-way"]) == 1
    assert "the charge lasts for " in capsys.readouterr().err
    assert run_plan([*common, "--boat", "tiny.toml", "--beyond-range", "--json", "--force"]) == 0
    assert json.loads(capsys.readouterr().out)["budget"]["suffices"] is False


def test_fence_and_rally_points_of_the_map_go_into_the_file(plan: Any, capsys: Any) -> None:  # noqa: ANN401
    plan("--goal", NORTH_EAST, "--contract")
    saved = load_mission(Path("out.plan"))
    assert [polygon.inclusion for polygon in saved.fence.polygons] == [True, False]
    assert len(saved.rally) == 1
    plan("--goal", NORTH_EAST, "--rally-from-map")
    saved = load_mission(Path("out.plan"))
    assert (len(saved.fence.polygons), len(saved.rally)) == (0, 1)
    for arguments in (["pond.geojson", "--fence", "none", "--contract"], ["out.plan", "--contract"]):
        assert run_plan(arguments) == 2
    assert "--fence and --fence-from-map exclude each other" in capsys.readouterr().err


# The west as a map whose line runs out to the north and back
CROSSING = [[-1.2, 50.0], [-1.1994, 50.0], [-1.1994, 50.0021], [-1.1994, 50.002], [-1.2, 50.002]]


@pytest.fixture
def crossing(pond: None) -> None:
    """A map that has to be repaired, in the working folder."""
    water = feature("Polygon", [[*CROSSING, CROSSING[0]]], kind="water")
    Path("loop.geojson").write_text(json.dumps(collection([water])))


def repairs(notes: list[str]) -> list[str]:
    return [note for note in notes if "loop.geojson" in note]


@pytest.mark.parametrize(
    "arguments",
    [
        ("--survey", "loop.geojson", "--spacing", "8"),
        ("--fence", "loop.geojson", "--goal", "50.0018,-1.1997"),
        ("--fence", "loop.geojson", "--survey", "loop.geojson", "--spacing", "8"),
    ],
)
def test_the_repairs_of_a_fence_and_of_a_surveyed_area_are_reported(
    plan: Any,  # noqa: ANN401
    crossing: None,
    arguments: tuple[str, ...],
) -> None:
    notes = repairs(plan(*arguments)["notes"])
    assert notes
    assert all("crosses or touches itself" in note for note in notes)


def test_the_repairs_of_a_fence_alone_are_reported(
    crossing: None, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run_upload(["--fence", "loop.geojson", "--dry-run"]) == 0
    assert "note: loop.geojson: feature 1" in capsys.readouterr().out
    assert run_upload(["--fence", "loop.geojson", "--dry-run", "--json"]) == 0
    (note,) = json.loads(capsys.readouterr().out)["notes"]
    assert "crosses or touches itself" in note


# In parts


@pytest.fixture
def small_pack(pond: None) -> None:
    """A boat whose pack does not last for the pond."""
    Path("small.toml").write_text("[battery]\ncapacity_mah = 560.0\ncruise_a = 2.6\nidle_a = 0.6\n")


SPLIT = ("pond.geojson", "--start", SOUTH_WEST, "--clearance", "3", "--survey", "all", "--footprint", "16",
         "--boat", "small.toml", "--split")  # fmt: skip


def test_a_split_survey_is_a_file_a_part_and_one_picture(
    small_pack: None, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run_plan([*SPLIT, "--json", "--out", "survey.plan", "--preview", "survey.html"]) == 0
    report = json.loads(capsys.readouterr().out)
    rows = report["split"]["parts"]
    assert len(rows) >= report["split"]["least"] >= 2
    assert [row["saved"] for row in rows] == [f"survey_{n}.plan" for n in range(1, len(rows) + 1)]
    assert all(row["suffices"] for row in rows)
    places = [place for row in rows for place in load_mission(Path(row["saved"])).places]
    assert [[at.lat_deg, at.lon_deg] for at in places] == report["waypoints"]
    page = Path("survey.html").read_text()
    assert all(f"part {n}: {row['length_m']:.0f} m" in page for n, row in enumerate(rows, 1))
    for row in rows:
        assert run_check([row["saved"], "--map", "pond.geojson", "--clearance", "3"]) == 0


def test_one_part_is_written_as_it_is_named(small_pack: None, capsys: pytest.CaptureFixture[str]) -> None:
    assert run_plan([*SPLIT, "--out", "all.plan"]) == 0
    assert run_plan([*SPLIT, "--resume", "2", "--out", "rest.plan"]) == 0
    assert load_mission(Path("rest.plan")).items == load_mission(Path("all_2.plan")).items
    capsys.readouterr()
    for wrong in ("0", "99", "two", "2@", "2@x"):
        assert run_plan([*SPLIT, "--resume", wrong]) == 2
        assert f"--resume {wrong}: expected N or N@ITEM, and a part N from 1 to" in capsys.readouterr().err
    assert run_plan(["pond.geojson", "--start", SOUTH_WEST, "--goal", NORTH_EAST, "--resume", "2"]) == 2
    assert "--resume: only with --split" in capsys.readouterr().err


def test_parts_replace_only_what_this_program_wrote_and_name_what_is_left_of_an_earlier_split(
    small_pack: None, capsys: pytest.CaptureFixture[str]
) -> None:
    Path("survey_2.plan").write_text("{}")
    assert run_plan([*SPLIT, "--out", "survey.plan"]) == 2
    assert "survey_2.plan: exists, and does not say that this program wrote it" in capsys.readouterr().err
    assert not Path("survey_1.plan").exists()
    Path("survey_2.plan").unlink()
    Path("survey_77.plan").write_text('{"groundStation": "mavboat"}')
    assert run_plan([*SPLIT, "--out", "survey.plan"]) == 0
    said = capsys.readouterr().out
    assert "note: survey_77.plan is of an earlier split" in said
    assert Path("survey_2.plan").exists()


def test_a_picture_of_a_split_tour_names_its_parts(
    small_pack: None, capsys: pytest.CaptureFixture[str]
) -> None:
    Path("small.toml").write_text("[battery]\ncapacity_mah = 330.0\ncruise_a = 2.6\nidle_a = 0.6\n")
    ways = [word for place in (NORTH_WEST, NORTH_EAST, SOUTH_EAST) for word in ("--via", place)]
    tour = ["pond.geojson", "--start", SOUTH_WEST, *ways, "--any-order", "--boat", "small.toml", "--split"]
    assert run_plan([*tour, "--out", "tour.svg"]) == 0
    lines = [line for line in capsys.readouterr().out.splitlines() if line.startswith("part ")]
    assert len(lines) >= 2
    drawn = Path("tour.svg").read_text()
    assert all(f"<!-- {line} -->" in drawn for line in lines)


def test_the_rest_of_a_part_begins_with_the_way_to_the_item_that_was_reached(
    small_pack: None, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run_plan([*SPLIT, "--speed", "1.5", "--resume", "2", "--out", "part.plan"]) == 0
    items = load_mission(Path("part.plan")).items
    seq = len(items) // 2  # item 1 is the speed, so this is waypoint seq - 1
    resumed = [*SPLIT, "--speed", "1.5", "--resume", f"2@{seq}", "--out", "rest.plan"]
    assert run_upload([*resumed, "--dry-run"]) == 0
    rest = load_mission(Path("rest.plan"))
    assert rest.items[0] == items[0]
    at = rest.items.index(items[seq - 1])
    assert rest.items[at:] == items[seq - 1 :]
    assert run_check(["rest.plan", "--map", "pond.geojson", "--clearance", "3"]) == 0
    capsys.readouterr()
    for none in (0, len(items), len(items) + 1):
        assert run_plan([*SPLIT, "--speed", "1.5", "--resume", f"2@{none}"]) == 2
        assert f"after item {none} nothing is left: expected 1 to {len(items) - 1}" in capsys.readouterr().err


def test_a_wind_is_counted_and_told_with_the_times_of_the_waypoints(plan: Any) -> None:  # noqa: ANN401
    report = plan("--goal", NORTH_EAST, "--boat", "rudder", "--wind", "5@45")
    still = plan("--goal", NORTH_EAST, "--boat", "rudder")
    assert report["budget"]["charge_mah"] > 1.2 * still["budget"]["charge_mah"]
    assert report["budget"]["home_mah"] < still["budget"]["home_mah"]
    drawn, passed_s = report["budget"]["drawn_mah"], report["budget"]["under_way_s"]
    assert len(drawn) == len(passed_s) == len(report["waypoints"])
    assert passed_s == sorted(passed_s)
    assert drawn == sorted(drawn)
    assert drawn[-1] == pytest.approx(report["budget"]["charge_mah"])


@pytest.mark.parametrize(
    ("options", "code", "said"),
    [
        ("--wind 6@270", 2, "--wind: add --boat BOAT.toml"),
        ("--boat kit --wind strong", 2, "--wind 'strong': expected M_S@FROM, such as 6@270"),
        ("--boat kit --wind 14@45", 1, "cannot be sailed in 14 m/s of wind by a boat of 1.45 m/s"),
        ("--boat kit --wind 8@225", 1, "its gusts turn the boat across, harder than it can steer"),
        (
            "--boat kit --wind 9@45 --current 0.3,225",
            1,
            "current or wind is too strong for the boat on every way",
        ),
        ("--boat kit --least charge", 2, "--least: add --current or --wind"),
    ],
)
def test_a_wind_that_cannot_be_sailed_or_read_is_refused_with_the_reason(
    options: str, code: int, said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run_plan(["lake", *options.split()]) == code
    assert said in capsys.readouterr().err
