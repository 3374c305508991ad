"""An installation as a list of steps. A step that fails has the steps before it undone, in reverse order."""

from collections.abc import Callable, Sequence
from typing import Protocol

Say = Callable[[str], None]


class InstallStep(Protocol):
    """One change of the system to a wanted state, or none where the system has it already."""

    def describe(self) -> str:
        """What it does, as a sentence without a full stop."""

    def is_done(self) -> bool:
        """Whether the system is as wanted."""

    def apply(self) -> None:
        """Change the system. Leaves nothing half done if it raises.

        Raises:
            OSError: it cannot be changed.
        """

    def undo(self) -> None:
        """Restore what was there before `apply`."""


def apply_steps(steps: Sequence[InstallStep], say: Say) -> None:
    """Apply all steps, or none.

    Raises:
        OSError: the step's error, after the steps before it have been undone.
    """
    applied: list[InstallStep] = []
    try:
        for step in steps:
            if step.is_done():
                say(f"  already  {step.describe()}")
                continue
            step.apply()
            applied.append(step)
            say(f"  done     {step.describe()}")
    except BaseException:
        for step in reversed(applied):
            try:
                step.undo()
                say(f"  undone   {step.describe()}")
            except OSError as error:
                say(f"  NOT undone  {step.describe()}: {error}")
        raise


def describe_steps(steps: Sequence[InstallStep], say: Say) -> None:
    """Say what `apply_steps` would do."""
    for step in steps:
        say(f"  {'already ' if step.is_done() else 'to do   '} {step.describe()}")
