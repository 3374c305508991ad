"""TOML from untrusted sources: pathological input is an error, not a hang or a traceback."""

import re
import tomllib
from typing import Any

_MOST_LEVELS = 32  # of nested tables and lists; our files need six at most
# Python's parser is quadratic in the length of a dotted key. (The look-behind and the possessive repetitions
# keep this search linear.)
_LONG_KEY = re.compile(rf"(?<![\w\-\"'])(?:[\w\-\"']++[ \t]*+\.[ \t]*+){{{_MOST_LEVELS}}}")


def parse_toml(text: str) -> dict[str, Any]:
    """Parse TOML into plain values.
    Raises ValueError: not TOML (names the line), nested too deeply, or a number with too many digits.
    """
    if _LONG_KEY.search(text):
        raise ValueError("nesting is too deep")
    try:
        tree = tomllib.loads(text)
    except RecursionError:
        raise ValueError("nesting is too deep") from None
    except ValueError as error:
        if type(error) is ValueError:  # an integer beyond 4300 digits
            raise ValueError("a number has too many digits") from None
        raise
    level: list[Any] = [tree]
    for _ in range(_MOST_LEVELS):
        level = [below for one in level for below in (one.values() if isinstance(one, dict) else one)]
        level = [one for one in level if isinstance(one, dict | list)]
        if not level:
            return tree
    raise ValueError("nesting is too deep")
