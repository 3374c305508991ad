"""`boat-companion doctor`."""

import time
from functools import partial
from pathlib import Path
from typing import Annotated

from rich.console import Console

from companion.app.composition import check_config
from companion.app.doctor.accounts import account_findings
from companion.app.doctor.by_hand import nudge_motors, turn_by_hand
from companion.app.doctor.computer import computer_findings
from companion.app.doctor.findings import Examined, Finding, as_json, failed, fine, is_fine, print_table
from companion.app.doctor.parts import part_findings
from companion.app.doctor.settings import settings_findings
from companion.app.install.plan import CONFIG
from companion.app.install.steps import apply_steps
from companion.app.install.target import Target
from companion.app.runner import SystemClock
from companion.app.status_file import running_boat
from companion.cli.command_line import Option, ask, echo
from companion.config.boat_config import BoatConfig, load_config
from companion.core.errors import BoatError, UsageError


def doctor(
    config: Annotated[Path | None, Option("--config", "-c", help="The boat's TOML file.")] = None,
    json: Annotated[bool, Option("--json", help="Print the findings as JSON.")] = False,
    fix: Annotated[bool, Option("--fix", help="Correct groups and start-up files, with a copy.")] = False,
    motors: Annotated[bool, Option("--motors", help="Turn the motors, after a typed yes.")] = False,
    compass: Annotated[bool, Option("--compass", help="Turn the boat by hand, and compare.")] = False,
    root: Annotated[Path, Option(help="Another system's root folder: its files only, no parts.")] = Path("/"),
) -> int:
    """Check the computer, its settings and every configured part. Exit code 1 if something failed.

    Example:  sudo systemctl stop mavboat; boat-companion doctor --motors
    """
    if (motors or compass) and json:
        raise UsageError("--motors and --compass ask questions; leave out --json")
    target, clock = Target(root.resolve()), SystemClock()
    path = config or target.path(CONFIG)
    found = _read(path, Examined(target, BoatConfig()).model)
    tree = found if isinstance(found, BoatConfig) else BoatConfig()
    examined = Examined(target, tree)
    findings = [*computer_findings(examined, time.time()), *account_findings(examined)]
    findings.append(
        found if isinstance(found, Finding) else fine("configuration", f"{path}: {len(tree.links)} links")
    )
    findings += settings_findings(examined)
    if target.is_this_machine:
        findings += part_findings(examined, clock)
        is_free = running_boat(tree) is None
        if compass and is_free:
            findings.append(turn_by_hand(tree, clock, partial(ask, default=""), echo))
        if motors and is_free:
            findings.append(nudge_motors(tree, clock, ask, echo))
    if json:
        echo(as_json(findings))
    else:
        print_table(findings, Console())
    if fix:
        apply_steps(
            [step for finding in findings for step in finding.fix], lambda text: echo(text, is_error=json)
        )
    return 0 if is_fine(findings) else 1


def _read(path: Path, model: str) -> BoatConfig | Finding:
    try:
        config = load_config(path)
        check_config(config, model)
    except BoatError as error:
        cure = "correct the file, or make one with `boat-companion init`"
        return failed("configuration", str(error), cure)
    return config
