"""Tables in the documents that a benchmark writes anew."""

from collections.abc import Iterable, Sequence
from pathlib import Path


def rewrite(
    page: Path, name: str, head: Sequence[str], rows: Iterable[Sequence[str]], after: str = ""
) -> None:
    """Replace what stands between the page's marks `<!-- name -->` and `<!-- end -->` by a table.

    Raises:
        ValueError: the page has no such marks.
    """
    before, begin, rest = page.read_text(encoding="utf-8").partition(f"<!-- {name} -->")
    _, end, behind = rest.partition("<!-- end -->")
    if not end:
        raise ValueError(f"{page}: no marks <!-- {name} --> and <!-- end -->")
    lines = [f"| {' | '.join(head)} |", "|---" * len(head) + "|"]
    lines += [f"| {' | '.join(row)} |" for row in rows]
    text = "\n".join(lines) + (f"\n{after}" if after else "")
    page.write_text(f"{before}{begin}\n\n{text}\n\n{end}{behind}", encoding="utf-8")
