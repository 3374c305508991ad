"""The colours: text is readable by day and by night, and what carries meaning is told apart by everybody."""

import math
import re
from itertools import combinations
from pathlib import Path

import pytest

PAGE = Path(__file__).parents[4] / "mission_tools" / "shore" / "page"
CHART = (PAGE / "shared" / "chart-colours.js").read_text("utf-8")
READABLE = 4.5  # WCAG 2.1, 1.4.3: text; 1.4.11: 3 for what is drawn
SEEN = 3.0
APART = 12.0  # CIE 1976 difference; 2.3 is just noticeable
# Machado, Oliveira and Fernandes 2009, severity 1.0, on linear RGB
BLIND = {
    "protanopia": (
        (0.152286, 1.052583, -0.204868),
        (0.114503, 0.786281, 0.099216),
        (-0.003882, -0.048116, 1.051998),
    ),
    "deuteranopia": (
        (0.367322, 0.860646, -0.227968),
        (0.280085, 0.672501, 0.047413),
        (-0.011820, 0.042940, 0.968881),
    ),
    "none": ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)),
}
# Beside each other on the water; the exclusion's line is dotted and filled
LINES = ("route", "track", "fence")
FILLS = ("water", "land")
HULLS = ("hull", "route", "unheard")  # disarmed, armed, not heard

Rgb = tuple[float, float, float]


def linear(colour: str) -> Rgb:
    """Of a colour as #rgb or #rrggbb."""
    digits = colour.removeprefix("#")
    digits = "".join(2 * digit for digit in digits) if len(digits) == 3 else digits
    parts = [int(digits[at : at + 2], 16) / 255.0 for at in (0, 2, 4)]
    red, green, blue = (one / 12.92 if one <= 0.04045 else ((one + 0.055) / 1.055) ** 2.4 for one in parts)
    return red, green, blue


def contrast(one: str, other: str) -> float:
    """WCAG 2.1."""
    lights = [0.2126 * r + 0.7152 * g + 0.0722 * b for r, g, b in (linear(one), linear(other))]
    return (max(lights) + 0.05) / (min(lights) + 0.05)


def lab(colour: str, blindness: str) -> Rgb:
    """CIELAB, D65, as somebody sees it."""
    seen = linear(colour)
    r, g, b = (
        min(max(sum(share * part for share, part in zip(row, seen, strict=True)), 0.0), 1.0)
        for row in BLIND[blindness]
    )
    x = (0.4124 * r + 0.3576 * g + 0.1805 * b) / 0.95047
    y = 0.2126 * r + 0.7152 * g + 0.0722 * b
    z = (0.0193 * r + 0.1192 * g + 0.9505 * b) / 1.08883
    fx, fy, fz = (t ** (1 / 3) if t > 0.008856 else 7.787 * t + 16.0 / 116.0 for t in (x, y, z))
    return 116.0 * fy - 16.0, 500.0 * (fx - fy), 200.0 * (fy - fz)


def difference(one: str, other: str, blindness: str) -> float:
    pairs = zip(lab(one, blindness), lab(other, blindness), strict=True)
    return math.sqrt(sum((a - b) ** 2 for a, b in pairs))


def chart(name: str) -> dict[str, str]:
    """The plain colours of the chart by day or by night."""
    match = re.search(rf"const {name} = \{{(.*?)\}};", CHART, re.DOTALL)
    assert match is not None
    return dict(re.findall(r'(\w+): "(#[0-9a-f]{6})"', match[1]))


@pytest.mark.parametrize("light", ["DAY", "NIGHT"])
def test_lines_are_seen_on_water_and_letters_on_their_card(light: str) -> None:
    known = chart(light)
    assert {
        name: contrast(known[name], known["halo"])
        for name in LINES
        if contrast(known[name], known["halo"]) < SEEN
    } == {}
    assert contrast(known["ink"], known["card"]) >= READABLE
    assert contrast(known["ink"], known["halo"]) >= READABLE


@pytest.mark.parametrize("blindness", BLIND)
@pytest.mark.parametrize("light", ["DAY", "NIGHT"])
@pytest.mark.parametrize("group", [LINES, FILLS, HULLS], ids=["lines", "fills", "hulls"])
def test_what_carries_meaning_is_told_apart(group: tuple[str, ...], light: str, blindness: str) -> None:
    known = chart(light)
    near = {
        (one, other): round(difference(known[one], known[other], blindness), 1)
        for one, other in combinations(group, 2)
        if difference(known[one], known[other], blindness) < APART
    }
    assert near == {}
