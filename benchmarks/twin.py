"""Boats that nobody modelled, identified from a voyage: docs/twin.md.

    python -m benchmarks.twin 601 602 603      # seeds of hulls

Figures of hull, windage and drive are drawn within 40 % of the lake boat's, and hidden from the fit but for
mass and distance of the shafts, which scale and ruler tell. The voyage of `boat-sitl fit --voyage` is sailed
twice, on other headings, in 3 m/s of wind with gusts of 5 and 0.3 m/s of current, with a standalone receiver,
and logged at 50 Hz. The fit sees the first ten minutes; the rest checks it.
"""

import json
import math
import random
import sys
import time
import tomllib
from collections.abc import Mapping
from dataclasses import replace
from operator import attrgetter
from pathlib import Path
from typing import Any

import numpy as np

from companion.cli.command_line import echo
from companion.core.errors import ConfigError
from companion.log.logbook import Logbook
from companion.log.sink import SingleFile
from sitl.courses.missions import wire_items
from sitl.run.mission_run import MissionRun
from sitl.scenarios.scenario import BOATS, load_scenario
from sitl.twin.boat_file import scaled_base
from sitl.twin.fit import fit_boat, following
from sitl.twin.manoeuvres import trial_mission
from sitl.twin.response import FIGURES, response, stated_figures
from sitl.twin.voyage import read_voyage
from sitl.world.scenario import Scenario

FOLDER = Path("out/twin")
REACH, WEAKEST = 0.4, 0.85
FITTED_S = 600.0
WATER = (
    "environment.wind_m_s=3", "environment.gust_m_s=5", "environment.current_m_s=0.3",
    "vehicle.log.motion_hz=50", "sensors.sonar.fitted=false",
)  # fmt: skip
# Drawn with the rest, their effect on thrust and torque would go with the third to fifth power.
FIXED = {"diameter_m", "back_emf_v_s", "length_m", "beam_m", "transom_share", "depth_m"}


def drawn_boat(seed: int) -> tuple[list[str], Scenario]:
    """The settings of a hull, and the lake boat with them."""
    tree = tomllib.loads((BOATS / "lake.toml").read_text(encoding="utf-8"))
    numbers = random.Random(seed)
    while True:
        settings = [
            f"{path}={value * numbers.uniform(1.0 - REACH, 1.0 + REACH):.5g}"
            for table in ("hull", "thrusters")
            for path, value in leaves(tree[table], table)
        ]
        settings += [
            f"thrusters.{side}_gain={numbers.uniform(WEAKEST, 1.0):.3f}" for side in ("left", "right")
        ]
        try:
            return settings, load_scenario("open", [*settings, *WATER, f"seed={seed}"])
        except ConfigError:  # a propeller that gives more than it takes, strips beyond the hull
            continue


def leaves(tree: Mapping[str, Any], path: str) -> list[tuple[str, float]]:
    """The numbers that are drawn, by their keys."""
    out: list[tuple[str, float]] = []
    for key, value in tree.items():
        if isinstance(value, dict):
            out += leaves(value, f"{path}.{key}")
        elif isinstance(value, float) and key not in FIXED:
            out.append((f"{path}.{key}", value))
    return out


def sail(scenario: Scenario, path: Path) -> None:
    """The voyage, twice."""
    if path.exists():
        return
    cruise_m_s = scenario.vehicle.speed.cruise_m_s
    first, second = (trial_mission(scenario.frame.origin, cruise_m_s, math.radians(deg)) for deg in (0, 200))
    path.parent.mkdir(parents=True, exist_ok=True)
    aside = path.with_suffix(".part")
    logbook = Logbook(SingleFile(aside))
    mission = replace(first, items=first.items + second.items)
    MissionRun(scenario, wire_items(mission), logbook).run(timeout_s=2.0 * FITTED_S + 30.0)
    aside.rename(path)


def in_terms_of(base: Scenario, truth: Scenario, key: str) -> float:
    """What a parameter of the hidden boat is in the base boat's terms: forces in proportion to its mass and
    added mass, sums where only they are told, and gains of the commands equal in the mean.
    """
    hull, other, drive = truth.hull, base.hull, truth.thrusters
    ratio = (other.mass_kg + other.surge_added_kg) / (hull.mass_kg + hull.surge_added_kg)
    gain = math.sqrt(drive.left_gain * drive.right_gain)
    value = float(attrgetter(key)(truth))
    name = key.rpartition(".")[2]
    if name == "sway_added_kg":
        return ratio * (hull.mass_kg + value) - other.mass_kg
    if name == "inertia_kg_m2" and key.startswith("hull"):
        return ratio * (value + hull.yaw_added_kg_m2) - other.yaw_added_kg_m2
    if key == "thrusters.motor.resistance_ohm":
        ohm = value + drive.bridge.resistance_ohm
        return ohm / gain**2 - base.thrusters.bridge.resistance_ohm
    if key.startswith("hull.windage"):
        area = "frontal_area_m2" if name.startswith("frontal") else "lateral_area_m2"
        return float(ratio * value * getattr(hull.windage, area) / getattr(other.windage, area))
    if key.startswith("hull"):
        return value if name in {"crossflow_length_m", "skeg_arm_m"} else ratio * value
    powers = {
        "torque_coefficient": 3, "thrust_coefficient": 2, "inertia_kg_m2": 2, "astern_share": 0,
        "left_gain": -1,
    }  # fmt: skip
    return float(value * gain ** powers.get(name, 1) * (ratio if name == "thrust_coefficient" else 1.0))


def judged(seed: int) -> dict[str, Any]:
    """A hull's figures: errors and stated deviations as shares, which true values lie within 1.96 deviations,
    and the velocity's error over the next ten minutes, of the receiver's noise.
    """
    _, truth = drawn_boat(seed)
    path = FOLDER / f"{seed}.bin"
    sail(truth, path)
    lake = load_scenario("open", ["boat.model=lake"])
    base = scaled_base(lake, truth.hull.mass_kg, truth.thrusters.apart_m)
    voyage = read_voyage(path, base.battery.resistance_ohm)
    began_s = time.process_time()
    fit = fit_boat(base, [voyage.part(0.0, FITTED_S)])
    cpu_s = time.process_time() - began_s
    figures = np.array([(value, deviation) for _, value, deviation in stated_figures(fit)])
    true = response(truth, {}, truth.battery.resistance_ohm)[:, 0]
    wanted = [math.log(in_terms_of(base, truth, key) / attrgetter(key)(base)) for key in fit.keys]
    off = np.abs(fit.logs - wanted) / np.sqrt(np.diag(fit.covariance))
    rest = voyage.part(FITTED_S, voyage.duration_s)
    segments, run, nuisance = following(fit, rest, rest.duration_s - 5.0)
    pairs = zip(segments.predicted(run, nuisance)[:2], segments.measured[:2], strict=True)
    error_m_s = math.sqrt(np.mean([np.mean((one - other) ** 2) for one, other in pairs]))
    return {
        "seed": seed,
        "errors": ((figures[:, 0] - true) / true).tolist(),
        "deviations": (figures[:, 1] / true).tolist(),
        "within": [bool(one) for one in np.abs(figures[:, 0] - true) < 1.96 * figures[:, 1]],
        "parameters": dict(zip(fit.keys, off.tolist(), strict=True)),
        "told": fit.told.tolist(),
        "follows": error_m_s / truth.sensors.gnss.velocity_noise_m_s,
        "cpu_s": cpu_s,
    }


def main(seeds: list[int]) -> None:
    """Print a row a hull, as they come, and the summary."""
    found = []
    for seed in seeds:
        found.append(judged(seed))
        (FOLDER / f"{seed}.json").write_text(json.dumps(found[-1], indent=1), encoding="utf-8")
        row = [f"{100.0 * one:+.1f}" for one in found[-1]["errors"]]
        echo(f"{seed} {' '.join(row)} % follows {found[-1]['follows']:.2f} cpu {found[-1]['cpu_s']:.0f} s")
    errors = np.abs([one["errors"] for one in found])
    for name, column in zip(FIGURES, errors.T, strict=True):
        echo(f"{name}: median {100.0 * np.median(column):.1f} %, largest {100.0 * column.max():.1f} %")
    off = np.array([value for one in found for value in one["parameters"].values()])
    within = np.mean([one["within"] for one in found])
    echo(f"true value within 95 % band: figures {within:.0%}, parameters {np.mean(off < 1.96):.0%}")


if __name__ == "__main__":
    main([int(one) for one in sys.argv[1:]] or list(range(601, 611)))
