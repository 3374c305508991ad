"""Stored lists found damaged at the start; reported repeatedly until replaced."""

from typing import Final

FENCE: Final = "fence"
FIRST_S: Final = 5.0  # since boot, as for PreArm reports: stations need time to connect
REPEAT_S: Final = 30.0


class DataLosses:
    """A message for each lost list, by name."""

    def __init__(self) -> None:
        self._texts: dict[str, str] = {}
        self._due_s = FIRST_S

    def add(self, name: str, what: str, remedy: str) -> None:
        """Add a lost list. what: the damage, and what is used instead; remedy: what ends the report."""
        self._texts[name] = f"{name[0].upper()}{name[1:]} lost: {what}. {remedy}"

    def end(self, name: str) -> None:
        """The list was replaced."""
        self._texts.pop(name, None)

    def text(self, name: str) -> str:
        """The message about a list; empty if it is not lost."""
        return self._texts.get(name, "")

    def update(self, now_s: float) -> list[str]:
        """The messages due now."""
        if not self._texts or now_s < self._due_s:
            return []
        self._due_s = now_s + REPEAT_S
        return list(self._texts.values())
