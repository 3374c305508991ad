"""An installation as a list of steps. A step that fails has the steps before it undone, in reverse order."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

Say = Callable[[str], None]


@dataclass(slots=True)
class InstallStep:
    """One change of the system to a wanted state, or none where the system has it already.

    text: what it does, as a sentence without a full stop. apply: leaves nothing half done if it raises
    OSError. undo: restores what was there before `apply`.
    """

    text: str
    is_done: Callable[[], bool]
    apply: Callable[[], object]
    undo: Callable[[], object]


def apply_steps(steps: Sequence[InstallStep], say: Say) -> None:
    """Apply all steps, or none.

    Raises:
        OSError: the step's error, after the steps before it have been undone.
    """
    applied: list[InstallStep] = []
    try:
        for step in steps:
            if step.is_done():
                say(f"  already  {step.text}")
                continue
            step.apply()
            applied.append(step)
            say(f"  done     {step.text}")
    except BaseException:
        for step in reversed(applied):
            try:
                step.undo()
                say(f"  undone   {step.text}")
            except OSError as error:
                say(f"  NOT undone  {step.text}: {error}")
        raise


def describe_steps(steps: Sequence[InstallStep], say: Say) -> None:
    """Say what `apply_steps` would do."""
    for step in steps:
        say(f"  {'already ' if step.is_done() else 'to do   '} {step.text}")
