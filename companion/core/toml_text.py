"""TOML from strangers: what cannot be meant is an error at once, not a hang or a traceback."""

import re
import tomllib
from typing import Any

_MOST_LEVELS = 32  # of tables and lists within each other; no file of ours needs more than six
# Python's reader takes time with the square of a dotted key's length. (The look-behind and the possessive
# repetitions keep this search linear.)
_LONG_KEY = re.compile(rf"(?<![\w\-\"'])(?:[\w\-\"']++[ \t]*+\.[ \t]*+){{{_MOST_LEVELS}}}")


def parse_toml(text: str) -> dict[str, Any]:
    """Read TOML into plain values.

    Raises:
        ValueError: it is not TOML (names the line), nests too deep, or has a number with too many digits.
    """
    if _LONG_KEY.search(text):
        raise ValueError("nesting is too deep")
    try:
        tree = tomllib.loads(text)
    except RecursionError:
        raise ValueError("nesting is too deep") from None
    except ValueError as error:
        if type(error) is ValueError:  # Python's own, of a whole number beyond 4300 digits
            raise ValueError("a number has too many digits") from None
        raise
    level: list[Any] = [tree]
    for _ in range(_MOST_LEVELS):
        level = [below for one in level for below in (one.values() if isinstance(one, dict) else one)]
        level = [one for one in level if isinstance(one, dict | list)]
        if not level:
            return tree
    raise ValueError("nesting is too deep")
