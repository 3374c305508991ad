"""The wiring of the documented boat as a circuit diagram: the Pi on the left, its parts on the right."""

from collections.abc import Sequence
from itertools import count
from typing import Final

from pictures.svg import Drawing
from pictures.wiring_table import Wire

WIDTH: Final = 1040
_PI_X, _PI_END = 110, 400
_PART_X, _PART_END = 640, 800
_PITCH = 26  # from terminal to terminal
_LOOSE = 22  # more, below a wire with a resistor to ground
_TITLE = 34  # from a box's edge to its first terminal
_GAP = 26  # between boxes
_COLOURS: Final = ("#c0392b", "#2471a3", "#d68910", "#1e8449", "#7d3c98", "#5d6d7e", "#117a65", "#a04000")

# Terminals that no GPIO goes to, on the right of each part: name, and the supply or load
SUPPLIES: Final[dict[str, tuple[tuple[str, str], ...]]] = {
    "L298N": (
        ("+12V", "12 V"),
        ("GND", "GND"),
        ("OUT1", "left motor"),
        ("OUT2", "left motor"),
        ("OUT3", "right motor"),
        ("OUT4", "right motor"),
    ),
    "HC-SR04": (("VCC", "5 V"), ("GND", "GND")),
    "servo": (("+", "5 V"), ("−", "GND")),
    "GNSS": (("VCC", "3.3 or 5 V"), ("GND", "GND")),
    "RC receiver": (("+", "5 V"), ("−", "GND")),
    "BNO055": (("VIN", "3.3 V"), ("GND", "GND")),
    "INA219": (("VCC", "3.3 V"), ("GND", "GND"), ("Vin+", "pack"), ("Vin−", "12 V")),
}
_PI_SUPPLIES: Final = (("3.3 V", 1, "3.3 V"), ("5 V", 2, "5 V"), ("GND", 6, "GND"))


def draw_wiring(wires: Sequence[Wire]) -> str:
    """The picture, as the text of an SVG file."""
    drawing = Drawing()
    colours = dict(zip(dict.fromkeys(wire.terminals[0][0] for wire in wires), _COLOURS, strict=False))
    boxes = _boxes(wires)
    ends = {}
    y = 30.0
    for part, signals in boxes.items():
        for wire, offset in _offsets(part, signals):
            terminal = dict(wire.terminals)[part]
            ends[part, terminal] = y + _TITLE + offset
        y += _part(drawing, part, signals, y) + _GAP
    heights = [ends[wire.terminals[0]] for wire in wires]
    _pi(drawing, wires, heights, colours)
    lanes = count(560, 14)
    for wire, height in zip(wires, heights, strict=True):
        _wire(drawing, wire, height, colours[wire.terminals[0][0]])
        for other in wire.terminals[1:]:
            _branch(drawing, height, ends[other], next(lanes), colours[wire.terminals[0][0]])
    bottom = _power(drawing, y + 10)
    return drawing.text(WIDTH, bottom, "Wiring of the boat: Raspberry Pi, motors, sensors and supply")


def _boxes(wires: Sequence[Wire]) -> dict[str, list[Wire]]:
    """The wires of each part, in the order of the table."""
    boxes: dict[str, list[Wire]] = {}
    for wire in wires:
        for part, _ in wire.terminals:
            if part not in SUPPLIES:
                raise LookupError(f"GPIO {wire.bcm}: no part {part!r} in this drawing")
            boxes.setdefault(part, []).append(wire)
    return boxes


def _offsets(part: str, wires: Sequence[Wire]) -> list[tuple[Wire, float]]:
    """Distances from the first terminal of a part."""
    offsets, y = [], 0.0
    for wire in wires:
        offsets.append((wire, y))
        is_first = wire.terminals[0][0] == part
        y += _PITCH + (_LOOSE if is_first and (wire.pull_down or wire.has_divider) else 0.0)
    return offsets


def _part(drawing: Drawing, part: str, wires: Sequence[Wire], y: float) -> float:
    """Draw a part's box and supplies; its height."""
    offsets = _offsets(part, wires)
    rows = max(offsets[-1][1] + _PITCH, _PITCH * len(SUPPLIES[part]))
    height = _TITLE + rows - 6
    drawing.box(_PART_X, y, _PART_END - _PART_X, height)
    drawing.write((_PART_X + _PART_END) / 2, y + 14, part, "middle", 14, bold=True)
    for wire, offset in offsets:
        drawing.write(_PART_X + 8, y + _TITLE + offset, dict(wire.terminals)[part])
    loads: dict[str, list[float]] = {}
    for number, (terminal, net) in enumerate(SUPPLIES[part]):
        at = y + _TITLE + _PITCH * number
        drawing.write(_PART_END - 8, at, terminal, "end")
        if net.endswith("motor"):
            loads.setdefault(net, []).append(at)
        else:
            _net(drawing, _PART_END, at, net, 1)
    for load, (first, second) in loads.items():
        _motor(drawing, load, first, second)
    return height


def _motor(drawing: Drawing, name: str, first: float, second: float) -> None:
    x, middle = _PART_END + 70, (first + second) / 2
    for at in (first, second):
        drawing.line((_PART_END, at), (x, at))
    drawing.ring(x, middle, 20)
    drawing.write(x, middle, "M", "middle", 16, bold=True)
    drawing.write(x + 28, middle, name)


def _net(drawing: Drawing, x: float, y: float, net: str, side: int) -> None:
    """A short wire to a supply, named, or to ground. side: 1 to the right, -1 to the left."""
    end = x + 26 * side
    drawing.line((x, y), (end, y))
    if net == "GND":
        drawing.ground(end, y)
        return
    drawing.line((end, y - 6), (end, y + 6), width=3)
    drawing.write(end + 7 * side, y, net, "start" if side > 0 else "end", bold=True)


def _pi(drawing: Drawing, wires: Sequence[Wire], heights: Sequence[float], colours: dict[str, str]) -> None:
    """The Pi: its header with the pins in use in colour, and a row for each wire."""
    top, bottom = 30.0, max(heights) + 30
    drawing.box(_PI_X, top, _PI_END - _PI_X, bottom - top, "#eef6ee")
    drawing.write(_PI_X + 14, top + 18, "Raspberry Pi", size=15, bold=True)
    used = {wire.header_pin: colours[wire.terminals[0][0]] for wire in wires}
    used |= {pin: "#222222" for _, pin, _ in _PI_SUPPLIES}
    for pin in range(1, 41):
        x, y = _PI_X + 60 + 20 * ((pin - 1) % 2), top + 210 + 17 * ((pin - 1) // 2)
        drawing.dot(x, y, used.get(pin, "#cfcfcf"), 6)
        drawing.write(x + (14 if pin % 2 == 0 else -14), y, str(pin), "start" if pin % 2 == 0 else "end", 10)
    drawing.write(_PI_X + 70, top + 190, "header", "middle", 11)
    for number, (name, pin, net) in enumerate(_PI_SUPPLIES):
        y = top + 60 + 34 * number
        _net(drawing, _PI_X, y, net, -1)
        drawing.write(_PI_X + 8, y, f"{name} · pin {pin}")
    for wire, y in zip(wires, heights, strict=True):
        drawing.write(_PI_END - 8, y, f"GPIO {wire.bcm} · pin {wire.header_pin}", "end")


def _wire(drawing: Drawing, wire: Wire, y: float, colour: str) -> None:
    """From the Pi to the first part, with its resistors."""
    drawing.line((_PI_END, y), (_PART_X, y), colour=colour)
    if not (wire.pull_down or wire.has_divider):
        return
    x, below = _PI_END + 40, y + 22
    drawing.dot(x, y, colour)
    drawing.line((x, y), (x, below), (x + 82, below), colour=colour)
    drawing.resistor(x + 20, below, wire.pull_down or "2 kΩ", colour)
    drawing.ground(x + 82, below)
    if wire.has_divider:
        drawing.resistor(x + 110, y, "1 kΩ", colour)


def _branch(drawing: Drawing, y: float, end: float, x: float, colour: str) -> None:
    """From a wire to the same terminal of another part."""
    drawing.dot(x, y, colour)
    drawing.line((x, y), (x, end), (_PART_X, end), colour=colour)


def _power(drawing: Drawing, y: float) -> float:
    """The supply: pack, fuse, switch, shunt and converter; returns the picture's height."""
    middle = y + 40
    drawing.box(110, y, 130, 70)
    drawing.write(175, middle - 14, "3S LiPo", "middle", 14, bold=True)
    drawing.write(175, middle + 8, "11.1 V", "middle")
    drawing.write(232, y + 14, "+", "end")
    drawing.write(118, y + 60, "−")
    drawing.line((110, y + 60), (90, y + 60))
    drawing.ground(90, y + 60)
    line = y + 14
    drawing.line((240, line), (330, line), (372, line - 14))  # the switch is open in the drawing
    drawing.line((376, line), (430, line))
    drawing.resistor(262, line, "5 A", "#222222")
    drawing.write(284, line + 20, "fuse", "middle", 11)
    drawing.dot(332, line, "#222222")
    drawing.dot(376, line, "#222222")
    drawing.write(354, line + 20, "switch", "middle", 11)
    _net(drawing, 404, line, "pack", 1)
    drawing.box(_PART_X, y, _PART_END - _PART_X, 70)
    drawing.write((_PART_X + _PART_END) / 2, y + 14, "5 V converter, 3 A", "middle", 13, bold=True)
    drawing.write(_PART_X + 8, y + 40, "in")
    drawing.write(_PART_END - 8, y + 40, "out", "end")
    drawing.write(_PART_X + 8, y + 60, "GND")
    _net(drawing, _PART_X, y + 40, "12 V", -1)
    drawing.line((_PART_X, y + 60), (_PART_X - 26, y + 60))
    drawing.ground(_PART_X - 26, y + 60)
    _net(drawing, _PART_END, y + 40, "5 V", 1)
    notes = (
        "Wires to the same name are connected: pack, 12 V (measured by the INA219), 5 V, 3.3 V, ground.",
        "Enable jumpers of the L298N off, its 5 V jumper on.",
    )
    for number, note in enumerate(notes):
        drawing.write(110, y + 100 + 20 * number, note, size=12)
    return y + 140
