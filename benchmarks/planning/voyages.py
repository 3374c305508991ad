"""How near does the budget come to what emulated boats sail: time and charge, in currents, wind and waves?

    python -m benchmarks.planning.voyages                 60 voyages: 5 boats, 6 conditions, 2 seeds
    python -m benchmarks.planning.voyages kit lake        these boats
    python -m benchmarks.planning.voyages --draw kit      what it draws in still water, for [battery] draw

The route has three legs of 80 s each at cruise speed, 10° to either side of north. The gusts peak at 1.5
times the mean wind. The planner is told current and mean wind; the waves it is not told.
"""

import math
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from statistics import median

import numpy as np

from companion.core.geo import Point
from mission_tools.contract.budget import Budget, budget_of
from mission_tools.costs.boat import Boat, load_boat
from mission_tools.costs.current import UniformCurrent
from mission_tools.errors import NoRoute
from mission_tools.mission.route import mission_along
from sitl.courses.missions import wire_items
from sitl.run.mission_run import MissionRun, Result
from sitl.run.recording.recorder import Rows
from sitl.scenarios.scenario import load_scenario
from sitl.world.truth import Truth

BOATS = ("kit", "lake", "catamaran", "rudder", "pool")
SEEDS = (9700, 9701)
LEG_S = 80.0  # at cruise speed
SHARES = (0.3, 0.5, 0.7, 0.85, 1.0, 1.15, 1.3, 1.5, 1.8, 2.1)  # of cruise speed, for the draw
_TICK_S = 0.02
_CURRENT_A = Truth._fields.index("current_a")
_VELOCITY = [Truth._fields.index(name) for name in ("north_m_s", "east_m_s")]


@dataclass(frozen=True)
class Condition:
    """current: of cruise speed, north and east. wind_m_s: the mean, from_deg; waves come from there too."""

    name: str
    current: tuple[float, float] = (0.0, 0.0)
    wind_m_s: float = 0.0
    from_deg: float = 0.0
    wave_height_m: float = 0.0

    @property
    def wind(self) -> str:
        """For the planner."""
        return f"{self.wind_m_s:g}@{self.from_deg:g}"

    def settings(self, cruise_m_s: float) -> list[str]:
        """For the emulator."""
        north, east = self.current
        return [
            f"environment.current_m_s={cruise_m_s * math.hypot(north, east)}",
            f"environment.current_to_deg={math.degrees(math.atan2(east, north))}",
            f"environment.wind_m_s={self.wind_m_s}",
            f"environment.gust_m_s={1.5 * self.wind_m_s}",
            f"environment.wind_from_deg={self.from_deg}",
            f"environment.wave_height_m={self.wave_height_m}",
            f"environment.wave_from_deg={self.from_deg}",
        ]


CONDITIONS = (
    Condition("calm"),
    Condition("current ahead", current=(-1 / 3, 0.0)),
    Condition("current across", current=(0.0, 1 / 3)),
    Condition("wind 4 m/s ahead", wind_m_s=4.0),
    Condition("wind 6 m/s abeam, waves", wind_m_s=6.0, from_deg=90.0, wave_height_m=0.1),
    Condition("wind 8 m/s astern, waves", wind_m_s=8.0, from_deg=180.0, wave_height_m=0.15),
)


@dataclass(frozen=True)
class Voyage:
    """Planned beside sailed. planned: None where the planner refuses it, and why."""

    boat: str
    condition: str
    planned: Budget | None
    why: str
    result: Result
    sailed_mah: float

    @property
    def errors(self) -> tuple[float, float] | None:
        """Of time and charge, planned over sailed less one; None unless planned and sailed."""
        if self.planned is None or not self.result.completed:
            return None
        return self.planned.time_s / self.result.time_s - 1.0, self.planned.charge_mah / self.sailed_mah - 1.0


def route(cruise_m_s: float) -> list[Point]:
    """Start and waypoints."""
    points = [Point(0.0, 0.0)]
    for deg in (10.0, -10.0, 10.0):
        course, length_m = math.radians(deg), LEG_S * cruise_m_s
        north_m, east_m = points[-1]
        points.append(Point(north_m + length_m * math.cos(course), east_m + length_m * math.sin(course)))
    return points


def sail(
    name: str, seed: int, points: list[Point], settings: list[str], speed_m_s: float | None
) -> MissionRun:
    """A run of the emulator, ready to begin."""
    scenario = load_scenario("open", [f"boat.model={name}", f"seed={seed}", *settings])
    places = [scenario.frame.to_global(point) for point in points]
    return MissionRun(scenario, wire_items(mission_along(places, speed_m_s)))


def voyages(names: tuple[str, ...], seeds: tuple[int, ...]) -> Iterator[Voyage]:
    """Plan and sail."""
    for name in names:
        boat = load_boat(name)
        points = route(boat.cruise_m_s)
        for condition in CONDITIONS:
            planned, why = _planned(load_boat(name, condition.wind), points, condition)
            for seed in seeds:
                run = sail(name, seed, points, condition.settings(boat.cruise_m_s), None)
                result = run.run()
                mah = float(run.sailed_rows[:, _CURRENT_A].sum()) * _TICK_S / 3.6
                yield Voyage(name, condition.name, planned, why, result, mah)


def _planned(boat: Boat, points: list[Point], condition: Condition) -> tuple[Budget | None, str]:
    north, east = (boat.cruise_m_s * share for share in condition.current)
    ways_m = [math.hypot(*point) for point in points]
    holds_s = [0.0] * (len(points) - 1)
    try:
        return budget_of(points, holds_s, ways_m, boat, None, UniformCurrent(north, east)), ""
    except NoRoute as error:
        return None, str(error)


def draw(name: str, seed: int = 1000) -> Iterator[tuple[float, float]]:
    """Speed through still water and current drawn under way, at shares of cruise speed."""
    boat = load_boat(name)
    for share in SHARES:
        points = route(boat.cruise_m_s * min(share, 1.0))
        run = sail(name, seed, points, [], share * boat.cruise_m_s)
        run.run(timeout_s=900.0)
        yield _steady(run.sailed_rows)
        if share * boat.cruise_m_s > boat.top_m_s:
            return


def _steady(rows: Rows) -> tuple[float, float]:
    """Mean speed and current, without the start and the end."""
    under_way = rows[len(rows) // 5 : -len(rows) // 20]
    return float(np.hypot(*under_way[:, _VELOCITY].T).mean()), float(under_way[:, _CURRENT_A].mean())


def main(arguments: list[str]) -> int:
    """Print a table: a row a voyage, then the worst and the median."""
    names = tuple(name for name in arguments if not name.startswith("--")) or BOATS
    if "--draw" in arguments:
        for name in names:
            pairs = ", ".join(f"[{speed:.3g}, {drawn:.3g}]" for speed, drawn in draw(name))
            sys.stdout.write(f"{name}: draw = [{pairs}]\n")
        return 0
    errors = []
    sys.stdout.write(
        "| boat | condition | time planned | sailed | | charge planned | sailed | |\n" + "|---" * 8 + "|\n"
    )
    for voyage in voyages(names, SEEDS):
        result, planned = voyage.result, voyage.planned
        sailed = f"{result.time_s:.0f} s" if result.completed else f"{result.waypoints_reached} of 3"
        cells = ["refused", sailed, "", voyage.why, f"{voyage.sailed_mah:.0f} mAh", ""]
        if planned is not None:
            cells[0], cells[3] = f"{planned.time_s:.0f} s", f"{planned.charge_mah:.0f} mAh"
        if voyage.errors is not None:
            errors.append(voyage.errors)
            cells[2], cells[5] = (f"{100.0 * error:+.1f} %" for error in voyage.errors)
        sys.stdout.write(f"| {' | '.join((voyage.boat, voyage.condition, *cells))} |\n")
        sys.stdout.flush()
    for what, kind in (("time", 0), ("charge", 1)):
        sizes = [100.0 * abs(error[kind]) for error in errors]
        sys.stdout.write(f"{what}: worst {max(sizes):.1f} %, median {median(sizes):.1f} % of {len(sizes)}\n")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
