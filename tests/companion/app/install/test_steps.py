"""An installation is done wholly or not at all."""

import pytest

from companion.app.install.steps import InstallStep, apply_steps


def recorded(record: list[str], name: str, *, is_done: bool = False, fails: str = "") -> InstallStep:
    """A step that records its calls."""

    def call(verb: str) -> None:
        record.append(f"{verb} {name}")
        if verb == fails:
            raise OSError(f"{name} fails")

    return InstallStep(name, lambda: is_done, lambda: call("apply"), lambda: call("undo"))


def test_steps_are_applied_in_order_and_those_already_done_left_out() -> None:
    record: list[str] = []
    said: list[str] = []
    steps = [recorded(record, "a"), recorded(record, "b", is_done=True), recorded(record, "c")]
    apply_steps(steps, said.append)
    assert record == ["apply a", "apply c"]
    assert said == ["  done     a", "  already  b", "  done     c"]


def test_a_step_that_fails_has_the_steps_before_it_undone_last_first() -> None:
    record: list[str] = []
    said: list[str] = []
    steps = [
        recorded(record, "a"),
        recorded(record, "b", is_done=True),
        recorded(record, "c", fails="undo"),
        recorded(record, "d", fails="apply"),
        recorded(record, "e"),
    ]
    with pytest.raises(OSError, match="d fails"):
        apply_steps(steps, said.append)
    assert record == ["apply a", "apply c", "apply d", "undo c", "undo a"]
    assert said[-2:] == ["  NOT undone  c: c fails", "  undone   a"]
