"""Sensor noise stays out of the motors: a few runs of what `examples/campaigns/calm_hands.toml` bounds."""

import pytest
from boat_rig import scenario

from sitl.courses.missions import lay_out, wire_items
from sitl.experiments.campaign.calm_figures import calm_figures
from sitl.run.mission_run import MissionRun

GUSTS = (
    "environment.current_m_s=0.5", "environment.current_to_deg=90", "environment.wind_m_s=5",
    "environment.gust_m_s=8", "environment.wind_from_deg=90",
)  # fmt: skip


@pytest.mark.parametrize(("weather", "at_most"), [((), 14.0), (GUSTS, 17.0)], ids=["calm", "gusts"])
def test_the_motors_run_calmly_on_a_straight_line(weather: tuple[str, ...], at_most: float) -> None:
    world = scenario("open", *weather, "seed=3")
    mission_run = MissionRun(world, wire_items(lay_out("straight", world)))
    result = mission_run.run()
    figures = calm_figures(mission_run)
    assert result.completed
    travel = figures["motor_travel_per_min"]
    assert travel is not None
    assert travel < at_most, figures
