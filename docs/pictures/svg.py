"""A drawing in SVG: lines, boxes, texts and symbols of circuit diagrams. Pixels, y downwards."""

from html import escape

INK = "#222222"
FRAME = "#555555"


class Drawing:
    """Collects elements; `text` of the file at the end. Later elements cover earlier ones."""

    def __init__(self) -> None:
        self._elements: list[str] = []

    def line(self, *points: tuple[float, float], colour: str = INK, width: float = 2.0) -> None:
        """A line through some points."""
        path = " ".join(f"{x:g},{y:g}" for x, y in points)
        self._elements.append(
            f'<polyline points="{path}" fill="none" stroke="{colour}" stroke-width="{width:g}"/>'
        )

    def box(self, x: float, y: float, width: float, height: float, fill: str = "#f7f7f7") -> None:
        """A rectangle with rounded corners."""
        self._elements.append(
            f'<rect x="{x:g}" y="{y:g}" width="{width:g}" height="{height:g}" rx="6" fill="{fill}" '
            f'stroke="{FRAME}" stroke-width="1.5"/>'
        )

    def dot(self, x: float, y: float, colour: str, radius: float = 3.5) -> None:
        """A junction of wires."""
        self._elements.append(f'<circle cx="{x:g}" cy="{y:g}" r="{radius:g}" fill="{colour}"/>')

    def ring(self, x: float, y: float, radius: float, fill: str = "#f7f7f7", colour: str = FRAME) -> None:
        """A circle."""
        self._elements.append(
            f'<circle cx="{x:g}" cy="{y:g}" r="{radius:g}" fill="{fill}" stroke="{colour}" '
            'stroke-width="1.5"/>'
        )

    def write(
        self, x: float, y: float, words: str, anchor: str = "start", size: float = 13.0, *, bold: bool = False
    ) -> None:
        """A text whose middle is at y. anchor: start, middle or end."""
        weight = ' font-weight="bold"' if bold else ""
        self._elements.append(
            f'<text x="{x:g}" y="{y + 0.35 * size:g}" text-anchor="{anchor}" font-size="{size:g}"{weight} '
            f'fill="{INK}">{escape(words)}</text>'
        )

    def resistor(self, x: float, y: float, words: str, colour: str) -> None:
        """A resistor of 44 by 12 in a wire that runs to the right, with its value in it."""
        self._elements.append(
            f'<rect x="{x:g}" y="{y - 7:g}" width="44" height="14" fill="white" stroke="{colour}" '
            'stroke-width="1.5"/>'
        )
        self.write(x + 22, y, words, "middle", 10)

    def ground(self, x: float, y: float) -> None:
        """The symbol of ground, hanging from a wire's end."""
        self.line((x, y), (x, y + 6))
        for number, half in enumerate((8, 5, 2)):
            self.line((x - half, y + 6 + 3 * number), (x + half, y + 6 + 3 * number), width=1.5)

    def scale_bar(self, x: float, y: float, pixels_a_metre: float) -> None:
        """One metre, to the right of a point."""
        self.line((x, y - 4), (x, y), (x + pixels_a_metre, y), (x + pixels_a_metre, y - 4))
        self.write(x + 0.5 * pixels_a_metre, y - 12, "1 m", "middle", 11)

    def text(self, width: float, height: float, title: str) -> str:
        """The file."""
        head = (
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:g} {height:g}" width="{width:g}" '
            f'height="{height:g}" font-family="DejaVu Sans, Arial, sans-serif">\n'
            f"<title>{escape(title)}</title>"
        )
        background = f'<rect width="{width:g}" height="{height:g}" fill="white"/>'
        return "\n".join([head, background, *self._elements, "</svg>"]) + "\n"
