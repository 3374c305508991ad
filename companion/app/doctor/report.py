"""The report as a table or as JSON."""

from collections.abc import Sequence

import msgspec
from rich.console import Console
from rich.table import Table

from companion.app.doctor.findings import Finding, Verdict

_STYLES = {
    Verdict.FINE: "green",
    Verdict.WARNING: "yellow",
    Verdict.FAILED: "bold red",
    Verdict.SKIPPED: "dim",
}


def is_fine(findings: Sequence[Finding]) -> bool:
    """Whether no check has failed."""
    return all(finding.verdict is not Verdict.FAILED for finding in findings)


def print_table(findings: Sequence[Finding], console: Console) -> None:
    """One row for each finding, its cure below."""
    table = Table("check", "", "found", box=None, pad_edge=False)
    for finding in findings:
        style = _STYLES[finding.verdict]
        table.add_row(finding.name, f"[{style}]{finding.verdict}[/]", finding.text.replace("[", "\\["))
        if finding.cure and finding.verdict is not Verdict.FINE:
            table.add_row("", "", f"→ {finding.cure}".replace("[", "\\["), style="italic")
    console.print(table)


def as_json(findings: Sequence[Finding]) -> str:
    """The same for programs."""
    rows = [
        {"check": one.name, "verdict": one.verdict.value, "text": one.text, "cure": one.cure}
        for one in findings
    ]
    return msgspec.json.format(msgspec.json.encode({"ok": is_fine(findings), "findings": rows})).decode()
