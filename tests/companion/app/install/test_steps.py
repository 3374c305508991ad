"""An installation is done wholly or not at all."""

import pytest

from companion.app.install.steps import apply_steps, describe_steps


class Recorded:
    """A step that records its calls."""

    def __init__(self, record: list[str], name: str, *, is_done: bool = False, fails: str = "") -> None:
        self._record, self._name, self._is_done, self._fails = record, name, is_done, fails

    def describe(self) -> str:
        return self._name

    def is_done(self) -> bool:
        return self._is_done

    def apply(self) -> None:
        self._call("apply")

    def undo(self) -> None:
        self._call("undo")

    def _call(self, verb: str) -> None:
        self._record.append(f"{verb} {self._name}")
        if verb == self._fails:
            raise OSError(f"{self._name} fails")


def test_steps_are_applied_in_order_and_those_already_done_left_out() -> None:
    record: list[str] = []
    said: list[str] = []
    steps = [Recorded(record, "a"), Recorded(record, "b", is_done=True), Recorded(record, "c")]
    apply_steps(steps, said.append)
    assert record == ["apply a", "apply c"]
    assert said == ["  done     a", "  already  b", "  done     c"]


def test_a_step_that_fails_has_the_steps_before_it_undone_last_first() -> None:
    record: list[str] = []
    said: list[str] = []
    steps = [
        Recorded(record, "a"),
        Recorded(record, "b", is_done=True),
        Recorded(record, "c", fails="undo"),
        Recorded(record, "d", fails="apply"),
        Recorded(record, "e"),
    ]
    with pytest.raises(OSError, match="d fails"):
        apply_steps(steps, said.append)
    assert record == ["apply a", "apply c", "apply d", "undo c", "undo a"]
    assert said[-2:] == ["  NOT undone  c: c fails", "  undone   a"]


def test_a_dry_run_calls_nothing() -> None:
    record: list[str] = []
    said: list[str] = []
    describe_steps([Recorded(record, "a"), Recorded(record, "b", is_done=True)], said.append)
    assert record == []
    assert said == ["  to do    a", "  already  b"]
