"""`boat-companion init`: write the boat's configuration from a preset and some answers."""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated

from companion.app.composition import check_config
from companion.app.init.presets import PRESETS, STATIONS, board_values, preset_text, with_links
from companion.app.init.questions import ask_all
from companion.app.init.toml_edit import Value
from companion.cli.command_line import Option, ask, echo
from companion.cli.output_file import write_text
from companion.config.board import read_model
from companion.config.boat_config import BoatConfig, decode_config
from companion.core.errors import ConfigError
from companion.core.toml_text import parse_toml


def init(
    preset: Annotated[str, Option("--preset", help=f"{', '.join(PRESETS)}; asked for otherwise.")] = "",
    yes: Annotated[bool, Option("--yes", "-y", help="Ask nothing: the preset's own values.")] = False,
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
    board = board_values(read_model())
    text = preset_text(preset, board) if yes else _asked(preset, board)
    check_config(_config(text, str(output)))
    write_text(output, text)
    echo(f"{output} is written; next: boat-companion check --config {output}")


def _asked(preset: str, board: Mapping[str, Value]) -> str:
    """The text after the questions. board: values of this machine."""
    if not preset:
        for name, one in PRESETS.items():
            echo(f"  {name:10} {one.title}")
        preset = ask("boat", "lake")
        while preset not in PRESETS:
            echo(f"expected one of {', '.join(PRESETS)}", is_error=True)
            preset = ask("boat", "lake")
    stations = ask("address that telemetry is sent to (broadcast address of the boat's network)", STATIONS)
    radio = ask("port of a telemetry radio, such as /dev/ttyUSB0", "none")
    config = _config(preset_text(preset, board), preset)
    values = ask_all(config, ask, lambda text: echo(text, is_error=True))
    return with_links(preset_text(preset, {**board, **values}), stations, radio)


def _config(text: str, source: str) -> BoatConfig:
    return decode_config(parse_toml(text), source)
