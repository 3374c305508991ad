"""The texts for people: `texts/words.en.json` has them all, `texts/words.LANGUAGE.json` in another language.

What the server says is English and carries the key of its text: a page can say it in its own language.
"""

import json
import re
from functools import cache
from pathlib import Path
from typing import Any, Final

FOLDER: Final = Path(__file__).with_name("texts")
_NAME: Final = re.compile(r"\{(\w+)\}")


class LocalizedText(str):
    """A text in English with its key and the values in it. Joined with other texts it becomes a plain str."""

    __slots__ = ("key", "values")
    key: str
    values: dict[str, Any]

    def to_page(self) -> dict[str, Any]:
        """As JSON: text, key, values."""
        return {"text": str(self), "key": self.key, "values": self.values}


@cache
def texts() -> dict[str, str]:
    """The English texts by key."""
    found: dict[str, str] = json.loads((FOLDER / "words.en.json").read_text("utf-8"))
    return found


def say(key: str, **values: str | float) -> LocalizedText:
    """The text of a key, with {names} replaced; a value may be another text that was said.

    A number is written as the reader's language does, with two digits at most after the point. A key that has
    no text is its own text.
    """

    def value_of(match: re.Match[str]) -> str:
        value = values.get(match[1], match[0])
        return value if isinstance(value, str) else f"{round(value, 2):.12g}"

    said = LocalizedText(_NAME.sub(value_of, texts().get(key, key)))
    said.key = key
    said.values = {
        name: value.to_page() if isinstance(value, LocalizedText) else value for name, value in values.items()
    }
    return said
