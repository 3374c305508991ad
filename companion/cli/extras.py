"""Optional packages: the extras of pyproject.toml, and what a program says whose extra is not installed."""

from typing import Final

_OURS: Final = ("companion", "mission_tools", "sitl")
_OF_PROGRAM: Final = {"boat-shore": "web", "boat-sitl": "sitl"} | {
    f"mission-{name}": "planner" for name in ("check", "download", "plan", "trace", "upload")
}


def how_to_install(extra: str) -> str:
    """What installs an extra. The package is on no index: its sources or its wheel are at hand."""
    return f"pip install '.[{extra}]' in a clone of mavboat, or 'FILE.whl[{extra}]' with its wheel"


def missing_extra(program: str, error: BaseException) -> str | None:
    """The message about the extra that a program needs; None unless a package of others is missing."""
    if not isinstance(error, ModuleNotFoundError) or error.name is None:
        return None
    package = error.name.partition(".")[0]
    if package in _OURS:
        return None
    extra = _OF_PROGRAM.get(program)
    if extra is None:  # the base of the package is incomplete
        return f"the Python module {package!r} is missing: pip install . in a clone of mavboat"
    return f"needs the extra {extra!r} (no module {package!r}): {how_to_install(extra)}"
