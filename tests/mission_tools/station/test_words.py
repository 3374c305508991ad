"""The words: one file holds every text, and what the server says can be said in another language."""

import ast
import json
import re
from functools import cache
from pathlib import Path

import pytest

from mission_tools.shore.web.feed import encode
from mission_tools.shore.web.static_files import read_files
from mission_tools.station.messages import Answer
from mission_tools.station.reasons import words as reason_words
from mission_tools.station.words import FOLDER, say, texts

FILES = sorted(FOLDER.glob("words.*.json"))
ROOMS = (FOLDER.parent, FOLDER.parents[1] / "shore")
SOURCES = sorted(path for room in ROOMS for path in room.rglob("*.py"))
NAMES = re.compile(r"\{(\w+)\}")
TO_PAGE: dict[str, tuple[int | str, ...]] = {
    "Answer": ("text",),
    "BadRequestError": (0,),
    "Blocked": (0,),
    "Refused": (0,),
    "error": (1, 2),
}


@cache
def calls() -> list[tuple[Path, str, ast.Call]]:
    """Every call in the sources, with its file and the function's name."""
    return [
        (path, getattr(node.func, "id", getattr(node.func, "attr", "")), node)
        for path in SOURCES
        for node in ast.walk(ast.parse(path.read_text("utf-8")))
        if isinstance(node, ast.Call)
    ]


def test_a_text_is_found_by_its_key_and_its_values_are_put_in() -> None:
    assert say("answer.hold") == "The boat keeps its place"
    assert say("answer.speed", n=1.25) == "The speed is now 1.25 m/s"
    assert say("answer.never_heard", n=3) == "Boat 3 was never heard"
    assert say("answer.no_such_key") == "answer.no_such_key"
    for number, written in ((2.0, "2"), (0.1 + 0.2, "0.3"), (1234567.0, "1234567")):
        assert say("answer.no_speed", n=number).startswith(f"{written} m/s")


def test_a_said_text_in_a_result_crosses_the_wire() -> None:
    told = json.loads(encode(Answer(id="1", ok=False, result={"why": say("way.none")})))
    assert told["result"]["why"]["key"] == "way.none"
    with pytest.raises(TypeError, match="complex"):
        encode(Answer(id="1", ok=False, result=1j))


def test_what_the_server_says_is_in_the_words_with_the_values_that_it_gives() -> None:
    said = [(path.name, call) for path, name, call in calls() if name == "say"]
    assert len(said) > 150
    for file, call in said:
        where = f"{file}, line {call.lineno}"
        assert isinstance(call.args[0], ast.Constant), f"{where}: expected a key, written out"
        key = call.args[0].value
        assert key in texts(), f"{where}: {key!r}"
        assert {one.arg for one in call.keywords} == set(NAMES.findall(texts()[str(key)])), key


def test_no_text_for_the_page_is_written_in_the_source() -> None:
    written = []
    for path, name, call in calls():
        for place in TO_PAGE.get(name, ()):
            given = [one.value for one in call.keywords if one.arg == place]
            if isinstance(place, int):
                given = call.args[place : place + 1]
            written += [
                (path.name, one.lineno, ast.unparse(one))
                for one in given
                if isinstance(one, ast.JoinedStr | ast.BinOp)
                or (isinstance(one, ast.Constant) and re.search("[A-Za-z]{3} ", str(one.value)))
            ]
    assert written == []


def test_every_reason_has_both_its_texts_and_every_text_its_reason() -> None:
    keys = {entry.key for entry in reason_words().values()}
    told = {key for key in texts() if key.startswith("reason.")}
    assert told == {f"reason.{key}.{part}" for key in keys for part in ("why", "next")}


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.name)
def test_every_language_has_each_text_with_the_same_values(path: Path) -> None:
    known = json.loads(path.read_text("utf-8"))
    assert known["language"] == path.name.split(".")[1]
    assert known.keys() == texts().keys()
    for key, text in known.items():
        assert sorted(NAMES.findall(text)) == sorted(NAMES.findall(texts()[key])), key


def test_the_document_tells_which_languages_the_server_has(tmp_path: Path) -> None:
    html = '<html lang="en" data-languages="en"><p>'
    for name, content in {"index.html": html, "words.en.json": "{}", "words.pt-BR.json": "{}"}.items():
        (tmp_path / name).write_text(content, encoding="utf-8")
    files = read_files(tmp_path)
    assert files[""].plain == b'<html lang="en" data-languages="en pt-BR"><p>'
    assert files["index.html"] == files[""]
    assert read_files(FOLDER, ROOMS[1] / "page")[""].plain.count(b'data-languages="en"') == 1
