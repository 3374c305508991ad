"""A fitted boat as a boat's file: the base boat's TOML with the fitted values and what is known of them."""

import json
import math
import re
from collections.abc import Mapping
from operator import attrgetter
from typing import Final

from companion.config.parameter_table import ROWS
from companion.config.parameters import Parameters
from companion.core.storage import MemoryStorage
from sitl.scenarios.scenario import load_scenario
from sitl.twin.fit import Fit
from sitl.twin.model import KEYS, RIGHT
from sitl.world.scenario import Scenario

_OWN: Final = ("heading.", "speed.", "motors.", "thrusters.", "handling.", "guidance.")
"""Of the boat's own settings, those that belong to its hull."""
_FORCES: Final = (
    "mass_kg", "inertia_kg_m2", "surge_added_kg", "sway_added_kg", "yaw_added_kg_m2", "surge_linear",
    "surge_quadratic", "sway_linear", "sway_quadratic", "yaw_linear", "yaw_quadratic", "skeg_lift_kg_m",
)  # fmt: skip
_THRUST: Final = "thrusters.propeller.thrust_coefficient"
_POWER: Final = {  # exponents by which torque and current grow while the boat moves alike
    "thrusters.propeller.torque_coefficient": 1, "thrusters.motor.inertia_kg_m2": 1,
    "thrusters.motor.no_load_a": 1, "thrusters.motor.resistance_ohm": -1,
}  # fmt: skip
Entries = dict[str, tuple[object, str]]


def scaled_base(base: Scenario, mass_kg: float | None, apart_m: float | None) -> Scenario:
    """The base boat with the owner's mass and distance of the shafts. All masses, forces and torques grow
    with the mass: a voyage tells only their ratios.
    """
    ratio = 1.0 if mass_kg is None else mass_kg / base.hull.mass_kg
    powers = {**{f"hull.{name}": 1 for name in _FORCES}, _THRUST: 1, **_POWER}
    settings = {key: ratio**power * float(attrgetter(key)(base)) for key, power in powers.items()}
    settings["thrusters.apart_m"] = base.thrusters.apart_m if apart_m is None else apart_m
    over = [f"{key}={value}" for key, value in settings.items()]
    return load_scenario("open", [f"boat.model={base.boat_file}", *over])


def fitted_entries(fit: Fit) -> Entries:
    """Values and comments by the boat file's keys."""
    base, entries = fit.base, Entries()
    most = {"hull.crossflow_length_m": base.hull.length_m, "thrusters.propeller.astern_share": 1.0}
    for name in _FORCES:
        if value := getattr(base.hull, name):
            entries[f"hull.{name}"] = (value, "the base boat's, in proportion to the mass")
    entries["hull.mass_kg"] = (base.hull.mass_kg, "--mass, or the base boat's: not told by a voyage")
    entries["thrusters.apart_m"] = (base.thrusters.apart_m, "--apart, or the base boat's: shaft to shaft")
    entries |= {key: (attrgetter(key)(base), "the base boat's") for key in _POWER}
    for n, key in enumerate(fit.keys):
        what, share = KEYS[key], math.sqrt(fit.covariance[n, n])
        text = f"{what.meaning}: one deviation {100.0 * share:.1f} %"
        if not fit.told[n]:
            text = f"{what.meaning}: base boat's, cannot be told from this voyage; tell it by {what.told_by}"
        value = attrgetter(key)(base) * math.exp(fit.logs[n])
        entries[key] = (min(value, most.get(key, math.inf)), text)
        if key == "thrusters.left_gain":
            entries[RIGHT] = (base.thrusters.right_gain * math.exp(-fit.logs[n]), KEYS[RIGHT].meaning)
    ohm = float(fit.segmented[0].voyage.pack_ohm)
    if ohm > 0.0:
        entries["battery.resistance_ohm"] = (ohm, "cells and leads, from the voltage under load")
    factor = _least_power(entries)
    if factor > 1.0:
        for key, exponent in _POWER.items():
            text = f"raised by {factor:.2f} to cover the thrust's power: motors draw less than the file says"
            entries[key] = (float(str(entries[key][0])) * factor**exponent, text)
    return entries


def _least_power(entries: Entries) -> float:
    """The factor on the torque with which the propeller gives no more power than it takes, as
    `PropellerSettings` asks. With a wrong mass, or without a current in the log, the thrust may ask for more.
    """
    names = ("torque_coefficient", "zero_torque_advance", "thrust_coefficient", "zero_thrust_advance")
    q, q_end, t, t_end = (float(str(entries[f"thrusters.propeller.{name}"][0])) for name in names)
    a, b = 2.0 * math.pi * q / q_end, 4.0 * math.pi * q * t * (2.0 / t_end - 1.0 / q_end)
    return 1.001 * (b - math.sqrt(max(b * b - 4.0 * a * a * t * t, 0.0))) / (2.0 * a * a)


def own_settings(base: Scenario, parameters: Mapping[str, float]) -> Entries:
    """What the logged boat's program is set to for its hull, where it differs from the base boat's."""
    own = Parameters(base.vehicle, ROWS, MemoryStorage())
    before = {row.name: own.value(row) for row in ROWS}
    own.set_many(parameters.items())
    return {
        f"vehicle.{row.path}": (attrgetter(row.path)(own.config), f"{row.name} of the voyage's log")
        for row in ROWS
        if row.path.startswith(_OWN) and own.value(row) != before[row.name]
    }


def boat_text(base_text: str, head: str, entries: Entries) -> str:
    """The base boat's file with other values. head: comments in place of those before the first table."""
    left, parts = dict(entries), [head]

    def missing(table: str) -> list[str]:
        return [_line(key, *left.pop(key)) for key in list(left) if key.rpartition(".")[0] == table]

    for part in re.split(r"^(?=\[)", base_text, flags=re.MULTILINE)[1:]:
        table, lines = part[1 : part.index("]")], []
        for line in part.rstrip().splitlines():
            key = f"{table}.{line.partition('=')[0].strip()}"
            lines.append(_line(key, *left.pop(key)) if key in left else line)
        parts.append("\n".join([*lines, *missing(table)]))
    for table in dict.fromkeys(key.rpartition(".")[0] for key in left):
        parts.append("\n".join([f"[{table}]", *missing(table)]))
    return "\n\n".join(parts) + "\n"


def _line(key: str, value: object, comment: str) -> str:
    shown = f"{value:.5g}" if isinstance(value, float) else json.dumps(value)
    return f"{key.rpartition('.')[2]} = {shown}" + (f"  # {comment}" if comment else "")
