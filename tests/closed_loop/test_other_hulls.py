"""Hulls that are not the boat's model, by runs of the campaign that sails them."""

from pathlib import Path

import pytest

from sitl.experiments.campaign.campaign import load_campaign
from sitl.experiments.mission_trial import run_mission
from sitl.experiments.trial import Trial, attempt

CAMPAIGN = Path("examples/campaigns/other_hulls.toml")


def run_of(hull: str) -> Trial:
    """Its zigzag in a current to the east, by the first seed."""
    (run,) = (
        run
        for run in load_campaign(CAMPAIGN).runs
        if (run.course, run.seed, run.factors["hull"]) == ("zigzag", 1, hull)
        and run.factors["environment.current_to_deg"] == 90.0
    )
    return run


@pytest.mark.parametrize("hull", ["small_skeg", "heavy_and_slow", "gnss_1_hz", "poor_sensors"])
def test_a_hull_that_the_boat_does_not_know_completes_its_course(hull: str) -> None:
    outcome = attempt(run_mission, run_of(hull))
    assert outcome.ended == "completed", outcome.why
    overshoot_m = outcome.figures["overshoot_m"]
    assert isinstance(overshoot_m, float)
    assert overshoot_m < 1.3  # the known hull's worst corner in the campaign: 0.9 m
