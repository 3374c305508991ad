"""RFC 7396 merge patches. Trees hold no None: a key that is missing is a value that is not known."""

from typing import Any

from msgspec import to_builtins

from mission_tools.station.messages import Snapshot

Tree = dict[str, Any]


def tree_of(snapshot: Snapshot) -> Tree:
    """A snapshot as JSON's types; a list is one value, and keeps its Nones."""
    tree = _without_none(to_builtins(snapshot))
    assert isinstance(tree, dict)  # noqa: S101 (a Struct is an object)
    return tree


def _without_none(value: Tree) -> Tree:
    return {
        key: _without_none(one) if isinstance(one, dict) else one
        for key, one in value.items()
        if one is not None
    }


def difference(old: Tree, new: Tree) -> Tree:
    """The patch that makes `new` of `old`; empty if they are the same."""
    patch: Tree = dict.fromkeys(key for key in old if key not in new)
    for key, value in new.items():
        before = old.get(key)
        if isinstance(value, dict) and isinstance(before, dict):
            inner = difference(before, value)
            if inner:
                patch[key] = inner
        elif before != value or key not in old:
            patch[key] = value
    return patch
