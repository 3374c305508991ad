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
