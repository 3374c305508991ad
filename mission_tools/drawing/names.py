"""Names of picture files."""

from pathlib import Path

from mission_tools.errors import UsageError

PICTURE_SUFFIXES = frozenset({".png", ".svg", ".pdf", ".html"})


def check_picture_name(path: Path, option: str = "--preview") -> None:
    """Refuse early what could not be written after an hour's run.

    Raises:
        UsageError: no kind of picture, or a file where its folder would be.
    """
    if path.suffix.lower() not in PICTURE_SUFFIXES:
        raise UsageError(
            f"{option} {path}: expected a name that ends in {', '.join(sorted(PICTURE_SUFFIXES))}"
        )
    folder = next(parent for parent in path.absolute().parents if parent.exists())
    if not folder.is_dir():
        raise UsageError(f"{option} {path}: {folder.name} is no folder")
