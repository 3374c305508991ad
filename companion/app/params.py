"""`boat-companion params`: the table of parameters."""

from typing import Annotated

from rich.console import Console
from rich.table import Table

from companion.cli.command_line import Option, echo
from companion.config.boat_config import BoatConfig
from companion.config.parameter_page import parameter_page
from companion.config.parameter_table import ROWS
from companion.config.parameters import Parameters
from companion.core.storage import MemoryStorage


def params(markdown: Annotated[bool, Option("--markdown", help="Print docs/parameters.md.")] = False) -> None:
    """List every parameter with its default, unit and meaning."""
    if markdown:
        echo(parameter_page(), newline="")
        return
    table = Table("name", "default", "unit", "meaning", box=None)
    parameters = Parameters(BoatConfig(), ROWS, MemoryStorage())
    for row in ROWS:
        table.add_row(row.name, f"{parameters.value(row):g}", row.unit, row.text)
    Console().print(table)
