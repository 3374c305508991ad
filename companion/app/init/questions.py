"""`boat-companion init`: write the boat's configuration from a preset and answers, each about one key."""

import typing
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import Annotated, Any, Final

from companion.app.composition import check_config
from companion.app.init.findings import Found, choose
from companion.app.init.i2c_parts import find_i2c_parts
from companion.app.init.presets import PRESETS, STATIONS, Value, board_values, preset_text, with_links
from companion.app.init.serial_parts import find_serial_parts
from companion.app.process import only_program
from companion.app.status_file import running_boat
from companion.cli.command_line import Option, ask, echo
from companion.cli.output_file import write_text
from companion.config.board import read_model
from companion.config.boat_config import BoatConfig, decode_config, with_value
from companion.core.errors import ConfigError, StorageError
from companion.core.toml_text import parse_toml

Ask = Callable[[str, str], str]
"""Ask the operator: question and default in, answer out."""


@dataclass(frozen=True)
class SetupQuestion:
    """A question about a key. driver: asked unless this part is "none"; only: asked for these drivers."""

    key: str
    text: str
    driver: str = ""
    only: tuple[str, ...] = ()


PRESET_CELLS: Final = 3
"""Cells in series for which the presets' voltages hold."""

_GNSS, _COMPASS, _SONAR = "parts.gnss.driver", "parts.compass.driver", "parts.sonar.driver"
_BATTERY, _LIDAR, _RC = "parts.battery.driver", "parts.lidar.driver", "rc.driver"

QUESTIONS: Final = (
    SetupQuestion("identity.system_id", "MAVLink system id, unique on the network"),
    SetupQuestion(_GNSS, "GNSS receiver"),
    SetupQuestion("parts.autopilot", "port url of the autopilot", _GNSS, ("autopilot",)),
    SetupQuestion(
        "parts.gnss.port",
        "port of the receiver (/dev/serial0: the Pi's UART)",
        _GNSS,
        ("nmea", "ubx", "gpsd"),
    ),
    SetupQuestion("parts.gnss.baud", "its baud rate (ubx sets it, nmea reads at it)", _GNSS, ("nmea", "ubx")),
    SetupQuestion(_COMPASS, "heading sensor"),
    SetupQuestion("parts.compass.port", "port of the compass", _COMPASS, ("nmea",)),
    SetupQuestion(_BATTERY, "battery monitor"),
    SetupQuestion("parts.i2c_bus", "I²C bus of compass and battery monitor (1: header pins 3 and 5)"),
    SetupQuestion("parts.battery.shunt_ohm", "its shunt, Ω", _BATTERY, ("ina219", "ina226", "ina228")),
    SetupQuestion("battery.cells", "cells of the pack in series"),
    SetupQuestion("battery.capacity_mah", "capacity of the pack, mAh"),
    SetupQuestion(_SONAR, "sonar or ranger"),
    SetupQuestion("parts.sonar.port", "port of the ranger", _SONAR, ("a02yyuw", "tfmini")),
    SetupQuestion("parts.sonar.servo", "pin of its sweeping servo (-1: fixed ahead)", _SONAR),
    SetupQuestion(_LIDAR, "scanning lidar"),
    SetupQuestion("parts.lidar.port", "port of the lidar", _LIDAR),
    SetupQuestion(_RC, "receiver of an RC transmitter"),
    SetupQuestion("rc.port", "port of the RC receiver (/dev/ttyAMA4: GPIO 9 of a Pi 4)", _RC),
)

_SUGGESTED: Final[dict[tuple[str, Value], dict[str, Value]]] = {  # other values, where an answer is given
    (_GNSS, "nmea"): {"parts.gnss.baud": 9600},
    (_GNSS, "gpsd"): {"parts.gnss.port": "localhost:2947"},
    (_GNSS, "autopilot"): {
        "parts.autopilot": "serial:/dev/ttyACM0:115200",
        **dict.fromkeys((_COMPASS, _BATTERY, "parts.motors.driver"), "autopilot"),
    },
    (_GNSS, "none"): {"external.position": 2},  # over MAVLink
    (_BATTERY, "ina219"): {"parts.battery.shunt_ohm": 0.1},
    (_BATTERY, "ina226"): {"parts.battery.shunt_ohm": 0.002},  # 41 A
    (_BATTERY, "ina228"): {"parts.battery.shunt_ohm": 0.002},  # 82 A
}


def ask_all(config: BoatConfig, ask: Ask, complain: Callable[[str], None]) -> dict[str, Value]:
    """Ask every question; the changed values by key. config: the defaults. complain: about a wrong answer."""
    changed: dict[str, Value] = {}
    for question in QUESTIONS:
        driver = value_at(config, question.driver) if question.driver else ""
        if driver == "none" or (question.only and driver not in question.only):
            continue
        answer = _answer(config, question, ask, complain)
        if answer == value_at(config, question.key):
            continue
        for key, value in {question.key: answer, **_SUGGESTED.get((question.key, answer), {})}.items():
            config = with_value(config, key, value)
            changed[key] = value
    if cells := changed.get("battery.cells"):
        share = float(cells) / PRESET_CELLS
        changed["arming.battery_min_v"] = round(share * config.arming.battery_min_v, 1)
        changed["failsafe.battery_low_v"] = round(share * config.failsafe.battery_low_v, 1)
    return changed


def _answer(config: BoatConfig, question: SetupQuestion, ask: Ask, complain: Callable[[str], None]) -> Value:
    """The first answer that the key takes."""
    old = value_at(config, question.key)
    default = f"{old:g}" if isinstance(old, float) else str(old)
    while True:
        try:
            value = _read(ask(question.text + _choices(config, question.key), default).strip(), type(old))
            with_value(config, question.key, value)
        except ConfigError as error:
            complain(str(error))
        else:
            return value


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
    """An answer as a value of its key's type. ConfigError: it is no number where one is expected."""
    if kind is str:
        return answer
    try:
        number = float(answer)
    except ValueError:
        raise ConfigError(f"{answer!r}: expected a number") from None
    return int(number) if number.is_integer() else number


def init(
    preset: Annotated[str, Option("--preset", help=f"{', '.join(PRESETS)}; asked for otherwise.")] = "",
    yes: Annotated[bool, Option("--yes", "-y", help="Ask nothing: the preset's own values.")] = False,
    detect: Annotated[bool, Option("--detect", help="Find the parts on I²C buses and serial ports.")] = False,
    output: Annotated[Path, Option("--output", "-o", help="The file to write.")] = Path("boat.toml"),
    force: Annotated[bool, Option("--force", help="Overwrite an existing file.")] = False,
) -> None:
    """Write a commented configuration of the boat: a preset, changed by the answers to some questions.

    Example:  boat-companion init --preset lake --yes --output boat.toml
    """
    if output.exists() and not force:
        raise ConfigError(f"{output} exists: choose another --output, or --force")
    if preset not in PRESETS and (preset or yes):
        raise ConfigError(f"--preset {preset or 'is missing'}: expected one of {', '.join(PRESETS)}")
    preset = preset or _ask_preset()
    values = board_values(read_model())
    if detect:
        values |= _detected(preset, values, asks=not yes)
    text = preset_text(preset, values) if yes else _asked(preset, values)
    check_config(_config(text, str(output)))
    write_text(output, text)
    echo(f"{output} is written; next: boat-companion check --config {output}")


def _ask_preset() -> str:
    for name, one in PRESETS.items():
        echo(f"  {name:10} {one.title}")
    preset = ask("boat", "lake")
    while preset not in PRESETS:
        echo(f"expected one of {', '.join(PRESETS)}", is_error=True)
        preset = ask("boat", "lake")
    return preset


def _detected(preset: str, board: Mapping[str, Value], *, asks: bool) -> dict[str, Value]:
    """Values of the parts that answer; where none does, the preset's part stays."""

    def accept(part: Found) -> bool:
        return asks and ask(f"take {part}? (yes, no)", "no") == "yes"

    config = _config(preset_text(preset, board), preset)
    folder = config.storage.folder
    if running_boat(config) is not None:
        raise StorageError("the boat's program uses the parts; end it: sudo systemctl stop mavboat")
    parts = list[Found]()
    with only_program(folder if Path(folder).is_dir() else ""):
        for found in chain(find_serial_parts(), find_i2c_parts()):
            echo(f"  {found}")
            parts += [found] if isinstance(found, Found) else []
    taken = choose(parts, accept, echo)
    for key in (_GNSS, _COMPASS, _BATTERY):
        if key not in taken:
            echo(f"not found, as in the preset: {key} {value_at(config, key)}")
    values = {key: value for part in taken.values() for key, value in part.values.items()}
    return {key: value for one in values.items() for key, value in _SUGGESTED.get(one, {}).items()} | values


def _asked(preset: str, board: Mapping[str, Value]) -> str:
    """The text after the questions. board: values of this machine."""
    stations = ask("address that telemetry is sent to (broadcast address of the boat's network)", STATIONS)
    radio = ask("port of a telemetry radio, such as /dev/ttyUSB0", "none")
    config = _config(preset_text(preset, board), preset)
    values = ask_all(config, ask, lambda text: echo(text, is_error=True))
    return with_links(preset_text(preset, {**board, **values}), stations, radio)


def _config(text: str, source: str) -> BoatConfig:
    return decode_config(parse_toml(text), source)
