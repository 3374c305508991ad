"""Work that is done a part at a time: a generator that yields between parts, and returns the result."""

from collections.abc import Generator
from typing import TypeVar

Result = TypeVar("Result")


def finished(parts: Generator[None, None, Result]) -> Result:
    """The result, with all parts done at once."""
    while True:
        try:
            next(parts)
        except StopIteration as end:
            result: Result = end.value
            return result
