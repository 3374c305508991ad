"""A self-contained page of HTML: pictures are embedded, and there is no script."""

import base64
import html
import io
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Literal

import matplotlib as mpl
from matplotlib.figure import Figure

_STYLE = Path(__file__).with_name("report.css")

Mark = Literal["", "good", "bad"]


class Page:
    """Builds a page from the top down. All text is escaped here."""

    def __init__(self, title: str, lead: str = "") -> None:
        self._title = title
        self._parts: list[str] = [f"<h1>{_text(title)}</h1>", f'<p class="lead">{_text(lead)}</p>']

    def heading(self, text: str) -> None:
        self._parts.append(f"<h2>{_text(text)}</h2>")

    def paragraph(self, text: str) -> None:
        self._parts.append(f"<p>{_text(text)}</p>")

    def warning(self, text: str) -> None:
        self._parts.append(f'<p class="warning">{_text(text)}</p>')

    def tiles(self, figures: Iterable[tuple[str, str]]) -> None:
        """The figures that one looks for first: name and value."""
        tiles = [
            f'<div class="tile"><b>{_text(value)}</b><span>{_text(name)}</span></div>'
            for name, value in figures
        ]
        self._parts.append(f'<div class="tiles">{"".join(tiles)}</div>')

    def table(
        self, head: Sequence[str], rows: Iterable[Sequence[object]], marks: Sequence[Mark] | None = None
    ) -> None:
        """A table; numbers are set flush right. marks: one a row; its last cell then is the word for it."""
        body = list(rows)
        numeric = [bool(body) and all(_is_number(row[n]) for row in body) for n in range(len(head))]
        cells = "".join(
            f"<th{_kind(is_number)}>{_text(word)}</th>" for word, is_number in zip(head, numeric, strict=True)
        )
        lines = [f'<div class="wide"><table><tr>{cells}</tr>']
        for number, row in enumerate(body):
            mark = marks[number] if marks is not None else ""
            kinds = [_kind(is_number) for is_number in numeric]
            if marks is not None:
                kinds[-1] = ' class="word"'
            cells = "".join(
                f"<td{kind}>{_text(_cell(cell))}</td>" for kind, cell in zip(kinds, row, strict=True)
            )
            lines.append(f'<tr class="{mark}">{cells}</tr>' if mark else f"<tr>{cells}</tr>")
        self._parts.append("\n".join([*lines, "</table></div>"]))

    def picture(self, figure: Figure, caption: str = "", *, is_vector: bool = True) -> None:
        """A figure, drawn into the page: lines as vectors, charts as pixels."""
        kind = "svg+xml" if is_vector else "png"
        data = base64.b64encode(rendered(figure, "svg" if is_vector else "png")).decode()
        image = f'<img alt="{_text(caption)}" src="data:image/{kind};base64,{data}">'
        words = f"<figcaption>{_text(caption)}</figcaption>"
        self._parts.append(f'<figure><div class="wide">{image}</div>{words}</figure>')

    def details(self, summary: str, text: str) -> None:
        """Long text that is folded away."""
        self._parts.append(f"<details><summary>{_text(summary)}</summary><pre>{_text(text)}</pre></details>")

    def render(self) -> str:
        style = _STYLE.read_text(encoding="utf-8")
        head = '<meta charset="utf-8"><meta name="viewport" content="width=device-width, initial-scale=1">'
        head += f"<title>{_text(self._title)}</title>\n<style>\n{style}</style>"
        return "\n".join(
            [f'<!doctype html><html lang="en"><head>{head}</head><body>', *self._parts, "</body></html>\n"]
        )


def rendered(figure: Figure, kind: str) -> bytes:
    """A figure as bytes, the same ones every time."""
    out = io.BytesIO()
    with mpl.rc_context({"svg.hashsalt": "mavboat"}):
        figure.savefig(out, format=kind, metadata={"Date": None} if kind == "svg" else {"Software": None})
    return out.getvalue()


def _text(text: object) -> str:
    return html.escape(str(text))


def _kind(is_number: bool) -> str:
    return ' class="number"' if is_number else ""


def _is_number(value: object) -> bool:
    return value is None or (isinstance(value, int | float) and not isinstance(value, bool))


def _cell(value: object) -> str:
    if value is None:
        return "–"
    if isinstance(value, bool):
        return "yes" if value else "no"
    return f"{value:.4g}" if isinstance(value, float) else str(value)
