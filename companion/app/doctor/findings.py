"""What a check found out."""

from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

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
