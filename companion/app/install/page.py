"""What belongs to the shore page: its unit and its map."""

from dataclasses import dataclass
from pathlib import Path
from string import Template
from typing import Final

from companion.app.install.files import file_step
from companion.app.install.service import enabled_step
from companion.app.install.steps import InstallStep
from companion.app.install.target import InstallError, Target, UnmetError
from companion.app.install.unit import CONFIG, FILES

SHORE_UNIT: Final = "mavboat-shore.service"
SHORE_UNIT_FILE: Final = Path("/etc/systemd/system") / SHORE_UNIT
PAGE_PORT: Final = 5760  # of the boat, for the page
PIN_FILE: Final = Path("/var/lib/mavboat/shore-pin")
MAP_FILE: Final = CONFIG.with_name("map.geojson")
_UNIT_TEXT: Final = "the shore page's unit"


@dataclass(frozen=True, slots=True)
class PageOptions:
    """map_text: GeoJSON to be copied, if any."""

    map_text: str | None = None


def page_of(target: Target, asked: PageOptions | None) -> PageOptions | None:
    """What was asked for; a page that is installed already stays."""
    if asked is None and target.path(SHORE_UNIT_FILE).exists():
        return PageOptions()
    return asked


def check_page_program(target: Target, programs: Path) -> None:
    """Start the page's program, which does its imports.

    Raises:
        UnmetError: it cannot start, with what it says.
    """
    try:
        target.run(str(programs / "boat-shore"), "--version")
    except InstallError as error:
        raise UnmetError(f"--page: {error}") from None


def shore_unit_text(programs: Path, *, has_map: bool) -> str:
    """The unit of the page's program."""
    template = Template((FILES / SHORE_UNIT).read_text(encoding="utf-8"))
    options = f" --map {MAP_FILE}" if has_map else ""
    return template.substitute(bin=programs, config=CONFIG, port=PAGE_PORT, options=options)


def page_steps(target: Target, programs: Path, options: PageOptions) -> list[InstallStep]:
    """The steps after those of the boat."""
    steps: list[InstallStep] = []
    if options.map_text is not None:
        steps.append(file_step(target, MAP_FILE, options.map_text, "the map of the page"))
    has_map = options.map_text is not None or target.path(MAP_FILE).exists()
    text = shore_unit_text(programs, has_map=has_map)
    return [*steps, file_step(target, SHORE_UNIT_FILE, text, _UNIT_TEXT)]


def page_enabled(target: Target, *, is_wanted: bool) -> InstallStep:
    """The page starts with the machine, or does not."""
    return enabled_step(target, is_wanted=is_wanted, unit=SHORE_UNIT)


def no_page_steps(target: Target) -> list[InstallStep]:
    """The steps that remove it again."""
    return [
        page_enabled(target, is_wanted=False),
        file_step(target, SHORE_UNIT_FILE, None, _UNIT_TEXT),
    ]
