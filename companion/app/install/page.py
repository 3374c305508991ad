"""What belongs to the shore page: its unit, what it may write, and the rule for the Wi-Fi."""

from dataclasses import dataclass
from pathlib import Path
from string import Template
from typing import Final

from companion.app.install.accounts import USER
from companion.app.install.files import FileText, Folder, Owned
from companion.app.install.service import Enabled
from companion.app.install.steps import Step
from companion.app.install.target import Target
from companion.app.install.unit import CONFIG, FILES
from companion.app.install.updates import SPOOL, has_updates, no_update_steps, update_steps

SHORE_UNIT: Final = "mavboat-shore.service"
SHORE_UNIT_FILE: Final = Path("/etc/systemd/system") / SHORE_UNIT
PAGE_PORT: Final = 5760  # of the boat, for the page
PIN_FILE: Final = Path("/var/lib/mavboat/shore-pin")
MAP_FILE: Final = CONFIG.with_name("map.geojson")
WIFI_RULE: Final = "50-mavboat-wifi.rules"
WIFI_RULE_FILE: Final = Path("/etc/polkit-1/rules.d") / WIFI_RULE
_UNIT_TEXT: Final = "the shore page's unit"
_RULE_TEXT: Final = "leave of NetworkManager for the page"


@dataclass(frozen=True, slots=True)
class PageOptions:
    """has_wifi: the page may change the Wi-Fi. map_text: GeoJSON to be copied, if any. has_updates: it may
    install another version of mavboat.
    """

    has_wifi: bool = False
    map_text: str | None = None
    has_updates: bool = False


def page_of(target: Target, asked: PageOptions | None) -> PageOptions | None:
    """What was asked for, with what is installed already: an installation takes nothing away."""
    if asked is None and not target.path(SHORE_UNIT_FILE).exists():
        return None
    asked = asked or PageOptions()
    return PageOptions(
        asked.has_wifi or target.path(WIFI_RULE_FILE).exists(),
        asked.map_text,
        asked.has_updates or has_updates(target),
    )


def shore_unit_text(programs: Path, options: PageOptions, *, has_map: bool) -> str:
    """The unit of the page's program."""
    more = f" --map {MAP_FILE}" if has_map else ""
    more += " --wifi" if options.has_wifi else ""
    more += f" --updates {SPOOL}" if options.has_updates else ""
    template = Template((FILES / SHORE_UNIT).read_text(encoding="utf-8"))
    return template.substitute(bin=programs, config=CONFIG, port=PAGE_PORT, options=more)


def page_steps(target: Target, programs: Path, options: PageOptions) -> list[Step]:
    """The steps after those of the boat. The page's user may then write the configuration and its folder."""
    steps: list[Step] = [Owned(target, CONFIG, USER)]
    if options.map_text is not None:
        steps.append(FileText(target, MAP_FILE, options.map_text, "the map of the page"))
    if options.has_wifi:
        rule = (FILES / WIFI_RULE).read_text(encoding="utf-8")
        steps += [
            Folder(target, WIFI_RULE_FILE.parent, mode=None),
            FileText(target, WIFI_RULE_FILE, rule, _RULE_TEXT),
        ]
    if options.has_updates:
        steps += update_steps(target, programs)
    has_map = options.map_text is not None or target.path(MAP_FILE).exists()
    text = shore_unit_text(programs, options, has_map=has_map)
    return [*steps, FileText(target, SHORE_UNIT_FILE, text, _UNIT_TEXT)]


def page_enabled(target: Target, *, is_wanted: bool) -> Step:
    """The page starts with the machine, or does not."""
    return Enabled(target, is_wanted=is_wanted, unit=SHORE_UNIT)


def no_page_steps(target: Target) -> list[Step]:
    """The steps that remove it again."""
    return [
        *no_update_steps(target),
        page_enabled(target, is_wanted=False),
        FileText(target, SHORE_UNIT_FILE, None, _UNIT_TEXT),
        FileText(target, WIFI_RULE_FILE, None, _RULE_TEXT),
    ]
