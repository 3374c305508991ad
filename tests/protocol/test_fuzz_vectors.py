"""What fuzzing has found worth keeping is heard again: nothing raises, nothing hangs."""

import pytest
from fuzz import corpus
from fuzz.targets import TARGETS


@pytest.mark.parametrize("name", list(TARGETS))
def test_every_kept_input_is_taken_in_stride(name: str) -> None:
    inputs = corpus.load(name)
    assert inputs, "no corpus is committed for this target"
    for data in inputs:
        TARGETS[name](data)


def test_the_kept_inputs_are_small() -> None:
    assert sum(path.stat().st_size for path in corpus.FOLDER.glob("*.txt")) <= 1_000_000
