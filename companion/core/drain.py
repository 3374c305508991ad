"""Taking everything out of a queue that another thread fills."""

from collections import deque
from typing import TypeVar

Item = TypeVar("Item")


def drain(queue: deque[Item]) -> list[Item]:
    """All items, oldest first, taken out; others may be added meanwhile."""
    return [queue.popleft() for _ in range(len(queue))]
