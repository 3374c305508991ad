"""Contacts that no boat could have avoided, judged by thrust, current and shore, not by the boat's steering.

From the fault on, a grid holds every position that the hull could have reached without a contact, at the
speed through the water that the fault leaves, carried by the current and the leeway of the run's weather. If
any position is left HORIZON_S after the contact, or when the fault ends, a perfect controller would have kept
clear, and the contact was avoidable. That controller knows chart and weather, and the fault after
_RECOGNISED_S; until then it follows the boat. In doubt a contact counts as avoidable.

Without power no speed is left; with one motor dead, the best speed found for this hull;
otherwise its top speed. With a motor dead or reversed, a contact before _RECOGNISED_S was unavoidable.
"""

import math
from functools import cache
from itertools import product
from typing import Final

import numpy as np
import shapely
from numpy.typing import NDArray

from sitl.run.mission_run import MissionRun
from sitl.world.drive.settings import ThrusterSettings
from sitl.world.drive.thruster import Thrusters
from sitl.world.faults.catalogue import FaultSetting
from sitl.world.hull import Hull
from sitl.world.hull_settings import HullSettings
from sitl.world.pack import Pack
from sitl.world.scenario import Scenario
from sitl.world.truth import Truth
from sitl.world.windage import AIR_KG_M3

CELL_M: Final = 0.5
STEP_S: Final = 0.5
HORIZON_S: Final = 600.0
_COAST_M: Final = 2.0  # what way the boat has may carry it so far, any way it likes
_RECOGNISED_S: Final = 15.0  # six of steering that turns nothing, six of trying the motors, and the bow round
# Until power that is back drives the boat: boot, a warning to keep clear, gathering way
_RESTART_S: Final = 16.0
_STALLED: Final = 0.4  # of weed, and more, hold a motor fast
_MOTORS: Final = ("motor_left", "motor_right")
_TREACHEROUS: Final = ("off", "stuck", "wrong")  # the boat steers otherwise than it means to

Mask = NDArray[np.bool_]
Rows = NDArray[np.float64]


def unavoidable_cause(mission_run: MissionRun) -> str:
    """Why the run's first touch could not be helped, in words; "" if it could, or if there was none."""
    scenario, rows = mission_run.scenario, mission_run.recorder.rows
    aground = rows[:, Truth._fields.index("grounded")] > 0.0
    if len(scenario.faults) != 1 or not aground.any():
        return ""
    fault, row = scenario.faults[0], rows[int(aground.argmax())]
    touch_s = float(row[0])
    if touch_s < fault.at_s:
        return ""
    after_s = touch_s - fault.at_s
    if fault.what in _MOTORS and fault.kind in _TREACHEROUS and after_s < _RECOGNISED_S:
        return f"no time: {after_s:.0f} s after the fault"
    speed_m_s = remaining_speed_m_s(fault, scenario)
    if not speed_m_s < _top_speed_m_s(scenario):
        return ""
    if has_way_clear(scenario, rows, fault, speed_m_s, touch_s):
        return ""
    what = "no power" if speed_m_s == 0.0 else f"one motor: {speed_m_s:.2f} m/s"
    return f"{what}, in a current of {math.hypot(*_current_m_s(scenario, row)):.2f} m/s"


def remaining_speed_m_s(fault: FaultSetting, scenario: Scenario) -> float:
    """Speed through the water that a fault leaves."""
    if fault.what == "computer":
        return 0.0
    is_dead = fault.what in _MOTORS and (
        fault.kind == "off"
        or (fault.kind == "slow" and fault.amount == 0.0)
        or (fault.kind in ("stuck", "weed") and fault.amount >= _STALLED)
    )
    if is_dead:
        return one_motor_speed_m_s(scenario.hull, scenario.thrusters, Pack(scenario.battery).supply_v)
    return _top_speed_m_s(scenario)


def _top_speed_m_s(scenario: Scenario) -> float:
    return top_speed_m_s(scenario.hull, scenario.thrusters, Pack(scenario.battery).supply_v)


def has_way_clear(
    scenario: Scenario, rows: Rows, fault: FaultSetting, speed_m_s: float, until_s: float
) -> bool:
    """Whether some path stays clear until HORIZON_S after the contact at until_s."""
    if speed_m_s == 0.0:  # without power there is one way only, and that is the one that it went
        return until_s > fault.ends_s + _RESTART_S
    since = rows[(rows[:, 0] >= fault.at_s + _RECOGNISED_S) & (rows[:, 0] <= until_s)]
    if not len(since):
        return False
    place = slice(Truth._fields.index("north_m"), Truth._fields.index("east_m") + 1)
    reach = _ReachableSet(scenario.chart.navigable.buffer(-0.5 * scenario.hull.beam_m), since[0, place])
    over_s, at_s = fault.ends_s, float(since[0, 0])
    every = max(1, round(STEP_S / (since[1, 0] - since[0, 0]))) if len(since) > 1 else 1
    north_m_s = east_m_s = 0.0
    for row in since[::every]:
        current_m_s = _current_m_s(scenario, row)
        north_m_s, east_m_s = north_m_s + current_m_s[0], east_m_s + current_m_s[1]
        reach.advance(current_m_s, speed_m_s, float(row[0]) - at_s)
        at_s = float(row[0])
        if at_s >= over_s or not reach.is_left:
            return reach.is_left
    count = len(since[::every])
    mean_m_s = north_m_s / count, east_m_s / count
    ends_s = min(until_s + HORIZON_S, over_s)
    while at_s < ends_s and reach.is_left:
        reach.advance(mean_m_s, speed_m_s, STEP_S)
        at_s += STEP_S
    return reach.is_left


def _current_m_s(scenario: Scenario, row: Rows) -> tuple[float, float]:
    """North and east: the current plus the leeway of a hull beam on to the wind."""
    current = row[Truth._fields.index("current_north_m_s")], row[Truth._fields.index("current_east_m_s")]
    wind = row[Truth._fields.index("wind_north_m_s")], row[Truth._fields.index("wind_east_m_s")]
    past = wind[0] - current[0], wind[1] - current[1]
    fast = math.hypot(*past)
    hull, windage = scenario.hull, scenario.hull.windage
    push_n = 0.5 * AIR_KG_M3 * windage.lateral_drag * windage.lateral_area_m2 * fast * fast
    a, b = hull.sway_quadratic, hull.sway_linear
    if a > 0.0:
        leeway_m_s = (-b + math.sqrt(b * b + 4.0 * a * push_n)) / (2.0 * a)
    else:
        leeway_m_s = push_n / b if b > 0.0 else 0.0
    share = leeway_m_s / fast if fast > 0.0 else 0.0
    return float(current[0] + share * past[0]), float(current[1] + share * past[1])


class _ReachableSet:
    """The reachable positions, as a mask on the grid that drifts with the current.

    The grid's first row and column are never free, so nothing comes round its edges.
    """

    def __init__(self, water: shapely.Geometry, at: Rows) -> None:
        west, south, east, north = water.bounds
        norths = np.arange(south, north + CELL_M, CELL_M)
        grid_e, grid_n = np.meshgrid(np.arange(west, east + CELL_M, CELL_M), norths)
        shapely.prepare(water)
        self._free: Mask = shapely.contains_xy(water, grid_e, grid_n)
        away = np.hypot(grid_n - at[0], grid_e - at[1])
        self._mask: Mask = (away <= _COAST_M) & self._free
        self._drift_m = [0.0, 0.0]  # not yet taken, less than a cell
        self._grow_m = 0.0
        self._is_square = False  # by turns a square and its diamond make an octagon, nearly a circle

    @property
    def is_left(self) -> bool:
        """Whether any position is left."""
        return bool(self._mask.any())

    def advance(self, current_m_s: tuple[float, float], speed_m_s: float, dt_s: float) -> None:
        """Advance by dt_s: drift with the current, cell by cell, and spread by the boat's own speed."""
        for axis, speed in enumerate(current_m_s):
            self._drift_m[axis] += speed * dt_s
            while abs(self._drift_m[axis]) >= 0.5 * CELL_M:
                step = 1 if self._drift_m[axis] > 0.0 else -1
                self._drift_m[axis] -= step * CELL_M
                self._mask = np.roll(self._mask, step, axis) & self._free
        self._grow_m += speed_m_s * dt_s
        while self._grow_m >= CELL_M:
            self._grow_m -= CELL_M
            mask = self._mask
            grown = mask | np.roll(mask, 1, 0) | np.roll(mask, -1, 0)
            base = grown if self._is_square else mask
            self._mask = (grown | np.roll(base, 1, 1) | np.roll(base, -1, 1)) & self._free
            self._is_square = not self._is_square


_DT_S: Final = 0.05
_SETTLE_S: Final = 30.0
_MEASURE_S: Final = 60.0
_SWINGS_RAD: Final = (0.2, 0.5, 0.8, 1.2, 1.6, 2.2)


@cache
def top_speed_m_s(hull: HullSettings, drive: ThrusterSettings, supply_v: float) -> float:
    """With both motors, by simulation in calm water."""
    body, thrusters = Hull(hull), Thrusters(drive)
    for _ in range(round(_MEASURE_S / _DT_S)):
        force_n, moment_nm = thrusters.step(1.0, 1.0, supply_v, body.surge_m_s, 0.0, _DT_S)
        body.step(force_n, 0.0, moment_nm, 0.0, 0.0, _DT_S)
    return body.surge_m_s


@cache
def one_motor_speed_m_s(hull: HullSettings, drive: ThrusterSettings, supply_v: float) -> float:
    """Made good with one motor dead, by the best way found.

    One motor turns the boat. Each strategy drives it full ahead until the heading has swung past one angle,
    then astern until it has swung back past another. The best pair of angles counts.
    """
    return max(_made_good_m_s(hull, drive, supply_v, *swings) for swings in product(_SWINGS_RAD, repeat=2))


def _made_good_m_s(
    hull: HullSettings, drive: ThrusterSettings, supply_v: float, past_rad: float, back_rad: float
) -> float:
    body, thrusters, ahead = Hull(hull), Thrusters(drive), True
    from_n = from_e = 0.0
    begins = round(_SETTLE_S / _DT_S)
    for step in range(begins + round(_MEASURE_S / _DT_S)):
        if step == begins:
            from_n, from_e = body.north_m, body.east_m
        if ahead and body.heading_rad > past_rad:
            ahead = False
        elif not ahead and body.heading_rad < -back_rad:
            ahead = True
        force_n, moment_nm = thrusters.step(
            1.0 if ahead else -1.0, 0.0, supply_v, body.surge_m_s, body.yaw_rate_rad_s, _DT_S
        )
        body.step(force_n, 0.0, moment_nm, 0.0, 0.0, _DT_S)
    return math.hypot(body.north_m - from_n, body.east_m - from_e) / _MEASURE_S
