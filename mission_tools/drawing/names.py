"""Names of picture files."""

from pathlib import Path

from mission_tools.errors import UsageError

PICTURE_SUFFIXES = frozenset({".png", ".svg", ".pdf", ".html"})


def check_picture_name(path: Path, option: str = "--preview") -> None:
    """Refuse early what could not be written after an hour's run.

    Raises:
        UsageError: no kind of picture, or no such folder.
    """
    if path.suffix.lower() not in PICTURE_SUFFIXES:
        raise UsageError(
            f"{option} {path}: expected a name that ends in {', '.join(sorted(PICTURE_SUFFIXES))}"
        )
    if not path.absolute().parent.is_dir():
        raise UsageError(f"{option} {path}: there is no folder {path.parent}")
