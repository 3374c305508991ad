"""`boat-sitl encounters`: what avoidance makes of things in the way."""

from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import Progress

from companion.core.output_file import write_text
from sitl.cli.arguments import Workers
from sitl.experiments.campaign.workers import cores
from sitl.experiments.encounters.bench import WATERS, markdown, sail_all
from sitl.world.sensors.sampling import MOST_SEED


def encounters(
    seeds: Annotated[int, typer.Option(min=1, max=100_000, help="runs in each water")] = 20,
    first_seed: Annotated[int, typer.Option(min=1, max=MOST_SEED, help="the first one's")] = 1,
    only: Annotated[
        list[str] | None, typer.Option(metavar="WORD", help="waters whose name has this word in it [all]")
    ] = None,
    overrides: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="KEY=VALUE", help="a setting, such as vehicle.avoidance.by_sight=1"),
    ] = None,
    out: Annotated[Path | None, typer.Option("--out", "-o", help="write the table here, too")] = None,
    workers: Workers = None,
) -> None:
    """Sail a leg with rocks, walls, shores and moving things in the way that the boat's plan does not know.

    Each run is sailed without them first: what moves is aimed at where the boat would be. Prints a table.

    Example:  boat-sitl encounters --seeds 5 --only crossing
    """
    console = Console(stderr=True, highlight=False)
    waters = [water for water in WATERS if not only or any(word in water.name for word in only)]
    if not waters:
        known = ", ".join(water.name for water in WATERS)
        raise typer.BadParameter(f"--only {', '.join(only or ())}: expected a part of one of {known}")
    sown = range(first_seed, first_seed + seeds)
    with Progress(console=console, transient=True, disable=not console.is_terminal) as progress:
        task = progress.add_task("sailing", total=len(waters) * seeds)
        trials = sail_all(
            waters,
            sown,
            tuple(overrides or ()),
            workers or cores(),
            lambda: progress.update(task, advance=1),
        )
    table = markdown(trials)
    typer.echo(table)
    if out is not None:
        write_text(out, table)
