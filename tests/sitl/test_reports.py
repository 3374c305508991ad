"""Pages of runs and campaigns: whole, self-contained, and true to what was sailed."""

import re
from pathlib import Path

import numpy as np
import pytest
from boat_rig import HOME_ITEM, scenario, waypoint

from companion.errors import ConfigError
from sitl.__main__ import run_program
from sitl.campaign.campaign import Campaign
from sitl.campaign.expect import Expectation
from sitl.campaign.run import Outcome, Run, sail_run
from sitl.reports.campaign_page import again, campaign_page
from sitl.reports.page import Page
from sitl.reports.run_page import run_page
from sitl.run_record import RunRecord, load_record
from sitl.sail import Sailing

ITEMS = [HOME_ITEM, waypoint(20.0, 0.0), waypoint(20.0, 20.0)]


@pytest.fixture(scope="module")
def record() -> RunRecord:
    fault = 'faults=[{what="compass", kind="wrong", size=3.0, at_s=6.0, for_s=2.0}]'
    water = "water=[[-30,-30],[60,-30],[60,60],[-30,60]]"
    rock = f'map={{{water}, obstacles=[{{name="Rock", circle={{centre=[3,10],radius_m=1}}}}]}}'
    sailing = Sailing(scenario("open", fault, rock, "environment.current_m_s=0.2"), ITEMS)
    return RunRecord.of(sailing, sailing.run())


def test_a_record_reads_back_as_it_was_saved(record: RunRecord, tmp_path: Path) -> None:
    record.save(tmp_path / "run.npz")
    again = load_record(tmp_path / "run.npz")
    assert again.result == record.result
    assert again.settings == record.settings
    assert (again.planned, again.events, again.clearance_m) == (
        record.planned,
        record.events,
        record.clearance_m,
    )
    for name, column in record.truth.items():
        assert np.array_equal(again.truth[name], column), name
    assert np.array_equal(again.beliefs["set_north_m_s"], record.beliefs["set_north_m_s"], equal_nan=True)
    assert np.array_equal(again.echoes, record.echoes)
    assert again.chart.water.symmetric_difference(record.chart.water).area < 1e-2
    assert [feature.name for feature in again.chart.features] == ["Rock"]


@pytest.mark.parametrize(
    ("content", "words"), [(None, "no such file"), (b"no zip", "not the record of a run")]
)
def test_what_is_no_record_is_told(tmp_path: Path, content: bytes | None, words: str) -> None:
    path = tmp_path / "run.npz"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(ConfigError, match=words):
        load_record(path)


def test_the_page_of_a_run_needs_nothing_but_itself(record: RunRecord) -> None:
    page = run_page(record)
    assert page.startswith("<!doctype html>")
    assert page.count("<img") == 3  # chart, panels, sonar
    assert "data:image/png;base64," in page
    assert "data:image/svg+xml;base64," in page
    assert not re.search(r"(src|href)=\"(?!data:)", page)
    assert "<script" not in page
    assert "compass wrong is over" in page
    assert "Mission complete" in page
    assert record.result["state_hash"] in page


def test_the_same_run_gives_the_same_page(record: RunRecord) -> None:
    assert run_page(record) == run_page(record)


def test_text_is_escaped_and_missing_figures_are_dashes() -> None:
    page = Page("<b>", "a & b")
    page.table(("name", "value"), [("<i>", None)])
    html = page.render()
    assert "<b>" not in html.split("</title>")[0].split("<title>")[1]
    assert "a &amp; b" in html
    assert "&lt;i&gt;" in html
    assert ">–<" in html


def test_the_page_of_a_campaign_shows_verdicts_and_the_runs_to_look_at() -> None:
    runs = (
        Run(number=1, scenario="open", seed=1, course="straight", factors={"environment.current_m_s": 0.0}),
        Run(number=2, scenario="open", seed=1, course="zigzag", factors={"environment.current_m_s": 0.0}),
    )
    good = sail_run(runs[0])
    bad = Outcome(number=2, ended="error", why="a defect <here>", traceback="Traceback …", touched=("Rock",))
    expect = (Expectation(figure="cross_track_rms_m", each="course", at_most=0.5),)
    page = campaign_page(Campaign("Two runs", "two.toml", runs, expect, ""), [good, bad])
    assert "course straight" in page
    assert "missing in 1" in page
    assert "a defect &lt;here&gt;" in page
    assert "Traceback …" in page
    assert "boat-sitl sail open --seed 1 --course zigzag" in page
    assert page.count("<img") >= 2


def test_the_command_that_sails_a_run_again_says_all_of_it() -> None:
    settings = {"random": {"fault": True}, "environment": {"current_m_s": 0.5}}
    run = Run(number=3, scenario="random", seed=7, fence=True, linger_s=30.0, settings=settings)
    assert again(run) == (
        "boat-sitl sail random --seed 7 --fence --linger 30 "
        "--set random.fault=true --set environment.current_m_s=0.5"
    )


def test_sail_records_and_report_makes_the_page(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    kept = tmp_path / "out" / "run.npz"
    arguments = ["sail", "open", "--course", "straight", "--timeout", "5", "--record", str(kept)]
    assert run_program(arguments) == 1  # 5 s are too short, yet the run is kept
    assert run_program(["report", str(kept)]) == 0
    assert f"written: {kept.with_suffix('.html')}" in capsys.readouterr().out
    assert "not completed, ends in AUTO" in kept.with_suffix(".html").read_text(encoding="utf-8")


def test_a_folder_without_a_campaign_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run_program(["report", str(tmp_path)]) == 2
    assert "no campaign in it" in capsys.readouterr().err


def test_a_course_and_a_mission_exclude_each_other(capsys: pytest.CaptureFixture[str]) -> None:
    assert run_program(["sail", "open", "--course", "straight", "--mission", "a.plan"]) == 2
    assert run_program(["sail", "open", "--course", "circle"]) == 2
    assert "no course 'circle': expected straight," in capsys.readouterr().err
