"""The AIS receiver of the emulator: what movers with a transponder report."""

import math

import pytest
from boat_rig import scenario

from companion.core.readings import AisVessel
from companion.core.units import KNOT_M_S
from sitl.world.scenario import Scenario
from sitl.world.world import World

MOVERS = (
    "movers=[{start=[-50.0, 30.0], velocity_m_s=[3.0, 4.0], radius_m=2.5, ais='A'}, "
    "{start=[0.0, 80.0], ais='B'}, {start=[9.0, 9.0]}]"
)
FITTED = ("sensors.ais.fitted=true", "sensors.ais.noise_m=0.0", "sensors.ais.lost_share=0.0", MOVERS)


def heard(of: Scenario, seconds: float) -> list[tuple[float, AisVessel]]:
    """Each new report, with its time."""
    world, found, last = World(of), list[tuple[float, AisVessel]](), dict[int, float]()
    ais = world.hardware.ais
    assert ais is not None
    while world.time_s < seconds:
        world.step(0.02)
        for one in () if (reading := ais.read()) is None else reading.vessels:
            if last.get(one.mmsi) != one.time_s:
                last[one.mmsi] = one.time_s
                found.append((world.time_s, one))
    return found


def test_movers_report_their_place_course_speed_and_size_at_their_intervals() -> None:
    of = scenario("open", *FITTED)
    reports = heard(of, 70.0)
    ships = [(time_s, one) for time_s, one in reports if one.mmsi == 235_000_001]
    assert [time_s for time_s, _ in ships] == pytest.approx(
        [ships[0][0] + 10.0 * n for n in range(7)], abs=0.05
    )
    for time_s, one in ships:
        at = of.frame.to_local(one.position)
        assert at == pytest.approx((30.0 + 4.0 * time_s, -50.0 + 3.0 * time_s), abs=0.5)
        assert one.speed_m_s == pytest.approx(5.0, abs=0.1 * KNOT_M_S)
        assert one.course_rad == pytest.approx(math.atan2(3.0, 4.0), abs=0.002)
        assert (one.bow_m, one.stern_m, one.port_m, one.starboard_m) == (3, 3, 3, 3)
    assert {one.name for _, one in ships} == {"MOVER 1"}
    others = [one for _, one in reports if one.mmsi != 235_000_001]
    assert {(one.mmsi, one.is_class_b) for one in others} == {(235_000_002, True)}
    assert len(others) in (2, 3)


def test_reports_are_lost_and_off_by_the_settings() -> None:
    lossy = ("sensors.ais.lost_share=0.5", "sensors.ais.noise_m=3.0")
    reports = heard(scenario("open", *FITTED, *lossy), 400.0)
    ships = [(time_s, one) for time_s, one in reports if one.mmsi == 235_000_001]
    assert 12 <= len(ships) <= 28
    of, errors_m = scenario("open", *FITTED), []
    for time_s, one in ships:
        errors_m.append(of.frame.to_local(one.position).north_m - 30.0 - 4.0 * time_s)
    assert 1.5 < math.sqrt(sum(error * error for error in errors_m) / len(errors_m)) < 4.5


def test_no_receiver_is_fitted_unless_asked_for() -> None:
    assert World(scenario("open", MOVERS)).hardware.ais is None
