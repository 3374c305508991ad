"""Is the filter as certain as it may be? NEES against the truth and NIS of its sensors over many random runs.

The normalised estimation error squared (NEES) of n states, eᵀ P⁻¹ e, has the mean n if the covariance P is
right; so has the normalised innovation squared (NIS) of n measurements. The average over N independent runs
lies with 95 % probability between the 2.5 % and 97.5 % points of χ² with N n degrees of freedom, divided by N
(Y. Bar-Shalom, X. R. Li, T. Kirubarajan, *Estimation with Applications to Tracking and Navigation*, 2001,
section 5.4). Above the bounds the filter is over-confident, below them too cautious.

The runs draw what the filter cannot know from what its settings assume: the compass offset, the gyro's bias
and the current. The receivers are those of the emulator (`sitl.world.sensors.receivers`), of which the filter
knows what they state. The truth of the current is known in still air only: wind adds leeway. A helm that sees
the truth sails each run, turning and changing speed: a run costs little and does not depend on the estimator.
"""

import math
import random
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from companion.boat import TICK_S
from companion.core.state import STOPPED, MotorCommand
from companion.core.units import clamp, wrap_pi
from companion.estimation.estimator import Estimator, EstimatorReport
from sitl.scenarios.layers import Layer
from sitl.scenarios.scenario import load_scenario
from sitl.world.scenario import Scenario
from sitl.world.truth import Truth
from sitl.world.world import World

GROUPS: Final = {"position": 2, "heading": 1, "velocity": 2, "current": 2}  # and their degrees of freedom
SENSORS: Final = {"position": 2, "velocity": 2, "compass": 1, "gyro": 1}
SETTLED_S: Final = 20.0  # after boot
ROW_HZ: Final = 10.0  # of recorded truths and estimates
LENGTH_S: Final = 100.0  # of a run
REST_S: Final = 8.0  # at its start
LEG_S: Final = 15.0
_Z: Final = 1.959964  # 97.5 % point of the normal distribution
RECEIVERS: Final = ("standalone", "sbas", "rtk")
_OFFSET_DEG: Final = 2.0  # compass_doubt_rad
_BIAS_DEG_S: Final = 0.5  # of a MEMS gyro that was calibrated at rest
NAV: Final = (
    "north_m", "east_m", "heading_rad", "north_m_s", "east_m_s", "current_north_m_s", "current_east_m_s",
)  # fmt: skip
CHANNELS: Final = (
    "position_north", "position_east", "velocity_north", "velocity_east", "compass", "gyro",
)  # fmt: skip

Numbers = NDArray[np.float64]


class Sailed(NamedTuple):
    """A run, a row every tenth of a second; NaN before the first estimate.

    truth: fields of Truth. nav: fields NAV of the estimate, in the truth's frame. innovations: of CHANNELS,
    time, value and variance each.
    """

    truth: Numbers
    nav: Numbers
    state: Numbers
    covariance: Numbers
    innovations: Numbers
    is_still_air: bool


def draw(seed: int, hull: str, receiver: str) -> Scenario:
    """A random run. hull: known, or other: its figures within ±30 %. Every second run is in still air.

    receiver: one of RECEIVERS.
    """
    numbers = random.Random(f"{seed} {hull} {receiver}")
    wind_m_s = 4.0 * (seed % 2)
    settings: dict[str, Any] = {
        "environment": {
            "current_m_s": numbers.uniform(0.0, 0.7),
            "current_to_deg": numbers.uniform(0.0, 360.0),
            "wind_m_s": wind_m_s,
            "gust_m_s": 1.7 * wind_m_s,
            "wind_from_deg": numbers.uniform(0.0, 360.0),
        },
        "sensors": {
            "compass": {
                "bias_deg": numbers.gauss(0.0, _OFFSET_DEG),
                "gyro_bias_deg_s": numbers.gauss(0.0, _BIAS_DEG_S),
            },
            "gnss": {"receiver": receiver},
        },
    }
    if hull == "other":

        def off(nominal: float) -> float:
            return nominal * numbers.uniform(0.7, 1.3)

        drag, power = off(1.0), off(1.0)
        settings["hull"] = {
            "mass_kg": off(8.0), "inertia_kg_m2": off(0.75), "skeg_lift_kg_m": off(9.0),
            "surge_linear": 0.4 * drag, "surge_quadratic": 0.6 * drag,
        }  # fmt: skip
        settings["thrusters"] = {
            "propeller": {"thrust_coefficient": 0.31 * power, "torque_coefficient": 0.06 * power},
            "motor": {"no_load_a": off(0.3)},
        }
    return load_scenario("open", over=(Layer("consistency", {**settings, "seed": seed}),))


def sail(scenario: Scenario, length_s: float = LENGTH_S) -> Sailed:
    """Rest, then sail with a new course and throttle every LEG_S, steered by the truth, and estimate."""
    world, command, boat = World(scenario), STOPPED, scenario.vehicle
    hardware, numbers = world.hardware, random.Random(f"legs {scenario.seed}")
    estimator = Estimator(boat.speed, boat.estimation, boat.drive)
    heading_rad, throttle, leg_ends_s = 0.0, 0.0, REST_S
    truths, navs = list[Truth](), list[Sequence[float]]()
    reports: list[EstimatorReport | None] = []
    for tick in range(round(length_s / TICK_S)):
        truth, now_s = world.truth, world.time_s
        nav = estimator.update(hardware.gnss.read(), hardware.compass.read(), now_s, command)
        if tick % round(1.0 / ROW_HZ / TICK_S) == 0:
            row = [math.nan] * len(NAV)
            if nav is not None and estimator.frame is not None:
                shift = scenario.frame.to_local(estimator.frame.origin)
                row = [float(getattr(nav, name)) for name in NAV]
                row[0], row[1] = row[0] + shift.north_m, row[1] + shift.east_m
            truths.append(truth)
            navs.append(row)
            reports.append(estimator.report)
        if now_s >= leg_ends_s:
            leg_ends_s += LEG_S
            heading_rad += numbers.uniform(-2.0, 2.0)
            throttle = numbers.uniform(0.3, 0.8)
        if now_s >= REST_S:
            turn = 0.5 * wrap_pi(heading_rad - truth.heading_rad) - 0.3 * truth.yaw_rate_rad_s
            turn = clamp(turn, -0.3, 0.3)
            command = MotorCommand(min(throttle + turn, 1.0), min(throttle - turn, 1.0))
        hardware.motors.write(command.left, command.right)
        world.step(TICK_S)
    is_still_air = scenario.environment.wind_m_s == 0.0
    return Sailed(np.array(truths), np.array(navs), *_inside(reports), is_still_air)


def _inside(reports: Sequence[EstimatorReport | None]) -> tuple[Numbers, Numbers, Numbers]:
    """State, covariance and innovations of each report."""
    states = len(next(one.state for one in reports if one is not None))
    unknown = np.full((states, states), math.nan)
    silent = [(math.nan,) * 3] * len(CHANNELS)
    innovations = [
        silent if one is None else [
            (each.time_s, each.value, each.variance) for each in (getattr(one, name) for name in CHANNELS)
        ]
        for one in reports
    ]  # fmt: skip
    return (
        np.array([unknown[0] if one is None else one.state for one in reports]),
        np.array([unknown if one is None else one.covariance for one in reports]),
        np.array(innovations),
    )


def nees(run: Sailed) -> dict[str, Numbers]:
    """The NEES of each group, row by row (tenths of a second); NaN where it is not known."""

    def off(name: str) -> Numbers:
        return np.asarray(run.nav[:, NAV.index(name)] - run.truth[:, Truth._fields.index(name)])

    north, east = off("north_m"), off("east_m")
    covariance, state = run.covariance, run.state
    turn = (off("heading_rad") + math.pi) % (2.0 * math.pi) - math.pi
    cos, sin = np.cos(state[:, 2]), np.sin(state[:, 2])
    surge, sway = state[:, 3], state[:, 4]
    jacobian = np.zeros((len(state), 2, covariance.shape[1]))  # of the velocity over ground by the states
    jacobian[:, 0, 2], jacobian[:, 1, 2] = -sin * surge - cos * sway, cos * surge - sin * sway
    jacobian[:, 0, 3], jacobian[:, 0, 4], jacobian[:, 0, 5] = cos, -sin, 1.0
    jacobian[:, 1, 3], jacobian[:, 1, 4], jacobian[:, 1, 6] = sin, cos, 1.0
    of_velocity = jacobian @ covariance @ jacobian.transpose(0, 2, 1)
    out = {
        "position": _squared(north, east, covariance[:, :2, :2]),
        "heading": np.asarray(turn**2 / covariance[:, 2, 2]),
        "velocity": _squared(off("north_m_s"), off("east_m_s"), of_velocity),
    }
    if run.is_still_air:
        current = off("current_north_m_s"), off("current_east_m_s")
        out["current"] = _squared(*current, covariance[:, 5:7, 5:7])
    return out


def _squared(north: Numbers, east: Numbers, covariance: Numbers) -> Numbers:
    """eᵀ P⁻¹ e of two components, row by row."""
    a, b, c = covariance[:, 0, 0], covariance[:, 0, 1], covariance[:, 1, 1]
    return np.asarray((c * north**2 - 2.0 * b * north * east + a * east**2) / (a * c - b * b))


def nis(innovations: Numbers) -> dict[str, tuple[float, int]]:
    """The sum of the NIS of each sensor's measurements after SETTLED_S, and how many there were.

    Reports are made ten times a second: the gyro's are a sample, the others all that there were.
    """
    times, values, variances = innovations[round(SETTLED_S * ROW_HZ) :].transpose(2, 1, 0)
    out = {}
    for sensor, freedom in SENSORS.items():
        total, count = 0.0, 0
        for number, name in enumerate(CHANNELS):
            if name.startswith(sensor):
                is_new = np.diff(times[number], prepend=np.nan) > 0.0
                total += float(np.sum((values[number] ** 2 / variances[number])[is_new]))
                count += int(np.count_nonzero(is_new))
        out[sensor] = total, count // freedom
    return out


def bounds(freedom: int, runs: int) -> tuple[float, float]:
    """The 95 % bounds of an average over so many runs, by Wilson and Hilferty's approximation of χ²."""
    n = freedom * runs
    low, high = (
        n * (1.0 - 2.0 / (9.0 * n) + sign * _Z * math.sqrt(2.0 / (9.0 * n))) ** 3 / runs
        for sign in (-1.0, 1.0)
    )
    return low, high


@dataclass(frozen=True)
class Average:
    """Of the NEES or NIS of a group over runs. mean: over runs and time; low, high: 95 % bounds at one time.

    over_time: the average over the runs, every tenth of a second after SETTLED_S; empty for NIS.
    """

    runs: int
    freedom: int
    low: float
    high: float
    mean: float
    over_time: Numbers

    @property
    def within_share(self) -> float:
        """Share of the time within the bounds."""
        return float(np.mean((self.over_time >= self.low) & (self.over_time <= self.high)))

    @property
    def above_share(self) -> float:
        """Share of the time above the bounds: over-confident."""
        return float(np.mean(self.over_time > self.high))


def average_nees(runs: Sequence[Mapping[str, Numbers]]) -> dict[str, Average]:
    """The average NEES of each group over the runs that know it."""
    out = {}
    for name, freedom in GROUPS.items():
        columns = [run[name] for run in runs if name in run and not np.isnan(run[name][-1])]
        if columns:
            length = min(len(one) for one in columns)
            over_time = np.mean([one[round(SETTLED_S * ROW_HZ) : length] for one in columns], axis=0)
            low, high = bounds(freedom, len(columns))
            out[name] = Average(len(columns), freedom, low, high, float(over_time.mean()), over_time)
    return out


def average_nis(runs: Sequence[Mapping[str, tuple[float, int]]]) -> dict[str, Average]:
    """The average NIS of each sensor's measurements over all runs: their bounds are those of all of them."""
    out = {}
    for name, freedom in SENSORS.items():
        count = sum(run[name][1] for run in runs if name in run)
        if count:
            low, high = bounds(freedom, count)
            mean = sum(run[name][0] for run in runs if name in run) / count
            out[name] = Average(len(runs), freedom, low, high, mean, np.empty(0))
    return out


def campaign(seeds: range, hull: str, receiver: str) -> tuple[dict[str, Average], dict[str, Average]]:
    """Average NEES and NIS of the estimator over random runs."""
    runs = [sail(draw(seed, hull, receiver)) for seed in seeds]
    return average_nees([nees(run) for run in runs]), average_nis([nis(run.innovations) for run in runs])


def table(found: Mapping[str, tuple[Mapping[str, Average], Mapping[str, Average]]]) -> str:
    """A row per campaign and group."""
    lines = [
        "| runs | of | | average ÷ expected | 95 % bounds | time within | above |",
        "|---|---|---|---|---|---|---|",
    ]
    for title, pair in found.items():
        for kind, averages in zip(("NEES", "NIS"), pair, strict=True):
            for name, one in averages.items():
                scaled = [f"{value / one.freedom:.2f}" for value in (one.mean, one.low, one.high)]
                shares = (
                    f"{100.0 * one.within_share:.0f} % | {100.0 * one.above_share:.0f} %"
                    if len(one.over_time)
                    else " | "
                )
                cells = (f"{title}, {one.runs}", kind, name, scaled[0], f"{scaled[1]} to {scaled[2]}", shares)
                lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)
