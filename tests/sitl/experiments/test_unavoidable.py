"""Which touches nobody could have avoided."""

import dataclasses

import numpy as np
import pytest
from boat_rig import scenario
from numpy.typing import NDArray

from sitl.experiments.campaign.unavoidable import has_way_clear, remaining_speed_m_s, unavoidable_cause
from sitl.run.mission_run import MissionRun
from sitl.world.faults.catalogue import FaultSetting
from sitl.world.scenario import Scenario
from sitl.world.truth import Truth

DEAD = FaultSetting(what="motor_left", at_s=10.0)
WATER = [[-100.0, -100.0], [100.0, -100.0], [100.0, 100.0], [-100.0, 100.0]]


def water(*islands: list[list[float]]) -> Scenario:
    things = ", ".join(f'{{name = "{n}", kind = "island", polygon = {at}}}' for n, at in enumerate(islands))
    return scenario("random", f"map.water={WATER}", f"map.obstacles=[{things}]", "route.start=[0.0, -50.0]")


Rows = NDArray[np.float64]
STILL = Truth(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, False)


def drift(current_m_s: float, seconds: float, north_m: float = 0.0) -> Rows:
    """A boat that is carried north from 10 s on, one row a tenth of a second."""
    rows = []
    for n in range(round(seconds / 0.1)):
        at_s = 0.1 * n
        north = north_m + current_m_s * at_s
        truth = STILL._replace(
            time_s=10.0 + at_s,
            north_m=north,
            north_m_s=current_m_s,
            current_north_m_s=current_m_s,
            wind_north_m_s=current_m_s,
        )
        rows.append(tuple(map(float, truth)))
    return np.array(rows)


ROCK = [[-3.0, 60.0], [3.0, 60.0], [3.0, 64.0], [-3.0, 64.0]]
BAR = [[-99.0, 60.0], [99.0, 60.0], [99.0, 64.0], [-99.0, 64.0]]


@pytest.mark.parametrize(
    ("current_m_s", "island", "is_avoidable"),
    [
        (0.4, ROCK, True),  # aside
        (0.8, BAR, False),
        (0.2, BAR, True),  # one motor is faster
    ],
)
def test_one_motor_gets_round_a_rock_but_not_off_a_lee_shore(
    current_m_s: float, island: list[list[float]], is_avoidable: bool
) -> None:
    rows = drift(current_m_s, 60.0 / current_m_s + 2.0)
    place, until_s = water(island), float(rows[-1, 0])
    speed_m_s = remaining_speed_m_s(DEAD, place)
    assert 0.2 < speed_m_s < 0.8
    assert has_way_clear(place, rows, DEAD, speed_m_s, until_s) is is_avoidable


def test_without_power_the_boat_goes_where_it_went_and_after_that_where_it_likes() -> None:
    place = water(ROCK)
    rows = drift(1.0, 60.0)
    short, long = (FaultSetting(what="computer", at_s=10.0, for_s=for_s) for for_s in (20.0, 50.0))
    assert has_way_clear(place, rows, short, 0.0, float(rows[-1, 0]))
    assert not has_way_clear(place, rows, long, 0.0, float(rows[-1, 0]))


@pytest.mark.parametrize(
    ("kind", "size", "is_whole"),
    [
        ("off", None, False),
        ("weed", 0.2, True),
        ("wrong", None, True),
    ],
)
def test_only_a_motor_without_thrust_counts_as_none(kind: str, size: float | None, is_whole: bool) -> None:
    place = water(ROCK)
    speed_m_s = remaining_speed_m_s(FaultSetting(what="motor_right", kind=kind, size=size), place)
    whole_m_s = remaining_speed_m_s(FaultSetting(what="gyro"), place)
    assert (speed_m_s == whole_m_s) is is_whole


@pytest.mark.parametrize(("at_s", "is_inevitable"), [(52.0, True), (25.0, False)])
def test_who_touches_before_a_reversed_motor_can_be_recognised_had_no_time(
    at_s: float, is_inevitable: bool
) -> None:
    fault = FaultSetting(what="motor_left", kind="wrong", at_s=at_s)
    mission_run = MissionRun(dataclasses.replace(water(BAR), faults=(fault,)), [])
    aground = STILL._replace(time_s=60.0, grounded=True)
    mission_run.recorder.record(aground)
    assert (
        unavoidable_cause(mission_run) == f"no time: {60.0 - at_s:.0f} s after the fault"
    ) is is_inevitable
