"""Whether any simple manoeuvre keeps clear of a mover after the sonar could first detect it.

From the moment at which the mover first comes within the ranger's range and field, each of a handful of
manoeuvres is tried with the same hull and motors: both motors held at one pair of commands for a while, then
at another. If none of them keeps clear, the touch counts as inevitable for a boat that came at that speed.
Doubts go against the boat: no ping need have been sent that way yet, and pack and wind are at their best.
"""

import math
from itertools import product
from typing import Final

from companion.boat import TICK_S
from companion.core.units import wrap_pi
from sitl.run.recorder import Rows
from sitl.scenarios.scenario import Scenario
from sitl.world.drive.thruster import Thrusters
from sitl.world.hull import Hull
from sitl.world.movers import Movers
from sitl.world.world import Truth

Pair = tuple[float, float]

_REACTION_S: Final = 0.3  # two pings on it, and a decision
_FIRST: Final[tuple[Pair, ...]] = (
    (1.0, 1.0), (-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 0.0), (0.0, 1.0), (1.0, 0.4), (0.4, 1.0),
)  # fmt: skip
_THEN: Final[tuple[Pair, ...]] = ((1.0, 1.0), (-1.0, -1.0))
_SWITCHES_S: Final = (0.4, 0.8, 1.2, 1.8)
_WATCHED_S: Final = 8.0
_WARM_S: Final = 0.4  # until the motors turn as they did


def could_evade(scenario: Scenario, rows: Rows) -> bool:
    """Whether some manoeuvre after the first possible echo keeps clear of the movers for _WATCHED_S.

    rows: the truth of every tick of a run with a touch, up to it at least.
    """
    movers = Movers(scenario.movers)
    grounded = rows[:, Truth._fields.index("grounded")] > 0.0
    truths = [Truth(*row) for row in rows[: int(grounded.argmax())].tolist()]
    heard_s = next((truth.time_s for truth in truths if _detects(scenario, movers, truth)), math.inf)
    acts = next((truth for truth in truths if truth.time_s >= heard_s + _REACTION_S), None)
    if acts is None:
        return False
    return any(
        _keeps_clear(scenario, movers, acts, first, switch_s, then)
        for first, switch_s, then in product(_FIRST, _SWITCHES_S, _THEN)
    )


def _detects(scenario: Scenario, movers: Movers, truth: Truth) -> bool:
    """Whether a ping straight at some mover would be answered."""
    sonar = scenario.sensors.sonar
    for east_m, north_m, radius_m in movers.positions_m(truth.time_s):
        north, east = north_m - truth.north_m, east_m - truth.east_m
        off_bow = abs(wrap_pi(math.atan2(east, north) - truth.heading_rad))
        is_in_range = math.hypot(north, east) - radius_m < sonar.max_range_m
        if is_in_range and off_bow < math.radians(0.5 * sonar.sweep_deg):
            return True
    return False


def _keeps_clear(
    scenario: Scenario, movers: Movers, at: Truth, first: Pair, switch_s: float, then: Pair
) -> bool:
    hull, thrusters = (
        Hull(scenario.hull, at.north_m, at.east_m, at.heading_rad),
        Thrusters(scenario.thrusters),
    )
    hull.move(at.surge_m_s, at.sway_m_s, at.yaw_rate_rad_s)
    for _ in range(round(_WARM_S / TICK_S)):
        thrusters.step(
            at.left_command, at.right_command, at.voltage_v, at.surge_m_s, at.yaw_rate_rad_s, TICK_S
        )
    outline = _outline(scenario.hull.length_m, scenario.hull.beam_m)
    for tick in range(1, round(_WATCHED_S / TICK_S) + 1):
        left, right = first if tick * TICK_S <= switch_s else then
        surge_n, yaw_nm = thrusters.step(
            left, right, at.voltage_v, hull.surge_m_s, hull.yaw_rate_rad_s, TICK_S
        )
        hull.step(surge_n, 0.0, yaw_nm, at.current_north_m_s, at.current_east_m_s, TICK_S)
        time_s = at.time_s + tick * TICK_S
        if movers.gap_m(hull.east_m, hull.north_m, time_s) > scenario.hull.length_m:
            continue
        for ahead_m, aside_m in outline:
            east_m = hull.east_m + ahead_m * hull.sin + aside_m * hull.cos
            north_m = hull.north_m + ahead_m * hull.cos - aside_m * hull.sin
            if movers.gap_m(east_m, north_m, time_s) <= 0.0:
                return False
    return True


def _outline(length_m: float, beam_m: float) -> tuple[Pair, ...]:
    """Places along the hull's side, ahead of and to starboard of its middle."""
    half, side = 0.5 * length_m, 0.5 * beam_m
    sides = [(share * half, sign * side) for share in (-1.0, -0.5, 0.0, 0.4) for sign in (-1.0, 1.0)]
    return ((half, 0.0), (-half, 0.0), *sides)
