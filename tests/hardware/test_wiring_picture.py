"""The wiring picture is drawn from the wiring table of the hardware page."""

import xml.etree.ElementTree as ET
from pathlib import Path

from pictures.__main__ import GUIDE, WIRING
from pictures.wiring import draw_wiring
from pictures.wiring_table import read_wiring, wiring_rows

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
