"""No program of the planner replaces a file unasked that it has not written itself."""

from pathlib import Path

import pytest

from mission_tools.cli import download_command, plan_command, upload_command
from mission_tools.errors import UsageError
from mission_tools.overwrite_guard import check_replaceable

pytestmark = pytest.mark.slow

EXAMPLES = Path(__file__).parents[2] / "examples" / "maps"
MARKED = [".plan", ".geojson", ".kml", ".gpx", ".html", ".png", ".svg", ".pdf"]
# Files of others that speak of this program: maps, plans saved anew elsewhere, pages that cite it.
FOREIGN = {
    ".geojson": '{"type": "FeatureCollection", "name": "mavboat", "generator": "JOSM", "features": []}',
    ".plan": '{"fileType": "Plan", "groundStation": "QGroundControl", "note": "mavboat"}',
    ".kml": '<?xml version="1.0" encoding="UTF-8"?>\n<kml><!-- written by mavboat --></kml>',
    ".gpx": '<?xml version="1.0"?>\n<gpx creator="OpenCPN"><name>mavboat</name></gpx>',
    ".html": "<!doctype html><title>mavboat</title>",
    ".png": "mavboat",
    ".svg": "<svg>mavboat</svg>",
    ".pdf": "%PDF mavboat",
    ".waypoints": "QGC WPL 110\n",
}


def plan(*arguments: object) -> int:
    return plan_command.run_program([*map(str, arguments)])


@pytest.mark.parametrize("suffix", MARKED)
def test_what_the_planner_wrote_is_replaced(suffix: str, tmp_path: Path) -> None:
    path = tmp_path / f"route{suffix}"
    assert plan("open", "--start-at", "50,-1.2", "--goal", "50.001,-1.2", "--out", path) == 0
    check_replaceable("--out", path, force=False)


@pytest.mark.parametrize("suffix", FOREIGN)
def test_what_others_wrote_is_replaced_only_by_force(suffix: str, tmp_path: Path) -> None:
    path = tmp_path / f"mine{suffix}"
    path.write_text(FOREIGN[suffix], encoding="utf-8")
    with pytest.raises(UsageError, match=r"exists, and does not say that this program wrote it.*--force"):
        check_replaceable("--out", path, force=False)
    check_replaceable("--out", path, force=True)


def test_the_map_of_the_examples_is_not_replaced_and_its_fence_is_made_anew() -> None:
    with pytest.raises(UsageError, match="exists"):
        check_replaceable("--out", EXAMPLES / "mill_pond.geojson", force=False)
    check_replaceable("--out", EXAMPLES / "mill_pond_fence.geojson", force=False)


def test_upload_and_download_ask_before_they_connect(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "mine.plan"
    path.write_text(FOREIGN[".plan"], encoding="utf-8")
    assert upload_command.run_program(["lake", "--save", str(path)]) == 2
    assert download_command.run_program([str(path)]) == 2
    assert capsys.readouterr().err.count("mine.plan: exists") == 2
