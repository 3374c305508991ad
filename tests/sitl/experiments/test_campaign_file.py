"""What a campaign's file means, and what is said of one that cannot be used."""

from pathlib import Path

import pytest

from companion.core.errors import ConfigError
from sitl.experiments.campaign.campaign import Campaign, load_campaign
from sitl.experiments.campaign.sea_state import draw_waves
from sitl.experiments.mission_trial import scenario_of

EXAMPLES = sorted(Path("examples/campaigns").glob("*.toml"))


def campaign(folder: Path, text: str) -> Campaign:
    path = folder / "c.toml"
    path.write_text(text, encoding="utf-8")
    return load_campaign(path)


def test_runs_are_the_product_of_voyages_grid_and_seeds(tmp_path: Path) -> None:
    plan = campaign(
        tmp_path,
        """
        [run]
        course = ["straight", "square"]
        seeds = 2
        first_seed = 101
        settings.environment.current_m_s = 0.5
        [grid]
        environment.current_to_deg = [0.0, 90.0]
        """,
    )
    assert [(run.course, run.factors["environment.current_to_deg"], run.seed) for run in plan.runs] == [
        (course, to_deg, seed)
        for course in ("straight", "square")
        for to_deg in (0.0, 90.0)
        for seed in (101, 102)
    ]
    assert [run.number for run in plan.runs] == list(range(1, 9))
    assert plan.runs[2].settings == {"environment": {"current_m_s": 0.5, "current_to_deg": 90.0}}
    assert plan.factors == ("environment.current_to_deg",)


def test_variants_are_named_bundles_of_settings_each_with_the_same_seeds(tmp_path: Path) -> None:
    plan = campaign(
        tmp_path,
        """
        [run]
        course = "straight"
        seeds = 2
        settings.environment.current_m_s = 0.5
        [variants.receiver]
        standard = {}
        rtk = { sensors.gnss.noise_m = 0.01, sensors.gnss.wander_m = 0.02 }
        [grid]
        environment.current_to_deg = [0.0, 90.0]
        """,
    )
    assert [
        (run.factors["receiver"], run.factors["environment.current_to_deg"], run.seed) for run in plan.runs
    ] == [
        (receiver, to_deg, seed)
        for receiver in ("standard", "rtk")
        for to_deg in (0.0, 90.0)
        for seed in (1, 2)
    ]
    assert "sensors" not in plan.runs[0].settings
    assert plan.runs[-1].settings == {
        "environment": {"current_m_s": 0.5, "current_to_deg": 90.0},
        "sensors": {"gnss": {"noise_m": 0.01, "wander_m": 0.02}},
    }
    assert plan.factors == ("receiver", "environment.current_to_deg")


def test_every_draw_of_a_sample_has_seeds_of_its_own(tmp_path: Path) -> None:
    plan = campaign(
        tmp_path,
        """
        [run]
        seeds = 3
        [grid]
        boat.model = ["lake", "pool"]
        [sample]
        count = 4
        settings.environment.current_m_s = [0.0, 1.0]
        settings.environment.current_to_deg = { choose = [0.0, 180.0] }
        """,
    )
    lake = [run for run in plan.runs if run.factors["boat.model"] == "lake"]
    assert sorted(run.seed for run in lake) == list(range(1, 13))
    assert len({run.factors["environment.current_m_s"] for run in lake}) == 4


def test_runs_draw_waves_by_their_seed_and_every_sea_is_met(tmp_path: Path) -> None:
    plan = campaign(
        tmp_path,
        'run = {course = ["straight", "zigzag"], seeds = 60}\ngrid.environment.current_m_s = [0.0, 0.5]',
    )
    by_seed: dict[int, set[tuple[float, ...]]] = {}
    for run in plan.runs:
        sea = run.below["environment"]
        by_seed.setdefault(run.seed, set()).add(
            (sea["wave_height_m"], sea["wave_period_s"], sea["wave_from_deg"])
        )
    assert all(len(seas) == 1 for seas in by_seed.values())
    seas = [sea for found in by_seed.values() for sea in found]
    assert {sea[:2] for sea in seas} == {
        (height, period) for height in (0.0, 0.1, 0.3) for period in (1.8, 3.0)
    }
    assert len({sea[2] for sea in seas}) == len(seas)


@pytest.mark.parametrize(
    ("scenario", "text", "height_m"),
    [
        ("open", "", 0.3),
        ("open", "waves = false", 0.0),
        ("open", "settings.environment.wave_height_m = 0.05", 0.05),
        ("pool", "", 0.0),
    ],
)
def test_drawn_waves_give_way_to_those_of_campaign_and_scenario(
    tmp_path: Path, scenario: str, text: str, height_m: float
) -> None:
    seed = next(seed for seed in range(99) if draw_waves(seed)["environment"]["wave_height_m"] == 0.3)
    (run,) = campaign(tmp_path, f'[run]\nscenario = "{scenario}"\nseeds = [{seed}]\n{text}').runs
    assert scenario_of(run).environment.wave_height_m == height_m


def test_the_fingerprint_changes_with_the_runs_and_with_the_files_they_name(tmp_path: Path) -> None:
    (tmp_path / "m.plan").write_text("{}")
    first = campaign(tmp_path, 'run.mission = "m.plan"').fingerprint
    assert campaign(tmp_path, '# a remark\nrun.mission = "m.plan"').fingerprint == first
    assert campaign(tmp_path, 'run.mission = "m.plan"\nrun.seeds = 2').fingerprint != first
    (tmp_path / "m.plan").write_text("{} ")
    assert campaign(tmp_path, 'run.mission = "m.plan"').fingerprint != first


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('run.course = "figure of eight"', "run.course: no course 'figure of eight': expected straight,"),
        ('run = {course = "straight", mission = "a.plan"}', "either a course or a mission"),
        ("grid.environment.current_m_s = 0.5", "grid.environment.current_m_s: expected a list of values"),
        ("sample = {count = 2, settings.a.b = 3}", "sample.settings.a.b: expected \\[low, high\\]"),
        ("sample = {count = 2, settings.a.b = [3, 1]}", "the low end comes first"),
        ("runs = 3", "c.toml: runs: no such setting"),
        ("[[expect]]\nfigure = 'time_s'", "figure time_s: expected at_least, at_most or"),
    ],
)
def test_a_file_that_cannot_be_used_is_told_in_one_line(tmp_path: Path, text: str, words: str) -> None:
    with pytest.raises(ConfigError, match=words) as caught:
        campaign(tmp_path, text)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_the_examples_can_be_used(path: Path) -> None:
    plan = load_campaign(path)
    assert len(plan.runs) >= 20
    assert plan.expect
