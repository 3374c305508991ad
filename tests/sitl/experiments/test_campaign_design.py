from hypothesis import given
from hypothesis import strategies as st

from sitl.experiments.campaign.campaign import Choice, Sample, grid_rows, sample_rows


def test_a_grid_is_every_combination_the_last_setting_changing_fastest() -> None:
    rows = list(grid_rows({"a": [1, 2], "b": ["x", "y"]}))
    assert rows == [{"a": 1, "b": "x"}, {"a": 1, "b": "y"}, {"a": 2, "b": "x"}, {"a": 2, "b": "y"}]
    assert list(grid_rows({})) == [{}]


@given(count=st.integers(1, 60), seed=st.integers(0, 2**31), low=st.floats(-50, 50), span=st.floats(0.1, 50))
def test_a_latin_hypercube_meets_every_share_of_a_range_once(
    count: int, seed: int, low: float, span: float
) -> None:
    rows = sample_rows(Sample(count=count, seed=seed), {"x": (low, low + span)})
    shares = sorted(int((row["x"] - low) / span * count * (1.0 - 1e-12)) for row in rows)
    assert len(rows) == count
    assert all(abs(share - n) <= 1 for n, share in enumerate(shares))
    assert all(low <= row["x"] <= low + span for row in rows)


@given(count=st.integers(1, 40), seed=st.integers(0, 1000))
def test_choices_of_a_latin_hypercube_come_equally_often(count: int, seed: int) -> None:
    choice = Choice(choose=("calm", "windy", "rough"))
    drawn = [row["sea"] for row in sample_rows(Sample(count=3 * count, seed=seed), {"sea": choice})]
    assert {word: drawn.count(word) for word in choice.choose} == dict.fromkeys(choice.choose, count)


def test_a_sample_depends_on_its_seed_and_one_setting_more_changes_no_other() -> None:
    sample = Sample(count=10, seed=3)
    alone = [row["x"] for row in sample_rows(sample, {"x": (0.0, 1.0)})]
    with_another = [row["x"] for row in sample_rows(sample, {"y": (5.0, 9.0), "x": (0.0, 1.0)})]
    other_seed = [row["x"] for row in sample_rows(Sample(count=10, seed=4), {"x": (0.0, 1.0)})]
    assert alone == with_another
    assert alone != other_seed
