"""Complaints of the boat's own check, and the line of the text that each is about."""

import time

import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.app.composition import check_config
from companion.config.boat_config import decode_config
from companion.core.errors import ConfigError
from companion.core.toml_text import parse_toml
from companion.shore.board.toml_lines import line_of

BOAT = """\
external.heading = 2 # links = ["a comment"]
links = [
    "tcpin:127.0.0.1:5760", # ] in a comment
    { url = "udpin:0.0.0.0:14550", name = "one # two", allow = [
        "ATTITUDE",
    ] },
]
parts.motors.driver = "l298n"
parts.gnss = { driver = "ubx" }

[heading]
kp = 1.0

[identity]
'system_id' = 1
[[payload]]
kind = "relay"
number = 1
pin = 10
[[payload]]
kind = "relay"
number = 2
pin = 11
"""


def complaint(text: str) -> str:
    """What the boat says of it."""
    with pytest.raises(ConfigError) as caught:  # noqa: PT012 (either of them complains)
        try:
            tree = parse_toml(text)
        except ValueError as error:
            raise ConfigError(f"not a TOML file: {error}") from None
        check_config(decode_config(tree, "boat.toml"))
    return str(caught.value)


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [
        ("kp = 1.0", 'kp = "much"', 12),
        ("kp = 1.0", "kp = ", 12),
        ("kp = 1.0", "kp = 1.0\nkq = 2.0", 13),
        ("[identity]", "[identities]", 14),
        ("'system_id' = 1", "'system_id' = 700", 15),
        ('"ATTITUDE"', '"ATTITUDES"', 4),
        ('"tcpin:127.0.0.1:5760"', "5760", 3),
        ('name = "one # two"', "name = 7", 4),
        ("l298n", "l299n", 8),
        ('"ubx"', "5", 9),
        ("pin = 11", "pin = 600", 23),
        ("pin = 11", "", 20),
        ('links = [\n    "tcpin:127.0.0.1:5760",', 'links = [\n    "tcpin:127.0.0.1:5760"', 4),
    ],
)
def test_the_line_of_what_the_boat_complains_of(old: str, new: str, line: int) -> None:
    assert BOAT.count(old) == 1
    text = BOAT.replace(old, new)
    assert line_of(complaint(text), text) == line


def test_a_key_that_is_not_there_is_complained_of_at_its_table() -> None:
    text = '[parts.motors]\nleft_enable = 5\n[parts.gnss]\ndriver = "ubx"\n'
    assert line_of("parts.motors.driver: the boat cannot sail without", text) == 1


def test_a_text_that_ends_too_early_is_complained_of_at_its_end() -> None:
    text = 'links = [\n  "tcpin:127.0.0.1:0",\n\n'
    assert line_of(complaint(text), text) == 3


@pytest.mark.parametrize(
    "said", ["", "no room on the disk", "Object is a teapot - at `$`", "port 'x': unknown"]
)
def test_a_complaint_without_a_key_names_no_line(said: str) -> None:
    assert line_of(said, BOAT) is None


@given(st.text(alphabet="a.=[]{},\"'#\n \\1", max_size=80))
def test_any_text_has_an_end(text: str) -> None:
    found = line_of("Expected `int` - at `$.a.a[1].a`", text)
    assert found is None or 1 <= found <= text.count("\n") + 1


@pytest.mark.parametrize(
    "text",
    [
        "[" * 64_000,
        "a=" + "[" * 60_000,
        "a=" + "{a=" * 20_000,
        'a="' + "\\" * 63_000,
        "a." * 32_000,
        "'''" * 21_000,
        "\n" * 64_000,
        '"""\\' * 16_000,
    ],
)
def test_no_text_of_the_largest_size_takes_long(text: str) -> None:
    began_s = time.process_time()
    line_of("Expected `int` - at `$.b`", text)
    assert time.process_time() - began_s < 1.0
