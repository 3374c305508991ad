"""Failsafes on ground truth: a part fails in mid-leg, and the boat does what suits it."""

from typing import Any

import pytest
from boat_rig import Rig, scenario, waypoint
from sailing_rig import CURRENT, GUSTS, begin, drifted_m, is_stopped, said, told

from sitl.courses.missions import lay_out, wire_items
from sitl.experiments.campaign.motor_figures import motor_figures
from sitl.run.mission_run import MissionRun, Result

LESS_SKEG = "hull.skeg_lift_kg_m=6.3"  # 30 % less, and the boat is not told


def under_way(*settings: str, config: dict[str, object] | None = None, **parts: Any) -> Rig:  # noqa: ANN401
    """Well into a long leg north."""
    rig = Rig("open", *settings, config=config, **parts).sail(waypoint(600.0, 0.0), waypoint(600.0, 100.0))
    rig.run(20.0)
    rig.peer.forget()
    return rig


def test_a_boat_that_loses_position_and_heading_does_not_drive_again() -> None:
    rig = under_way()
    rig.run(15.0)
    begin(rig, "gnss")
    begin(rig, "compass")
    rig.until(lambda: is_stopped(rig), 3.0)
    for _ in range(40):
        rig.run(0.1)
        assert is_stopped(rig)
    assert rig.mode == "HOLD"
    lost = [text for text in rig.peer.texts if text in ("Failsafe: Heading lost", "Failsafe: Position lost")]
    assert lost == ["Failsafe: Heading lost", "Failsafe: Position lost"]


def test_a_lost_position_is_reckoned_on_then_held_against_the_water_then_given_up() -> None:
    rig = under_way(*CURRENT, config={"failsafe.dead_reckoning_s": 20.0})
    begin(rig, "gnss")
    assert told(rig, "Failsafe: GPS lost", 3.0) < 2.5
    assert told(rig, "Failsafe: Position lost", 60.0) > 20.0
    rig.run(15.0)
    assert rig.mode == "LOITER"
    assert drifted_m(rig, 20.0) < 0.5 * 0.5 * 20.0  # less than half of what the water would have carried it
    rig.until(lambda: rig.mode == "HOLD", 60.0)
    rig.run(1.0)
    assert is_stopped(rig)


def test_a_dead_motor_is_named_the_propellers_are_cleared_and_the_boat_goes_on_with_the_other() -> None:
    rig = under_way()
    begin(rig, "motor_left")
    told(rig, "Failsafe: Left motor gives no thrust", 20.0)
    told(rig, "Checking the motors", 1.0)
    told(rig, "Clearing the propellers", 30.0)
    rig.until(lambda: rig.boat.command.left < -0.5 and rig.boat.command.right < -0.5, 3.0)
    rig.until(lambda: rig.mode == "RTL", 120.0)
    assert rig.peer.texts.count("Clearing the propellers") == 2
    found = [
        text for text in rig.peer.texts if text.endswith("gives no thrust") or "gives no thrust, r" in text
    ]
    assert len(found) >= 3, "tried at once, and after each clearing"
    rig.until(lambda: rig.mode == "LOITER", 120.0)
    recovery = rig.boat.vehicle.recovery
    was_tried = True
    for _ in range(20):
        rig.run(0.5)
        was_tried, before = recovery.is_checking, was_tried  # as it is now and then
        assert was_tried or before or rig.boat.command.left == 0.0
        assert recovery.motor_check.motors.has_failed


def test_a_motor_that_runs_the_wrong_way_is_found_out_and_driven_the_other_way_round() -> None:
    rig = under_way()
    begin(rig, "motor_left", "wrong")
    told(rig, "Left motor is reversed", 60.0)
    told(rig, "Failsafe over", 40.0)
    assert rig.mode == "AUTO"
    rig.run(10.0)
    assert rig.world.truth.surge_m_s > 1.5
    assert abs(rig.world.truth.yaw_rate_rad_s) < 0.2
    rig.world.electronics.faults.end("motor_left")
    told(rig, "Left motor works, right works", 90.0)
    rig.run(20.0)
    assert rig.mode == "AUTO"
    assert rig.world.truth.north_m_s > 1.0


def test_a_boat_turns_back_while_its_charge_still_takes_it_home() -> None:
    capacity_mah = 80.0
    settings = ("environment.current_m_s=0.7", "environment.current_to_deg=0.0")
    rig = Rig("open", *settings, config={"battery.capacity_mah": capacity_mah}).sail(waypoint(900.0, 0.0))
    told(rig, "Failsafe: Point of no return", 200.0)
    assert rig.mode == "RTL"
    assert rig.world.truth.north_m > 30.0
    told(rig, "RTL: arrived", 400.0)
    assert 0.4 * capacity_mah < rig.boat.sensors.consumed_mah < capacity_mah


# Motors in wind and current: a few runs of `examples/campaigns/motors_healthy.toml` and `motors_failing.toml`


def sail(course: str, *settings: str, timeout_s: float | None = None) -> tuple[MissionRun, Result]:
    world = scenario("open", *settings)
    run = MissionRun(world, wire_items(lay_out(course, world)))
    return run, run.run(timeout_s)


def test_a_healthy_boat_in_wind_and_current_is_told_of_no_failsafe() -> None:
    current = ("environment.current_m_s=1.0", "environment.current_to_deg=90")
    run, result = sail("square", *current, *GUSTS, LESS_SKEG, "seed=1")
    assert motor_figures(run) == {"motor_alarms": 0}, said(run)
    assert not [text for text in said(run) if "Failsafe" in text or text == "Checking the motors"]
    assert result.completed


def test_each_motor_alone_tells_which_propeller_is_fouled() -> None:
    """Both motors at a similar command, against gusts and current: 15.6 s without a comparison."""
    run, _ = sail(
        "straight", "environment.current_m_s=0.85", "environment.current_to_deg=225",
        "environment.wind_m_s=3.74", "environment.gust_m_s=10.98", "environment.wind_from_deg=279.9",
        "hull.mass_kg=7.97", "hull.inertia_kg_m2=0.8", "hull.surge_linear=0.331",
        "hull.surge_quadratic=0.578", "hull.sway_linear=3.82", "hull.sway_quadratic=25.9",
        "hull.yaw_linear=0.204",
        "hull.skeg_lift_kg_m=6.9", "thrusters.propeller.diameter_m=0.0302", "thrusters.motor.no_load_a=0.248",
        "sensors.gnss.rate_hz=1", 'faults=[{what="motor_right", kind="weed", at_s=37.0}]', "seed=3",
        timeout_s=46.0,
    )  # fmt: skip
    figures = motor_figures(run)
    assert "Motors draw more current: comparing them" in said(run)
    assert (figures["motor_alarms"], figures["motor_named"]) == (0, 1), said(run)


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
    fault = f'faults=[{{what="{what}", kind="{kind}", at_s=25.0}}]'
    run, _ = sail("straight", *CURRENT, *GUSTS, fault, "seed=3", timeout_s=37.0)
    figures = motor_figures(run)
    assert text in said(run)
    assert (figures["motor_alarms"], figures["motor_named"]) == (0, 1), said(run)
