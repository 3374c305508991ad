"""The wiring picture is drawn from the wiring table of the hardware page."""

import xml.etree.ElementTree as ET
from pathlib import Path

import pytest
from pictures.__main__ import GUIDE, WIRING
from pictures.wiring import WIDTH, draw_wiring
from pictures.wiring_table import Wire, read_wiring, wiring_rows

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / GUIDE).read_text(encoding="utf-8")
WIRES = read_wiring(PAGE)
SVG = "{http://www.w3.org/2000/svg}"


def texts(picture: str) -> list[str]:
    return [element.text or "" for element in ET.fromstring(picture).iter(f"{SVG}text")]  # noqa: S314 (ours)


def test_the_picture_is_of_todays_table() -> None:
    """If not: python -m pictures"""
    assert (ROOT / WIRING).read_text(encoding="utf-8") == draw_wiring(WIRES)
    assert f"]({WIRING.relative_to('docs')})" in PAGE


def test_every_row_of_the_table_is_in_the_picture() -> None:
    written = texts(draw_wiring(WIRES))
    assert len(WIRES) == len(wiring_rows(PAGE)) == 14
    for wire in WIRES:
        assert written.count(f"GPIO {wire.bcm} · pin {wire.header_pin}") == 1
        for part, terminal in wire.terminals:
            assert part in written
            assert terminal in written
    assert written.count("10 kΩ") == sum(bool(wire.pull_down) for wire in WIRES) == 2
    assert written.count("1 kΩ") == written.count("2 kΩ") == sum(wire.has_divider for wire in WIRES) == 1


def test_another_pin_is_another_picture() -> None:
    page = PAGE.replace("| 23 | 16 | HC-SR04 TRIG", "| 22 | 15 | HC-SR04 TRIG")
    changed = draw_wiring(read_wiring(page))
    assert "GPIO 22 · pin 15" in texts(changed)
    assert changed != draw_wiring(WIRES)


@pytest.mark.parametrize(
    ("cell", "terminals", "pull_down", "has_divider"),
    [
        ("L298N ENA (jumper off), 10 kΩ to ground", (("L298N", "ENA"),), "10 kΩ", False),
        ("HC-SR04 ECHO, **through the divider**", (("HC-SR04", "ECHO"),), "", True),
        ("GNSS RX: sets the receiver up", (("GNSS", "RX"),), "", False),
        ("RC receiver's output (optional)", (("RC receiver", "output"),), "", False),
        ("SDA of BNO055 and INA219", (("BNO055", "SDA"), ("INA219", "SDA")), "", False),
    ],
)
def test_a_cell_names_part_terminal_and_resistors(
    cell: str, terminals: tuple[tuple[str, str], ...], pull_down: str, has_divider: bool
) -> None:
    assert read_wiring(f"| 4 | 7 | {cell} | |\n") == [Wire(4, 7, terminals, pull_down, has_divider)]


def test_a_part_without_supplies_is_an_error() -> None:
    with pytest.raises(LookupError, match="GPIO 4: no part 'laser'"):
        draw_wiring([Wire(4, 7, (("laser", "TX"),))])


def test_nothing_lies_outside_the_picture() -> None:
    root = ET.fromstring(draw_wiring(WIRES))  # noqa: S314 (ours)
    height = float(root.attrib["height"])
    for element in root:
        for x, y in (("x", "y"), ("cx", "cy")):
            if x in element.attrib:
                assert 0 <= float(element.attrib[x]) <= WIDTH - 20
                assert 0 <= float(element.attrib[y]) <= height
