"""Emulated speed controllers that report, against the truth of the drive."""

import math

import pytest

from companion.core.readings import EscReading
from sitl.scenarios.scenario import load_scenario
from sitl.world.world import World

CATAMARAN = ("boat.model='catamaran'", "vehicle.parts.motors={telemetry='kiss', pole_pairs=7}")


def driven(left: float, right: float, seconds: float = 5.0) -> tuple[World, list[EscReading]]:
    world = World(load_scenario("open", CATAMARAN))
    reports: dict[tuple[int, float], EscReading] = {}
    for _ in range(round(seconds / 0.02)):
        world.hardware.motors.write(left, right)
        world.step(0.02)
        reports |= {(one.side, one.time_s): one for line in world.hardware.escs for one in line.read() or ()}
    return world, list(reports.values())


def test_both_report_thirty_times_a_second_what_they_draw_of_the_packs_power() -> None:
    world, reports = driven(0.8, 0.4)
    assert len(reports) == pytest.approx(2 * 5 * 30, abs=4)
    late = [[one for one in reports if one.side == side and one.time_s > 4.0] for side in (0, 1)]
    currents = [sum(one.current_a for one in of_side) / len(of_side) for of_side in late]
    idle_a = world.scenario.battery.idle_a
    assert sum(currents) + idle_a == pytest.approx(world.truth.current_a, abs=0.15)
    assert currents[0] > 3.0 * currents[1]
    assert late[0][-1].shaft_rad_s > 1.5 * late[1][-1].shaft_rad_s
    assert late[0][-1].consumed_mah == pytest.approx(currents[0] * 5.0 / 3.6, rel=0.1)


def test_the_speed_is_a_size_in_steps_of_a_hundred_electrical_turns() -> None:
    _, reports = driven(-0.8, -0.8, 2.0)
    step_rad_s = 100.0 / 7.0 / 60.0 * math.tau
    for one in reports:
        assert one.shaft_rad_s >= 0.0
        steps = one.shaft_rad_s / step_rad_s
        assert steps == pytest.approx(round(steps))


def test_a_boat_that_does_not_ask_for_reports_has_none() -> None:
    assert not World(load_scenario("open", CATAMARAN[:1])).hardware.escs
