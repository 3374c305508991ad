"""The page's files: every text is in the words, nothing is fetched from elsewhere, no markup is made of data.

The first view stays small.
"""

import gzip
import json
import re
from html.parser import HTMLParser
from pathlib import Path

PAGE = Path(__file__).parents[4] / "mission_tools" / "shore" / "page"
TEXTS = PAGE.parents[1] / "station" / "texts"
SERVER = sorted(path for room in ("shore", "station") for path in (PAGE.parents[1] / room).rglob("*.py"))
MODULES = sorted(PAGE.rglob("*.js"))
WORDS: dict[str, str] = json.loads((TEXTS / "words.en.json").read_text("utf-8"))
BY_DATA = (
    "mode.", "fix.", "stage.", "state.", "calibrate.", "chart.", "sensor.", "views.", "reason.",
    "logs.event.",
)  # fmt: skip
"""Beginnings of keys that are made of a name which is not in the source."""
SAID = re.compile(r"""\bsay\(\s*"([^"]+)\"""")
IMPORT = re.compile(r'^import (.*?) from "([^"]+)"', re.MULTILINE)
KEY = re.compile(r"""["'`]([a-z]+(?:\.[a-z_0-9]+)+)["'`]""")
SMALL_BYTES = 300_000  # the first view, not packed


def keys_used() -> dict[str, str]:
    """Key by the file of page or server that uses it."""
    groups = {key.split(".")[0] for key in WORDS if "." in key}
    html = (PAGE / "index.html").read_text("utf-8")
    used = dict.fromkeys(re.findall(r'data-word(?:-label)?="([^"]+)"', html), "index.html")
    for path in SERVER:
        used |= dict.fromkeys(SAID.findall(path.read_text("utf-8")), path.name)
    for path in MODULES:
        used |= {
            key: path.name for key in KEY.findall(path.read_text("utf-8")) if key.split(".")[0] in groups
        }
    return used


class Tags(HTMLParser):
    """Every tag with its attributes, and the text inside the body."""

    def __init__(self) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.inside: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))
        if tag in ("script", "style"):
            self.inside.append(tag)

    def handle_data(self, data: str) -> None:
        assert not (self.inside and data.strip() and self.inside[-1] == self.lasttag), data


def test_every_key_that_the_page_uses_is_in_the_words() -> None:
    missing = {key: name for key, name in keys_used().items() if key not in WORDS}
    assert missing == {}


def test_every_word_is_used() -> None:
    used = keys_used()
    assert [
        key for key in WORDS if key != "language" and key not in used and not key.startswith(BY_DATA)
    ] == []


def test_no_module_makes_markup_or_code_of_text() -> None:
    makers = r'(inner|outer|Adjacent)HTML|document\.write|eval\(|Function\(|srcdoc|setAttribute\("style"'
    for path in MODULES:
        code = path.read_text("utf-8")
        assert re.findall(makers, code) == [], path.name
        assert len(code.splitlines()) <= 300, path.name


def test_the_page_needs_nothing_from_elsewhere() -> None:
    for path in [*MODULES, PAGE / "shared/style.css", PAGE / "index.html"]:
        addresses = re.findall(r"(?:https?:)?//[\w-]+\.[\w.-]+", path.read_text("utf-8"))
        assert [a for a in addresses if "www.w3.org" not in a] == [], path.name


def test_the_document_has_no_inline_script_style_or_handler_and_names_files_that_exist() -> None:
    tags = Tags()
    tags.feed((PAGE / "index.html").read_text("utf-8"))
    for tag, attributes in tags.tags:
        assert tag != "style"
        assert not [name for name in attributes if name == "style" or name.startswith("on")], (
            tag,
            attributes,
        )
        named = attributes.get("src") or (attributes.get("href") if tag == "link" else None)
        assert named is None or (PAGE / named).is_file(), named
    ids = [attributes["id"] for _, attributes in tags.tags if "id" in attributes]
    assert len(ids) == len(set(ids))


def imported(module: str) -> set[str]:
    """A module and all that it imports at once, by their paths below the page's folder."""
    path = PAGE / module
    others = [(path.parent / other).resolve() for _, other in IMPORT.findall(path.read_text("utf-8"))]
    return {module}.union(*(imported(other.relative_to(PAGE).as_posix()) for other in others))


def first_modules() -> set[str]:
    """Of the first view; the other views are fetched when they are opened."""
    return imported("main.js") | imported("shared/chart.js")


def test_every_module_of_the_first_view_is_loaded_ahead_and_not_one_after_the_other() -> None:
    html = (PAGE / "index.html").read_text("utf-8")
    ahead = re.findall(r'<link rel="modulepreload" href="([^"]+)">', html)
    assert sorted([*ahead, "main.js"]) == sorted(first_modules())


def test_the_first_view_is_small() -> None:
    names = [
        *first_modules(),
        "index.html",
        "shared/style.css",
        "shared/chart.css",
        "icon.svg",
        "words.en.json",
    ]
    contents = [((PAGE if (PAGE / name).exists() else TEXTS) / name).read_bytes() for name in names]
    packed = sum(len(gzip.compress(content, 9)) for content in contents)
    assert sum(map(len, contents)) <= SMALL_BYTES
    assert packed <= 60_000
