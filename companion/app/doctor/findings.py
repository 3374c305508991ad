"""What a check found out, and the report of it as a table or as JSON."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

import msgspec
from rich.console import Console
from rich.table import Table

from companion.app.install.steps import InstallStep
from companion.app.install.target import Target
from companion.config.boat_config import BoatConfig


class Verdict(StrEnum):
    """FAILED: the boat cannot sail like this. SKIPPED: nothing to check."""

    FINE = "fine"
    WARNING = "warning"
    FAILED = "failed"
    SKIPPED = "skipped"


@dataclass(frozen=True, slots=True)
class Finding:
    """One line of the report. cure: what to do about it. fix: the steps of `--fix` that do it."""

    name: str
    verdict: Verdict
    text: str
    cure: str = ""
    fix: tuple[InstallStep, ...] = ()


def fine(name: str, text: str, cure: str = "") -> Finding:
    """Nothing to do, but for what only a person can see."""
    return Finding(name, Verdict.FINE, text, cure)


def warning(name: str, text: str, cure: str = "", *fix: InstallStep) -> Finding:
    """The boat sails, though not as it should."""
    return Finding(name, Verdict.WARNING, text, cure, fix)


def failed(name: str, text: str, cure: str = "", *fix: InstallStep) -> Finding:
    """The boat cannot sail like this."""
    return Finding(name, Verdict.FAILED, text, cure, fix)


def skipped(name: str, text: str, cure: str = "") -> Finding:
    """Nothing was checked."""
    return Finding(name, Verdict.SKIPPED, text, cure)


@dataclass(frozen=True, slots=True)
class Examined:
    """The computer and its boat. All files of the system are read through the target's root."""

    target: Target
    config: BoatConfig

    def read(self, path: str) -> str | None:
        """A file's text without the kernel's final zero or line end; None without such a file."""
        try:
            return self.path(path).read_text(encoding="utf-8", errors="replace").strip("\0\n")
        except OSError:
            return None

    def path(self, path: str) -> Path:
        """Where a path of the system lies here."""
        return self.target.path(Path(path))

    @property
    def model(self) -> str:
        """The Raspberry Pi's model, such as `Raspberry Pi 4 Model B Rev 1.4`; empty on other computers."""
        model = self.read("/proc/device-tree/model") or ""
        return model if model.startswith("Raspberry Pi") else ""


_STYLES = {
    Verdict.FINE: "green",
    Verdict.WARNING: "yellow",
    Verdict.FAILED: "bold red",
    Verdict.SKIPPED: "dim",
}


def is_fine(findings: Sequence[Finding]) -> bool:
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
