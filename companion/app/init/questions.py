"""The questions of `boat-companion init`. Each is about one key of the configuration."""

import typing
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final

from companion.app.init.toml_edit import Value
from companion.config.boat_config import BoatConfig, with_value
from companion.core.errors import ConfigError

Ask = Callable[[str, str], str]
"""Ask the operator: question and default in, answer out."""


@dataclass(frozen=True)
class Question:
    """A question about a key. It is asked unless the part's driver, `unless`, is "none"."""

    key: str
    text: str
    unless: str = ""


PRESET_CELLS: Final = 3
"""Cells in series for which the presets' voltages hold."""

QUESTIONS: Final = (
    Question("identity.system_id", "MAVLink system id, unique on the network"),
    Question("parts.gnss.driver", "GNSS receiver"),
    Question("parts.gnss.port", "its port (/dev/serial0: the Pi's UART)", "parts.gnss.driver"),
    Question("parts.gnss.baud", "its baud rate (ubx sets it, nmea reads at it)", "parts.gnss.driver"),
    Question("parts.compass.driver", "heading sensor"),
    Question("parts.battery.driver", "battery monitor"),
    Question("battery.cells", "cells of the pack in series"),
    Question("battery.capacity_mah", "capacity of the pack, mAh"),
    Question("parts.sonar.driver", "sonar or ranger"),
    Question("parts.sonar.servo", "pin of its sweeping servo (-1: fixed ahead)", "parts.sonar.driver"),
    Question("rc.driver", "receiver of an RC transmitter"),
    Question("rc.port", "its port (/dev/ttyAMA4 after dtoverlay=uart4)", "rc.driver"),
)


def ask_all(config: BoatConfig, ask: Ask, complain: Callable[[str], None]) -> dict[str, Value]:
    """Ask every question; the changed values by key. config: the defaults. complain: about a wrong answer."""
    changed: dict[str, Value] = {}
    for question in QUESTIONS:
        if question.unless and value_at(config, question.unless) == "none":
            continue
        old = value_at(config, question.key)
        while True:
            default = f"{old:g}" if isinstance(old, float) else str(old)
            answer = ask(question.text + _choices(config, question.key), default).strip()
            try:
                value = _read(answer, type(old))
                config = with_value(config, question.key, value)
                break
            except ConfigError as error:
                complain(str(error))
        if value != old:
            changed[question.key] = value
    if cells := changed.get("battery.cells"):
        share = float(cells) / PRESET_CELLS
        changed["arming.battery_min_v"] = round(share * config.arming.battery_min_v, 1)
        changed["failsafe.battery_low_v"] = round(share * config.failsafe.battery_low_v, 1)
    if changed.get("parts.gnss.driver") == "none":
        changed["external.position"] = 2  # over MAVLink
    return changed


def value_at(config: BoatConfig, key: str) -> Any:  # noqa: ANN401 (a field's own type)
    """The value of a dotted key."""
    value: Any = config
    for name in key.split("."):
        value = getattr(value, name)
    return value


def _choices(config: BoatConfig, key: str) -> str:
    table, _, name = key.rpartition(".")
    hint = typing.get_type_hints(type(value_at(config, table)))[name]
    choices = typing.get_args(hint) if typing.get_origin(hint) is typing.Literal else ()
    return f" ({', '.join(choices)})" if choices else ""


def _read(answer: str, kind: type) -> Value:
    """An answer as a value of its key's type.

    Raises:
        ConfigError: it is not a number, where one is expected.
    """
    if kind is str:
        return answer
    try:
        number = float(answer)
    except ValueError:
        raise ConfigError(f"{answer!r}: expected a number") from None
    return int(number) if number.is_integer() else number
