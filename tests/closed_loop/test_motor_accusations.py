"""Healthy boats that wind and current push about are told nothing of their motors; failing motors are named.

A few runs of what `examples/campaigns/motors_healthy.toml` and `motors_failing.toml` sail in numbers.
"""

import pytest
from boat_rig import scenario

from sitl.courses.missions import lay_out, wire_items
from sitl.experiments.campaign.motor_figures import motor_figures
from sitl.run.mission_run import MissionRun, Result

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
    ],
    ids=["square", "less-skeg"],
)
def test_a_healthy_boat_in_wind_and_current_is_told_nothing_of_its_motors(
    course: str, settings: tuple[str, ...]
) -> None:
    mission_run, result = sail(course, *settings)
    assert motor_figures(mission_run) == {"motor_alarms": 0}, said(mission_run)
    assert "Checking the motors" not in said(mission_run)
    assert result.completed


def test_each_motor_alone_tells_which_propeller_is_fouled() -> None:
    """Both motors at a similar command, against gusts and current: 15.6 s without a comparison."""
    mission_run, _ = sail(
        "straight", "environment.current_m_s=0.85", "environment.current_to_deg=225",
        "environment.wind_m_s=3.74", "environment.gust_m_s=10.98", "environment.wind_from_deg=279.9",
        "hull.mass_kg=7.97", "hull.inertia_kg_m2=0.8", "hull.surge_linear=0.331",
        "hull.surge_quadratic=0.578", "hull.sway_linear=3.82", "hull.sway_quadratic=25.9",
        "hull.yaw_linear=0.204",
        "hull.skeg_lift_kg_m=6.9", "thrusters.propeller.diameter_m=0.0302", "thrusters.motor.no_load_a=0.248",
        "sensors.gnss.rate_hz=1", 'faults=[{what="motor_right", kind="weed", at_s=37.0}]', "seed=3",
        timeout_s=46.0,
    )  # fmt: skip
    figures = motor_figures(mission_run)
    assert "Motors draw more current: comparing them" in said(mission_run)
    assert (figures["motor_alarms"], figures["motor_named"]) == (0, 1), said(mission_run)


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
