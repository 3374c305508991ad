"""Mission files of either format: QGroundControl's `.plan` (`qgc_plan.py`) and QGC WPL 110 (`wpl_text.py`).

What is written here reads back equal.
"""

from pathlib import Path

from companion.cli.output_file import write_text
from companion.core.errors import OutputError
from mission_tools.errors import PlanFileError
from mission_tools.mission.mission import Fence, Mission

MISSION_SUFFIXES = frozenset({".plan", ".waypoints", ".wpl", ".txt"})


def load_mission(path: Path) -> Mission:
    """Read a mission file, its format told by what is in it. Raises PlanFileError: names the file, the item
    or line, and what was expected there.
    """
    return parse_mission(read_text(path), str(path))


def read_text(path: Path) -> str:
    """The text of a mission file. Raises PlanFileError: it cannot be read, or is no text."""
    try:
        return path.read_text(encoding="utf-8")
    except OSError as error:
        raise PlanFileError(f"{path}: cannot be read: {error.strerror}") from None
    except UnicodeDecodeError:
        raise PlanFileError(f"{path}: neither a .plan nor QGC WPL 110: it is not text") from None


def parse_mission(text: str, source: str) -> Mission:
    """Read a mission from text; `source` is its name for people. Raises PlanFileError: names the source, the
    item or line, and what was expected there.
    """
    from mission_tools.mission import qgc_plan, wpl_text  # noqa: PLC0415 - msgspec, for files alone

    is_wpl = text.lstrip("\ufeff \r\n\t").startswith(("QGC", "#"))
    try:
        return wpl_text.parse(text) if is_wpl else qgc_plan.parse(text)
    except ValueError as error:
        raise PlanFileError(f"{source}: {error}") from None


def save_mission(mission: Mission, path: Path) -> None:
    """Write a mission; `.plan` gives QGroundControl's format, the other MISSION_SUFFIXES QGC WPL 110. Raises
    PlanFileError: the file cannot be written, or the format cannot hold the mission.
    """
    from mission_tools.mission import qgc_plan, wpl_text  # noqa: PLC0415 - msgspec, for files alone

    if path.suffix.lower() == ".plan":
        text = qgc_plan.compose(mission)
    elif mission.fence != Fence() or mission.rally:
        raise PlanFileError(f"{path}: QGC WPL 110 holds no fence and no rally points; name it .plan instead")
    else:
        text = wpl_text.compose(mission)
    try:
        write_text(path, text)
    except OutputError as error:
        raise PlanFileError(str(error)) from None
