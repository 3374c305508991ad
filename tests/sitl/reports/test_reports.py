"""Pages of runs and campaigns: whole, self-contained, and true to what was sailed."""

import dataclasses
import re
from pathlib import Path

import numpy as np
import pytest
from boat_rig import HOME_ITEM, scenario, waypoint

from companion.core.errors import ConfigError
from sitl.__main__ import run_program
from sitl.experiments.campaign.campaign import Campaign
from sitl.experiments.campaign.expect import Expectation
from sitl.experiments.mission_trial import run_mission
from sitl.experiments.trial import Trial, TrialResult, attempt
from sitl.reports.campaign_page import again, campaign_page
from sitl.reports.run_page import run_page
from sitl.reports.run_record import RunRecord, load_record
from sitl.reports.run_series import brakes
from sitl.run.mission_run import MissionRun

pytestmark = pytest.mark.slow

ITEMS = [HOME_ITEM, waypoint(20.0, 0.0), waypoint(20.0, 20.0)]


@pytest.fixture(scope="module")
def record() -> RunRecord:
    fault = 'faults=[{what="compass", kind="wrong", size=3.0, at_s=6.0, for_s=2.0}]'
    water = "water=[[-30,-30],[60,-30],[60,60],[-30,60]]"
    rock = f'map={{{water}, obstacles=[{{name="Rock", circle={{centre=[3,10],radius_m=1}}}}]}}'
    mission_run = MissionRun(scenario("open", fault, rock, "environment.current_m_s=0.2"), ITEMS)
    return RunRecord.of(mission_run, mission_run.run())


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
    assert np.array_equal(
        again.estimates["current_north_m_s"], record.estimates["current_north_m_s"], equal_nan=True
    )
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


@pytest.fixture(scope="module")
def page(record: RunRecord) -> str:
    return run_page(record)


WPL = """QGC WPL 110
0\t1\t0\t16\t0\t0\t0\t0\t50.0\t-1.2\t0\t1
1\t0\t3\t16\t0\t0\t0\t0\t50.0002\t-1.2\t50\t1
"""


@pytest.fixture(scope="module")
def outcome(tmp_path_factory: pytest.TempPathFactory) -> TrialResult:
    path = tmp_path_factory.mktemp("mission") / "short.waypoints"
    path.write_text(WPL, encoding="utf-8")
    return attempt(run_mission, Trial(number=1, scenario="open", seed=1, mission=str(path)))


def test_the_page_of_a_run_needs_nothing_but_itself(record: RunRecord, page: str) -> None:
    assert page.startswith("<!doctype html>")
    assert page.count("<img") == 4  # chart, panels, innovations, sonar
    assert "data:image/png;base64," in page
    assert "data:image/svg+xml;base64," in page
    assert not re.search(r"(src|href)=\"(?!data:)", page)
    assert "<script" not in page
    assert "compass wrong is over" in page
    assert "Mission complete" in page
    assert record.result["state_hash"] in page


def test_the_page_of_a_campaign_shows_verdicts_and_the_runs_to_look_at(outcome: TrialResult) -> None:
    runs = (
        Trial(number=1, scenario="open", seed=1, course="straight", factors={"environment.current_m_s": 0.0}),
        Trial(number=2, scenario="open", seed=1, course="zigzag", factors={"environment.current_m_s": 0.0}),
    )
    bad = TrialResult(
        number=2, ended="error", why="a defect <here>", traceback="Traceback …", touched=("Rock",)
    )
    expect = (Expectation(figure="cross_track_rms_m", each="course", at_most=0.5),)
    page = campaign_page(Campaign("Two runs", "two.toml", runs, expect, ""), [outcome, bad])
    assert "course straight" in page
    assert "missing in 1" in page
    assert "a defect &lt;here&gt;" in page
    assert "Traceback …" in page
    assert "boat-sitl sail open --seed 1 --course zigzag" in page
    assert page.count("<img") >= 2


def test_the_command_that_sails_a_run_again_says_all_of_it() -> None:
    settings = {"random": {"fault": True}, "environment": {"current_m_s": 0.5}}
    run = Trial(number=3, scenario="random", seed=7, fence=True, linger_s=30.0, settings=settings)
    assert again(run) == (
        "boat-sitl sail random --seed 7 --fence --linger 30 "
        "--set random.fault=true --set environment.current_m_s=0.5"
    )
    waves = {"environment": {"wave_height_m": 0.1}}
    run = Trial(number=3, scenario="open", seed=7, below=waves)
    assert again(run) == "boat-sitl sail open --seed 7 --set environment.wave_height_m=0.1"


def test_sail_records_and_report_makes_the_page(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    kept = tmp_path / "out" / "run.npz"
    arguments = ["sail", "open", "--course", "straight", "--timeout", "5", "--record", str(kept)]
    assert run_program(arguments) == 1  # 5 s are too short, yet the run is kept
    assert run_program(["report", str(kept)]) == 0
    assert f"written: {kept.with_suffix('.html')}" in capsys.readouterr().out
    assert "not completed, ends in AUTO" in kept.with_suffix(".html").read_text(encoding="utf-8")


def visible(page: str) -> str:
    """The words of a page, without style, pictures and what is folded away."""
    page = re.sub(r"<style>.*?</style>|<details>.*?</details>", "", page, flags=re.DOTALL)
    return re.sub(r"<[^>]*>", " ", page)


def two_runs(*outcomes: TrialResult) -> str:
    runs = tuple(Trial(number=n, scenario="open", seed=n, course="straight") for n in (1, 2, 3))
    expect = (Expectation(figure="cross_track_rms_m", each="course", at_most=0.5),)
    return campaign_page(Campaign("Three runs", "three.toml", runs, expect, ""), list(outcomes))


def test_a_campaign_that_was_stopped_says_so_and_how_many_runs_are_missing(outcome: TrialResult) -> None:
    page = two_runs(outcome)
    words = visible(page)
    assert "Stopped early: 2 of 3 runs are missing" in words
    assert 'class="warning"' in page
    assert "None: every run that was sailed (2 are missing) was completed" in words
    assert "None: every run was completed" not in words
    assert "met so far" in words


def test_pages_speak_of_figures_in_words(page: str, outcome: TrialResult) -> None:
    for words in (visible(page), visible(two_runs(outcome))):
        assert re.findall(r"\b[a-z]+(?:_[a-z0-9]+)+\b", words) == []
        assert "cross-track error, RMS (m)" in words


def braked(record: RunRecord, astern: list[tuple[int, int]], surge_m_s: float = 1.0) -> RunRecord:
    """The record of a run in which both motors went astern in these rows, ten a second."""
    rows = 100
    times = np.arange(rows) / 10.0
    command = np.full(rows, 0.5)
    for begin, end in astern:
        command[begin:end] = -1.0
    estimates = {**record.estimates, "time_s": times, "left": command, "right": command}
    truth = {**record.truth, "time_s": times, "surge_m_s": np.full(rows, surge_m_s)}
    return dataclasses.replace(record, estimates=estimates, truth=truth)


def test_charts_show_where_the_boat_braked(record: RunRecord) -> None:
    assert brakes(braked(record, [(20, 30), (35, 38), (60, 61)])) == [(2.0, 3.7), (6.0, 6.0)]
    assert brakes(braked(record, [])) == []
    assert brakes(braked(record, [(20, 30)], surge_m_s=-0.2)) == []  # it goes astern: that is no brake
    one_motor = braked(record, [(20, 30)])
    one_motor.estimates["right"] = np.full(100, 0.5)
    assert brakes(one_motor) == []
