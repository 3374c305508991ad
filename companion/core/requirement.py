"""Whether the version of an installed distribution satisfies a wheel's `Requires-Dist` or `Requires-Python`.

A subset of PEP 440 and PEP 508 without a library of its own: versions of numbers with a suffix, the operators
below, and no condition but `extra`. What is outside the subset is an error, never satisfied by guess.
"""

import re
from collections.abc import Callable

from companion.core.errors import ConfigError

_REQUIREMENT = re.compile(
    r"\s*([A-Za-z0-9][\w.-]*)\s*(?:\[[^\]]*\])?\s*\(?([^;()]*)\)?\s*(?:;(.*))?", re.ASCII
)
_CLAUSE = re.compile(r"\s*(~=|===?|!=|<=|>=|<|>)\s*v?([^\s,]+)\s*", re.ASCII)
_VERSION = re.compile(
    r"(\d{1,9}(?:\.\d{1,9}){0,9})(?:[._-]?(a|b|c|rc|dev|post)\.?\d*)*(\+[\w.]+)?", re.ASCII | re.IGNORECASE
)
_BEFORE = {"a": -1, "b": -1, "c": -1, "rc": -1, "dev": -1, "post": 1}
_EXTRA = re.compile(r"(?:\(.*\)\s*and\s+|[^()]*\band\s+)?extra\s*==\s*['\"][\w.-]+['\"]\s*")

Key = tuple[tuple[int, ...], int]


def unmet_requirement(text: str, version_of: Callable[[str], str | None]) -> str | None:
    """Why a `Requires-Dist` is not satisfied, as a part of a sentence; None if it is, or is of an extra.

    version_of: the installed version of a distribution, None if there is none.

    Raises:
        ConfigError: a requirement outside the subset.
    """
    found = _REQUIREMENT.fullmatch(text)
    if found is None:
        raise ConfigError(f"requirement {text[:80]!r}: not understood; expected NAME>=VERSION")
    name, clauses, condition = found[1], found[2].strip(), (found[3] or "").strip()
    if condition:
        if _EXTRA.fullmatch(condition):
            return None
        raise ConfigError(
            f"requirement {text[:80]!r}: its condition cannot be judged; expected extra == NAME"
        )
    version = version_of(name)
    if version is None:
        return f"needs {name} {clauses}".rstrip() + ", which is not installed"
    if satisfies(version, clauses):
        return None
    return f"needs {name} {clauses}, and {version} is installed"


def satisfies(version: str, clauses: str) -> bool:
    """Whether a version satisfies all clauses, such as ">=1.2,<2". No clause: any version.

    Raises:
        ConfigError: a version or a clause outside the subset.
    """
    if not clauses.strip():
        return True
    return all(_satisfies(version, one) for one in clauses.split(","))


def _satisfies(version: str, clause: str) -> bool:
    found = _CLAUSE.fullmatch(clause)
    if found is None:
        raise ConfigError(f"version clause {clause[:40]!r}: not understood; expected such as >=1.2")
    operator, bound = found[1], found[2]
    if operator in ("==", "!=") and bound.endswith(".*"):
        return _starts_with(version, bound[:-2]) == (operator == "==")
    ours, theirs = _key(version), _key(bound)
    match operator:
        case ">=":
            return ours >= theirs
        case "<=":
            return ours <= theirs
        case ">":
            return ours > theirs
        case "<":
            return ours < theirs
        case "!=":
            return ours != theirs
        case "~=":
            return ours >= theirs and _starts_with(version, bound.rpartition(".")[0])
    return ours == theirs


def _key(version: str) -> Key:
    found = _VERSION.fullmatch(version)
    if found is None:
        raise ConfigError(f"version {version[:40]!r}: not understood; expected such as 1.2.3")
    numbers = [int(one) for one in found[1].split(".")]
    while len(numbers) > 1 and numbers[-1] == 0:
        numbers.pop()
    return tuple(numbers), _BEFORE.get((found[2] or "").lower(), 0)


def _starts_with(version: str, start: str) -> bool:
    if not start:
        raise ConfigError(f"version clause of {version[:40]!r}: expected at least two numbers after ~=")
    ours, wanted = (_VERSION.fullmatch(one) for one in (version, start))
    if ours is None or wanted is None:
        raise ConfigError(
            f"version {version[:40]!r} or {start[:40]!r}: not understood; expected such as 1.2.3"
        )
    numbers, first = ([int(one) for one in found[1].split(".")] for found in (ours, wanted))
    numbers += [0] * (len(first) - len(numbers))
    return numbers[: len(first)] == first
