"""The paper's Fig. 5: the heading's step response for three gain sets."""

import dataclasses
import math
from collections.abc import Sequence
from dataclasses import dataclass

import msgspec

from companion.core.modes import Mode
from companion.core.units import wrap_pi
from companion.mavlink.dialect import dialect
from sitl.experiments.paper.shore_steering import HeadingPid
from sitl.run.lockstep import Lockstep
from sitl.run.station_commands import StationCommands
from sitl.scenarios.scenario import load_scenario
from sitl.world.scenario import Scenario

GAIN_SETS = ((3.0, 2.0, 3.0), (4.0, 1.0, 5.0), (4.5, 2.3, 1.0))
"""Kp, Ki, Kd of Fig. 5 (a), (b) and (c)."""
STEP_RAD = math.radians(90.0)
SETTLE_S = 15.0
WATCH_S = 20.0
_REPEAT_S = 1.0
_BAND = 0.05  # of the step


@dataclass(frozen=True, slots=True)
class StepResponse:
    """The true heading after the step, relative to the heading before."""

    gains: tuple[float, float, float]
    times_s: tuple[float, ...]
    headings_rad: tuple[float, ...]

    @property
    def overshoot(self) -> float:
        """The farthest beyond the step, as a share of it."""
        return max(0.0, max(self.headings_rad) / STEP_RAD - 1.0)

    @property
    def settle_s(self) -> float | None:
        """Time until it stays within 5 % of the step; None: never."""
        late = [
            time
            for time, heading in zip(self.times_s, self.headings_rad, strict=True)
            if abs(heading - STEP_RAD) > _BAND * STEP_RAD
        ]
        return None if not late or late[-1] >= self.times_s[-1] else late[-1]


def step_responses(seed: int = 1) -> list[StepResponse]:
    """One response for each gain set: the pool boat on open water.

    Raises RunError: the boat did not arm or change mode.
    """
    scenario = load_scenario("open", ("boat.model=pool", f"seed={seed}"))
    return [_respond(scenario, gains) for gains in GAIN_SETS]


def _respond(scenario: Scenario, gains: tuple[float, float, float]) -> StepResponse:
    kp, ki, kd = gains
    heading = msgspec.structs.replace(scenario.vehicle.heading, kp=kp, ki=ki, kd=kd)
    vehicle = msgspec.structs.replace(scenario.vehicle, heading=heading)
    lockstep = Lockstep(dataclasses.replace(scenario, vehicle=vehicle))
    law = HeadingPid(scenario)
    station = lockstep.station
    station.listen_to(dialect.MAVLINK_MSG_ID_LOCAL_POSITION_NED)
    orders = StationCommands(lockstep, lockstep.step)
    orders.until_armable()
    orders.wait(lambda: "LOCAL_POSITION_NED" in station.latest, 10.0, "the boat sent no position")
    orders.change_mode(Mode.GUIDED)
    orders.arm()
    _hold(lockstep, law, 0.0, SETTLE_S)
    start = lockstep.world.truth.heading_rad
    times, headings = _hold(lockstep, law, STEP_RAD, WATCH_S)
    lockstep.close()
    return StepResponse(gains, tuple(times), tuple(wrap_pi(heading - start) for heading in headings))


def _hold(
    lockstep: Lockstep, law: HeadingPid, aim_rad: float, for_s: float
) -> tuple[Sequence[float], Sequence[float]]:
    began_s, next_s = lockstep.time_s, -math.inf
    times, headings = [], []
    while lockstep.time_s - began_s < for_s:
        if lockstep.time_s >= next_s:
            next_s = lockstep.time_s + _REPEAT_S
            lockstep.station.send(law.order(aim_rad, 0.0))
        lockstep.step()
        times.append(lockstep.time_s - began_s)
        headings.append(lockstep.world.truth.heading_rad)
    return times, headings
