"""Stored lists that were found damaged at the start: repeated to the operator until they are replaced."""

from typing import Final

FENCE: Final = "fence"
FIRST_S: Final = 5.0  # since boot, as for PreArm lines: stations need a moment to connect
REPEAT_S: Final = 30.0


class Losses:
    """One line for each stored list that is lost, by its name."""

    def __init__(self) -> None:
        self._texts: dict[str, str] = {}
        self._due_s = FIRST_S

    def add(self, name: str, what: str, remedy: str) -> None:
        """A stored list is lost. what: what is wrong, and what is in use instead; remedy: what ends it."""
        self._texts[name] = f"{name[0].upper()}{name[1:]} lost: {what}. {remedy}"

    def end(self, name: str) -> None:
        """The operator has replaced it."""
        self._texts.pop(name, None)

    def text(self, name: str) -> str:
        """The line about a list; empty when it is not lost."""
        return self._texts.get(name, "")

    def update(self, now_s: float) -> list[str]:
        """What to tell now."""
        if not self._texts or now_s < self._due_s:
            return []
        self._due_s = now_s + REPEAT_S
        return list(self._texts.values())
