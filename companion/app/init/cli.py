"""`boat-companion init`: write the boat's configuration from a preset and some answers."""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated

import typer

from companion.app.composition import check_config
from companion.app.init.presets import PRESETS, STATIONS, board_values, preset_text, with_links
from companion.app.init.questions import ask_all
from companion.app.init.toml_edit import Value
from companion.cli.output_file import write_text
from companion.config.board import read_model
from companion.config.boat_config import BoatConfig, decode_config
from companion.core.errors import ConfigError
from companion.core.toml_text import parse_toml


def init(
    preset: Annotated[str, typer.Option("--preset", help=f"{', '.join(PRESETS)}; asked for otherwise.")] = "",
    yes: Annotated[bool, typer.Option("--yes", "-y", help="Ask nothing: the preset's own values.")] = False,
    output: Annotated[Path, typer.Option("--output", "-o", help="The file to write.")] = Path("boat.toml"),
    force: Annotated[bool, typer.Option("--force", help="Overwrite an existing file.")] = False,
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
    typer.echo(f"{output} is written; next: boat-companion check --config {output}")


def _asked(preset: str, board: Mapping[str, Value]) -> str:
    """The text after the questions. board: values of this machine."""
    if not preset:
        for name, one in PRESETS.items():
            typer.echo(f"  {name:10} {one.title}")
        preset = _ask("boat", "lake")
        while preset not in PRESETS:
            typer.echo(f"expected one of {', '.join(PRESETS)}", err=True)
            preset = _ask("boat", "lake")
    stations = _ask("address that telemetry is sent to (broadcast address of the boat's network)", STATIONS)
    radio = _ask("port of a telemetry radio, such as /dev/ttyUSB0", "none")
    config = _config(preset_text(preset, board), preset)
    values = ask_all(config, _ask, lambda text: typer.echo(text, err=True))
    return with_links(preset_text(preset, {**board, **values}), stations, radio)


def _ask(question: str, default: str) -> str:
    return str(typer.prompt(question, default=default))


def _config(text: str, source: str) -> BoatConfig:
    return decode_config(parse_toml(text), source)
