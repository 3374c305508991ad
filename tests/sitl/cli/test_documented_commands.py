"""The commands of README and docs, word for word: each is understood and finds what it names.

They run in the order of their page, from a folder like a fresh clone, up to where the boat would sail or a
link would be opened.
"""

import json
import re
import shlex
from collections.abc import Callable
from pathlib import Path

import pytest

from companion.core.geo import LatLon
from mission_tools.assembly.areas import load_fence
from mission_tools.cli import check as check_cli
from mission_tools.cli import plan as plan_cli
from mission_tools.cli import survey as survey_cli
from mission_tools.cli import trace_command
from mission_tools.cli import upload as upload_cli
from mission_tools.geojson import collection, feature
from mission_tools.maps import load_source
from mission_tools.maps.fenced import fence_area, fenced
from sitl.__main__ import run_program as run_sitl

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[3]
FENCE = ROOT / "examples" / "maps" / "mill_pond_fence.geojson"
PAGES = sorted([ROOT / "README.md", *(ROOT / "docs").glob("*.md")])
PROGRAMS: dict[str, Callable[[list[str]], int]] = {
    "boat-sitl": run_sitl,
    "mission-plan": plan_cli.run_program,
    "mission-upload": upload_cli.run_program,
    "mission-check": check_cli.run_program,
    "mission-trace": trace_command.run_program,
    "boat-survey": survey_cli.run_program,
}
COMMAND = re.compile(r"^ {4,}(?:\.venv/bin/)?((?:boat-sitl|boat-survey|mission-\w+|make demo)\b.*)$")
# Where each command that needs minutes or logs goes to work: everything before that is done here
AT_WORK = {
    "--learn": "mission_tools.costs.learned_draw.learn_draw",
    "export": "mission_tools.bathymetry.from_log.read_logs",
    "serve": "sitl.cli.serve.start_fleet",
    "sail": "sitl.cli.sail._run",
    "campaign": "sitl.cli.campaign.ResultLog",
    "encounters": "sitl.cli.encounters.run_trials",
    "report": "sitl.cli.report.load_record",
    "tune": "sitl.cli.tune.local_pool",
    "fit": "sitl.cli.fit.read_voyage",
    "paper": "sitl.cli.paper.run_trials",
    "physics": "sitl.cli.physics.PhysicsServer",
}


class AtWorkError(Exception):
    """The command has come to where it begins its work."""


def commands(page: Path) -> list[str]:
    """The commands in a page's blocks, without what follows a #."""
    lines = page.read_text(encoding="utf-8").splitlines()
    return [match[1].split(" #")[0].strip() for line in lines if (match := COMMAND.match(line))]


@pytest.fixture
def clone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The working folder: with the examples and, of what a command would have made, files of a chart."""
    (tmp_path / "examples").symlink_to(ROOT / "examples")
    (tmp_path / "out" / "chart").mkdir(parents=True)
    (tmp_path / "out" / "chart" / "lake.geojson").symlink_to(FENCE.with_name("mill_pond.geojson"))
    (tmp_path / "out" / "chart" / "chart.json").touch()
    gap = [[-1.2003, 50.0005], [-1.2001, 50.0005], [-1.2001, 50.0007], [-1.2003, 50.0005]]
    gaps = collection([feature("Polygon", [gap])])
    (tmp_path / "out" / "chart" / "gaps.geojson").write_text(json.dumps(gaps), encoding="utf-8")
    (tmp_path / "boat.toml").touch()
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))

    def stop(*_: object, **__: object) -> None:
        raise AtWorkError

    for place in AT_WORK.values():
        monkeypatch.setattr(place, stop)
    return tmp_path


def follow(command: str) -> None:
    """Carry out one command as far as it needs neither a boat nor minutes."""
    name, *arguments = shlex.split(command)
    if name == "make":
        given = dict(argument.split("=", 1) for argument in arguments if "=" in argument)
        if "MAP" in given:
            route = ["--start-at", given["START"], "--goal", given["GOAL"], "--dry-run"]
            assert upload_cli.run_program([given["MAP"], *route]) == 0
        return
    if "--voyage" in arguments or (not name.startswith("boat-") and "--learn" not in arguments):
        extra = ["--dry-run"] if name == "mission-upload" and "--dry-run" not in arguments else []
        assert PROGRAMS[name]([*arguments, *extra]) == 0
        return
    with pytest.raises(AtWorkError):
        PROGRAMS[name](["--debug", *arguments])


@pytest.mark.parametrize("page", [page for page in PAGES if commands(page)], ids=lambda page: page.stem)
def test_what_a_page_tells_to_type_works(page: Path, clone: Path) -> None:
    for command in commands(page):
        try:
            follow(command)
        except BaseException as error:
            raise AssertionError(f"{page.name}: {command}") from error


POND = re.compile(
    r"(?P<option>--[\w-]+ )?(?P<lat>49\.99\d{2,5}|50\.00\d{2,5})(?:° N\s+|, ?-)(?P<lon>1\.(?:19|20)\d{2,5})"
)


@pytest.mark.parametrize(
    "page", [page for page in PAGES if page.name != "physics.md"], ids=lambda page: page.stem
)
def test_every_place_on_the_pond_is_on_water_inside_the_fence(page: Path) -> None:
    """But those that name a shore by a place near it. docs/physics.md is about the open sea."""
    chart = fenced(load_source("lake").chart, load_fence(FENCE).fence, "fence")
    for found in POND.finditer(page.read_text(encoding="utf-8")):
        place = LatLon(float(found["lat"]), -float(found["lon"]))
        if found["option"] != "--follow-shore ":
            assert chart.obstruction(chart.frame.to_local(place)) is None, f"{page.name}: {found[0]}"


def test_the_fence_of_the_examples_is_what_its_command_makes_and_has_no_land_in_it(clone: Path) -> None:
    page = (ROOT / "examples" / "maps" / "README.md").read_text(encoding="utf-8")
    (command,) = re.findall(
        r"^    (mission-plan .*) --out examples/maps/mill_pond_fence.geojson$", page, re.M
    )
    follow(f"{command} --out out/fence.geojson")
    chart = load_source("lake").chart
    shipped, made = (
        fence_area(chart, load_fence(at).fence, "fence") for at in (FENCE, Path("out/fence.geojson"))
    )
    assert shipped.symmetric_difference(made).area < 1.0  # m²
    assert shipped.difference(chart.water).area < 1.0
    assert shipped.area > 0.9 * chart.water.area
