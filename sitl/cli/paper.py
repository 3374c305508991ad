"""`boat-sitl paper`: the paper's experiment, repeated in simulation."""

import dataclasses
import json
from pathlib import Path
from typing import Annotated

from rich.console import Console
from rich.markdown import Markdown

from companion.cli.command_line import Option, echo
from companion.cli.output_file import output_folder, write_text
from sitl.cli.arguments import Workers
from sitl.cli.progress import progress_bar
from sitl.experiments.campaign.table import write_csv
from sitl.experiments.paper import figures, table
from sitl.experiments.paper.conditions import FIRST_SEED, MEANINGS, RUNS, Method, seeds
from sitl.experiments.paper.run import paper_trials, run_paper_trial
from sitl.experiments.paper.step_response import step_responses
from sitl.experiments.runner import cores, local_pool, run_trials


def paper(
    out: Annotated[Path, Option("--out", "-o", metavar="DIR", help="where tables and figures go")] = Path(
        "out/paper"
    ),
    runs: Annotated[int, Option(least=2, most=100_000, help="seeds a case and method")] = RUNS,
    first_seed: Annotated[
        int, Option("--first-seed", least=0, most=2**31 - 1, help="the first of them")
    ] = FIRST_SEED,
    workers: Workers = None,
    as_json_text: Annotated[bool, Option("--json", help="the reductions as JSON on stdout")] = False,
) -> int:
    """Run the five cases of the paper with on/off steering, heading PID and line-of-sight guidance.

    All methods have the same plans and disturbances. Prints Table 3 by the paper's equations and from ground
    truth; writes runs.csv, table3.csv, tables.md and the figures. docs/paper.md discusses them.
    Exit code 1 unless heading PID beats on/off steering in mean length, time and both deviations in every
    case.

    Example:  boat-sitl paper -o out/paper
    Fresh seeds:  boat-sitl paper --first-seed 7001 --runs 4 -o out/fresh
    """
    console = Console(stderr=as_json_text, highlight=False, soft_wrap=True)
    output_folder(out)
    reported = seeds(runs, first_seed)
    untouched = ", none of them ever tuned on" if reported == seeds(runs) else ""
    console.print(f"seeds {reported[0]} to {reported[-1]}{untouched}")
    for method in Method:
        console.print(f"  {method}: {MEANINGS[method]}")
    trials = paper_trials(reported)
    with progress_bar(console, "paper", len(trials)) as advance, local_pool(workers or cores()) as pool:
        results = run_trials(pool, run_paper_trial, trials, advance=advance, is_strict=True)
    rows = table.rows(results)
    text = table.markdown(rows)
    write_csv([result.figures for result in results], out / "runs.csv")
    write_csv([dataclasses.asdict(row) for row in rows], out / "table3.csv")
    write_text(out / "tables.md", text)
    figures.draw_step_responses(step_responses(reported[0]), out / "figure5.png")
    figures.draw_pool(out / "figure16.png")
    figures.draw_deviations(rows, out / "figure17.png")
    figures.draw_lengths_and_times(rows, out / "figure18.png")
    figures.draw_tracks(results, out / "tracks.png")
    shares = table.reductions(rows)
    if as_json_text:
        echo(json.dumps({"seeds": reported, "reductions": shares}, indent=2))
    else:
        console.print(Markdown(text))
        console.print(f"written to {out}")
    worse = [
        f"case {case}: {name}" for case, one in shares.items() for name, share in one.items() if share <= 0.0
    ]
    if worse:
        console.print(f"heading PID does not beat on/off steering in {', '.join(worse)}")
        return 1
    return 0
