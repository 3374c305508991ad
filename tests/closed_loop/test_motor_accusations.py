"""Healthy boats that wind and current push about are told nothing of their motors; failing motors are named.

A few runs of what `examples/campaigns/motors_healthy.toml` and `motors_failing.toml` sail in numbers.
"""

import pytest
from boat_rig import scenario

from sitl.experiments.campaign.motor_figures import motor_figures
from sitl.run.mission_run import MissionRun, Result
from sitl.scenarios.missions import lay_out, wire_items

GUSTS = ("environment.wind_m_s=5", "environment.gust_m_s=8", "environment.wind_from_deg=90")
CURRENT = ("environment.current_m_s=1.0", "environment.current_to_deg=90")
SLOW_CURRENT = ("environment.current_m_s=0.5", "environment.current_to_deg=90")
LESS_SKEG = "hull.skeg_lift_kg_m=6.3"  # 30 % less, and the boat is not told


def sail(course: str, *settings: str, timeout_s: float | None = None) -> tuple[MissionRun, Result]:
    world = scenario("open", *settings)
    mission_run = MissionRun(world, wire_items(lay_out(course, world)))
    return mission_run, mission_run.run(timeout_s)


def said(mission_run: MissionRun) -> list[str]:
    return [event.text for event in mission_run.timeline.events if event.kind == "text"]


@pytest.mark.parametrize(
    ("course", "settings"),
    [
        ("square", (*CURRENT, *GUSTS, "seed=1")),
        ("straight", (*SLOW_CURRENT, *GUSTS, LESS_SKEG, "seed=1")),
        ("straight", (*SLOW_CURRENT, *GUSTS, LESS_SKEG, "seed=2")),
    ],
    ids=["square", "less-skeg-1", "less-skeg-2"],
)
def test_a_healthy_boat_in_wind_and_current_is_told_nothing_of_its_motors(
    course: str, settings: tuple[str, ...]
) -> None:
    mission_run, result = sail(course, *settings)
    assert motor_figures(mission_run) == {"motor_alarms": 0}, said(mission_run)
    assert "Checking the motors" not in said(mission_run)
    assert result.completed


@pytest.mark.parametrize(
    ("what", "kind", "text"),
    [
        ("motor_right", "off", "Failsafe: Right motor gives no thrust"),
        ("motor_left", "stuck", "Failsafe: Left motor is blocked"),
        ("motor_right", "weed", "Failsafe: Weed on the right propeller"),
        ("motor_left", "wrong", "Failsafe: Steering lost: left motor reversed"),
    ],
)
def test_a_failing_motor_is_named_in_gusts_and_a_current(what: str, kind: str, text: str) -> None:
    fault = f'faults=[{{what="{what}", kind="{kind}", at_s=40.0}}]'
    mission_run, _ = sail("straight", *SLOW_CURRENT, *GUSTS, fault, "seed=3", timeout_s=52.0)
    figures = motor_figures(mission_run)
    assert text in said(mission_run)
    assert (figures["motor_alarms"], figures["motor_named"]) == (0, 1), said(mission_run)
