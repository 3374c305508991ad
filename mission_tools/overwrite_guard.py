"""The guard before every file that is written: only what this program wrote itself is replaced unasked.

Each format has the mark at a place of its own, where its writer puts it; a program that saves the file anew
writes its own there. QGC WPL has no such place, so it is never replaced unasked.
"""

import json
from collections.abc import Callable
from pathlib import Path

from mission_tools.errors import UsageError

GENERATOR = "mission-plan"
"""The member `generator` of a route in GeoJSON; a map traced from a photograph bears another."""
CREATOR = "mavboat"
"""Of plans, GPX and pictures."""
XML_HEADS = {
    ".kml": '<?xml version="1.0" encoding="UTF-8"?>\n<!-- written by mavboat -->\n',
    ".gpx": '<?xml version="1.0" encoding="UTF-8"?>\n<gpx version="1.1" creator="mavboat" ',
}
SAMPLES_HEAD = "time,unix_s,log_s,latitude,longitude,"
"""Of a survey's samples in .csv."""
PICTURE_METADATA = {".png": {"Software": CREATOR}, ".svg": {"Creator": CREATOR}, ".pdf": {"Creator": CREATOR}}
"""For matplotlib's and Pillow's writers."""
_HEAD_BYTES = 2048


def check_replaceable(option: str, path: Path, *, force: bool) -> None:
    """See whether a file may be written: it does not exist, is no regular file, or was written here. Raises
    UsageError: names the option and the file.
    """
    if force or not path.is_file():
        return
    try:
        is_own = _is_own(path.suffix.lower(), path.read_bytes())
    except OSError:
        is_own = False
    if not is_own:
        raise UsageError(
            f"{option} {path}: exists, and does not say that this program wrote it: "
            "choose another name, or add --force"
        )


def _is_own(suffix: str, data: bytes) -> bool:
    if not data:
        return True
    has_mark = _MARKS.get(suffix)
    return has_mark is not None and has_mark(data)


def _in_json(key: str, mark: str) -> Callable[[bytes], bool]:
    def has_mark(data: bytes) -> bool:
        try:
            tree = json.loads(data)
        except (ValueError, RecursionError):
            return False
        return isinstance(tree, dict) and tree.get(key) == mark

    return has_mark


def _in_head(mark: str) -> Callable[[bytes], bool]:
    return lambda data: mark.encode() in data[:_HEAD_BYTES]


def _as_head(head: str) -> Callable[[bytes], bool]:
    return lambda data: data.startswith(head.encode())


_MARKS: dict[str, Callable[[bytes], bool]] = {
    ".plan": _in_json("groundStation", CREATOR),
    ".geojson": _in_json("generator", GENERATOR),
    ".csv": _as_head(SAMPLES_HEAD),
    **{suffix: _as_head(head) for suffix, head in XML_HEADS.items()},
    ".png": _in_head(f"Software\0{CREATOR}"),
    ".svg": _in_head(f"<dc:title>{CREATOR}</dc:title>"),
    ".pdf": lambda data: f"/Creator ({CREATOR})".encode() in data[-_HEAD_BYTES:],
    ".html": _in_head(f'<meta name="generator" content="{CREATOR}">'),
}


PICTURE_SUFFIXES = frozenset({".png", ".svg", ".pdf", ".html"})


def check_picture_name(path: Path, option: str = "--preview") -> None:
    """Refuse early what could not be written after an hour's run. Raises UsageError: no kind of picture, or a
    file where its folder would be.
    """
    if path.suffix.lower() not in PICTURE_SUFFIXES:
        raise UsageError(
            f"{option} {path}: expected a name that ends in {', '.join(sorted(PICTURE_SUFFIXES))}"
        )
    folder = next(parent for parent in path.absolute().parents if parent.exists())
    if not folder.is_dir():
        raise UsageError(f"{option} {path}: {folder.name} is no folder")
