"""A fitted boat as a boat's file: the base boat's TOML with the fitted values and what is known of them."""

import json
import math
import re
from collections.abc import Mapping
from dataclasses import replace
from operator import attrgetter
from typing import Final

from msgspec.structs import replace as with_fields

from companion.config.parameter_table import ROWS
from companion.config.parameters import Parameters
from companion.core.storage import MemoryStorage
from sitl.twin.fit import Fit
from sitl.twin.model import KEYS, RIGHT
from sitl.world.scenario import Scenario

_OWN: Final = ("heading.", "speed.", "motors.", "thrusters.", "handling.", "guidance.")
"""Of the boat's own settings, those that belong to its hull."""
_FORCES: Final = (
    "mass_kg", "inertia_kg_m2", "surge_added_kg", "sway_added_kg", "yaw_added_kg_m2", "surge_linear",
    "surge_quadratic", "sway_linear", "sway_quadratic", "yaw_linear", "yaw_quadratic", "skeg_lift_kg_m",
)  # fmt: skip
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
    drive, motor, screw = base.thrusters, base.thrusters.motor, base.thrusters.propeller
    hull = with_fields(base.hull, **{name: ratio * getattr(base.hull, name) for name in _FORCES})
    motor = with_fields(
        motor, inertia_kg_m2=ratio * motor.inertia_kg_m2, no_load_a=ratio * motor.no_load_a,
        resistance_ohm=motor.resistance_ohm / ratio,
    )  # fmt: skip
    thrust, torque = ratio * screw.thrust_coefficient, ratio * screw.torque_coefficient
    screw = with_fields(screw, thrust_coefficient=thrust, torque_coefficient=torque)
    apart_m = drive.apart_m if apart_m is None else apart_m
    return replace(
        base, hull=hull, thrusters=with_fields(drive, motor=motor, propeller=screw, apart_m=apart_m)
    )


def fitted_entries(fit: Fit) -> Entries:
    """Values and comments by the boat file's keys."""
    base, entries = fit.base, Entries()
    for name in _FORCES:
        if value := getattr(base.hull, name):
            entries[f"hull.{name}"] = (value, "the base boat's, in proportion to the mass")
    entries["hull.mass_kg"] = (base.hull.mass_kg, "--mass, or the base boat's: not told by a voyage")
    entries["thrusters.apart_m"] = (base.thrusters.apart_m, "--apart, or the base boat's: shaft to shaft")
    screw = base.thrusters.propeller
    entries["thrusters.propeller.thrust_coefficient"] = (screw.thrust_coefficient, "")
    for n, key in enumerate(fit.keys):
        what, share = KEYS[key], math.sqrt(fit.covariance[n, n])
        value = attrgetter(key)(base) * math.exp(fit.logs[n])
        text = f"{what.meaning}: one deviation {100.0 * share:.1f} %"
        if not fit.told[n]:
            text = f"{what.meaning}: base boat's, cannot be told from this voyage; tell it by {what.told_by}"
        entries[key] = (value, text)
        if key == "thrusters.left_gain":
            entries[RIGHT] = (base.thrusters.right_gain * math.exp(-fit.logs[n]), KEYS[RIGHT].meaning)
    ohm = float(fit.trips[0].voyage.pack_ohm)
    if ohm > 0.0:
        entries["battery.resistance_ohm"] = (ohm, "cells and leads, from the voltage under load")
    values = {key: float(str(entries[key][0])) if key in entries else attrgetter(key)(base) for key in _POWER}
    factor = _least_power(fit, entries, values["thrusters.propeller.torque_coefficient"])
    if factor > 1.0:
        for key, exponent in _POWER.items():
            text = f"raised by {factor:.2f} to cover the thrust's power: motors draw less than the file says"
            entries[key] = (values[key] * factor**exponent, text)
    return entries


def _least_power(fit: Fit, entries: Entries, torque: float) -> float:
    """The factor on the torque with which the propeller gives no more power than it takes. With a mass that
    is wrong, or without a current in the log, the fitted thrust may ask for more.
    """
    names = ("thrust_coefficient", "zero_thrust_advance", "zero_torque_advance")
    changed = {name: entries[f"thrusters.propeller.{name}"][0] for name in names}
    factor = 1.0
    while factor < 10.0:
        try:
            with_fields(fit.base.thrusters.propeller, torque_coefficient=factor * torque, **changed)
        except ValueError:
            factor *= 1.02
        else:
            break
    return factor


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
    """The base boat's file with other values. head: comments in place of those it begins with."""
    left, lines, table = dict(entries), head.splitlines(), ""

    def add_missing() -> None:
        for key in [key for key in left if table and key.rpartition(".")[0] == table]:
            lines.append(_line(key, *left.pop(key)))

    body = base_text.splitlines()
    while body and body[0].startswith("#"):
        body.pop(0)
    for line in body:
        found = re.match(r"\[([\w.]+)\]", line)
        if found:
            end = len(lines)
            while lines and not lines[-1]:
                lines.pop()
            add_missing()
            lines += [""] * (end - len(lines)) or [""]
            table = found[1]
        key = f"{table}.{line.partition('=')[0].strip()}"
        lines.append(_line(key, *left.pop(key)) if key in left else line)
    add_missing()
    for table in dict.fromkeys(key.rpartition(".")[0] for key in left):
        lines += ["", f"[{table}]"]
        add_missing()
    return "\n".join(lines) + "\n"


def _line(key: str, value: object, comment: str) -> str:
    shown = f"{value:.5g}" if isinstance(value, float) else json.dumps(value)
    return f"{key.rpartition('.')[2]} = {shown}" + (f"  # {comment}" if comment else "")
