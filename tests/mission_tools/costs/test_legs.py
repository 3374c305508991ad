"""Legs in a tide, against the integral worked out by hand and an independent integrator."""

import math
from dataclasses import dataclass

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from companion.core.geo import Point
from mission_tools.costs.departure import KnownTimes
from mission_tools.costs.legs import leg_costs, route_cost, route_costs
from mission_tools.costs.travel import BoatSpeed, Charge, Floats, InZones, OpenWater, TravelTime

PERIOD_S = 7200.0
HERE, THERE = Point(0.0, 0.0), Point(0.0, 3000.0)


@dataclass(frozen=True)
class Tide:
    """Along east, to and fro: strongest to the east at 0."""

    speed_m_s: float = 0.8
    times: KnownTimes = KnownTimes()  # noqa: RUF009 - a value

    def at(self, north_m: Floats, east_m: Floats, time_s: Floats) -> tuple[Floats, Floats]:
        east_m_s = self.speed_m_s * np.cos(2.0 * math.pi * time_s / PERIOD_S) + 0.0 * (north_m + east_m)
        return np.zeros_like(east_m_s), east_m_s


def full_speed(top_m_s: float, tide: Tide) -> TravelTime:
    """A boat that always sails as fast as it can."""
    return TravelTime(BoatSpeed(top_m_s, top_m_s, keep_m_s=top_m_s), tide)


@pytest.mark.parametrize("depart_s", [0.0, 1000.0, 3600.0])
def test_a_leg_with_the_tide_takes_as_long_as_the_integral_says(depart_s: float) -> None:
    travel = full_speed(1.2, Tide())
    taken_s = float(leg_costs(travel, [HERE], [THERE], 10.0, depart_s)[0][0])
    rate = 2.0 * math.pi / PERIOD_S
    drift_m = 0.8 / rate * (math.sin(rate * (depart_s + taken_s)) - math.sin(rate * depart_s))
    assert 1.2 * taken_s + drift_m == pytest.approx(3000.0, rel=1e-4)


def test_a_leg_across_is_that_of_an_independent_integrator() -> None:
    speed, tide, end = BoatSpeed(1.0, 1.3), Tide(1.0), Point(2000.0, 900.0)
    course = np.array([math.atan2(end.east_m, end.north_m)])

    def rate(time_s: float, _: Floats) -> Floats:
        east = 1.0 * math.cos(2.0 * math.pi * time_s / PERIOD_S)
        return speed.made_good_m_s(east * np.sin(course), east * np.cos(course), course)

    def left(_: float, along: Floats) -> float:
        return float(along[0]) - math.hypot(*end)

    left.terminal = True  # type: ignore[attr-defined]
    expected = solve_ivp(rate, (500.0, 20000.0), [0.0], events=left, rtol=1e-9, max_step=5.0).t_events[0][0]
    taken_s = leg_costs(TravelTime(speed, tide), [HERE], [end], 5.0, 500.0)[0][0]
    assert 500.0 + taken_s == pytest.approx(expected, abs=0.5)


def test_who_leaves_later_does_not_arrive_earlier() -> None:
    depart_s = np.linspace(0.0, 2.0 * PERIOD_S, 200)
    travel = TravelTime(BoatSpeed(1.0, 1.2), Tide(0.9))
    _, passed_s = route_costs(travel, (HERE, Point(500.0, 500.0), THERE), 5.0, depart_s)
    assert (np.diff(passed_s, axis=1) > 0.0).all()
    assert (np.diff(passed_s, axis=0) > 0.0).all()


def test_a_leg_that_meets_too_strong_a_tide_cannot_be_sailed_and_others_beside_it_can() -> None:
    travel = TravelTime(BoatSpeed(0.6, 0.7), Tide(0.8))
    cost, _ = leg_costs(travel, [THERE], [HERE], 10.0, np.array([0.0, 2200.0]))
    assert math.isinf(cost[0])
    assert cost[1] == pytest.approx(3000.0 / 0.6, rel=0.3)


def test_holds_let_the_tide_go_on() -> None:
    travel, at_s = full_speed(1.2, Tide()), np.zeros(1)
    plain, _ = route_costs(travel, (HERE, Point(0.0, 500.0), THERE), 10.0, at_s)
    held, passed_s = route_costs(travel, (HERE, Point(0.0, 500.0), THERE), 10.0, at_s, (0.0, 1800.0, 0.0))
    assert held[0] > plain[0] + 300.0
    assert passed_s[-1, 0] == pytest.approx(held[0] + 1800.0, abs=0.5)


def test_a_charge_is_counted_at_the_times_of_the_way() -> None:
    speed, tide = BoatSpeed(1.0, 1.5), Tide(0.4)
    travel = Charge(speed, lambda through: 1.0 + 0.0 * through, tide)
    cost, seconds = leg_costs(travel, [HERE], [THERE], 10.0, 900.0)
    assert cost[0] == pytest.approx(seconds[0] / 3.6, rel=1e-3)
    assert seconds[0] == pytest.approx(leg_costs(travel.pace, [HERE], [THERE], 10.0, 900.0)[0][0])


def test_what_is_made_of_a_travel_has_its_pace() -> None:
    time = TravelTime(BoatSpeed(1.0, 1.5), Tide())
    charge = Charge(time.speed, lambda through: through, time.current)
    zones = InZones(charge, ())
    assert InZones(time, ()).pace == InZones(time, ())
    assert zones.pace == InZones(time, ())
    assert OpenWater(zones, lambda n, e: n, 1.0, 1.0).pace == zones.pace
    assert zones.varies
    assert not TravelTime(time.speed).varies


def test_a_leg_of_no_length_costs_nothing_in_a_tide_too() -> None:
    costs = leg_costs(TravelTime(BoatSpeed(1.0, 1.2), Tide()), [HERE, HERE], [HERE, THERE], 10.0, 50.0)
    assert [part[0] for part in costs] == [0.0, 0.0]
    assert costs[0][1] > 2000.0


def test_a_travel_that_does_not_change_costs_the_same_whenever_it_begins() -> None:
    travel = TravelTime(BoatSpeed(1.0, 1.5))
    assert route_cost(travel, (HERE, THERE), 10.0, 1e9) == route_cost(travel, (HERE, THERE), 10.0) == 3000.0
