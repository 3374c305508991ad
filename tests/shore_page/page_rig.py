"""`boat-sitl serve lake --shore` and visitors in headless Chromium."""

import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NamedTuple

import pytest
from axe_playwright_python.sync_playwright import Axe
from finger import press
from mavutil_station import MavutilStation
from patience import MOMENT_S
from pictures.browser import CHROMIUM
from playwright.sync_api import Locator, Page, expect
from programs import Program, processes_of
from pymavlink.dialects.v20 import all as dialect

from companion.core.modes import Mode

ARMED = dialect.MAV_MODE_FLAG_SAFETY_ARMED
WAIT_MS = MOMENT_S * 1000.0
_TCP = re.compile(r"on tcpin:127\.0\.0\.1:(\d+)$", re.MULTILINE)
_PAGE = re.compile(r"^boat-sitl: the page is at (http://\S+) with PIN (\d{8})$", re.MULTILINE)

Visit = Callable[..., Page]  # size, light

needs_chromium = pytest.mark.skipif(not CHROMIUM.exists(), reason=f"no {CHROMIUM}")


class ShoreBoat(NamedTuple):
    """A boat with its page. child: the process of `boat-shore`."""

    program: Program
    address: str
    pin: str

    @property
    def tcp(self) -> int:
        """The port for stations: another one after a restart."""
        return int(_TCP.findall(self.program.out)[-1])

    @property
    def child(self) -> int:
        """The process of the page's program."""
        (pid,) = [pid for pid in processes_of(self.program.pid) if "mission_tools.shore" in _words(pid)]
        return pid  # it may have children: the planner, a check of the configuration

    def options(self) -> list[str]:
        """What the page's program was started with."""
        words = _words(self.child)
        return words[words.index("mission_tools.shore") + 1 : -1]


def _words(process: int) -> list[str]:
    """Of its command; none if it has just ended."""
    try:
        return Path(f"/proc/{process}/cmdline").read_text(encoding="utf-8").split("\0")
    except FileNotFoundError:
        return []


def start_shore(room: Path, *options: str) -> ShoreBoat:
    """Waited for until boat and page are there."""
    arguments = ["serve", "lake", "--shore", "--shore-at", "127.0.0.1:0", "--tcp", "0", "--no-udp"]
    program = Program(room, ["boat-sitl", *arguments, "--state", "none", *options])
    try:
        program.wait_for(_TCP.pattern)
        program.wait_for(r"^boat-sitl: ready; Ctrl-C ends$")
        page = program.wait_for(_PAGE.pattern)
    except BaseException:
        program.kill()
        raise
    return ShoreBoat(program, page[1], page[2])


def boat_at_sea(rooms: pytest.TempPathFactory, *options: str) -> Iterator[ShoreBoat]:
    """A fixture's boat with its page, which must end well."""
    boat = start_shore(rooms.mktemp("shore") / "room", *options)
    yield boat
    boat.program.close()
    assert boat.program.wait(0.0)[::2] == (0, ""), "the boat ended badly"


def button(page: Page, name: str) -> Locator:
    return page.get_by_role("button", name=name, exact=True)


def show_all_buttons(page: Page) -> None:
    """A phone shows some of them only when asked."""
    more = button(page, "Arm and modes")
    if more.is_visible():
        press(page, more)


def told(page: Page, text: str | re.Pattern[str]) -> Locator:
    """What the page says that the boat answered."""
    return page.get_by_role("status").filter(has_text=text)


def axe_faults(page: Page) -> list[str]:
    """Serious and critical faults that axe-core finds, a line each."""
    violations = Axe().run(page, options={"resultTypes": ["violations"]}).response["violations"]
    return [
        f"{fault['id']}: {node['html']}"
        for fault in violations
        if fault["impact"] in {"serious", "critical"}
        for node in fault["nodes"]
    ]


def unlock(page: Page, pin: str) -> None:
    page.get_by_label("PIN").fill(pin)
    press(page, button(page, "Unlock"))


def skipper(visit: Visit, shore: ShoreBoat, size: str = "phone") -> Page:
    page = visit(size)
    unlock(page, shore.pin)
    expect(button(page, "Hold")).to_be_enabled()
    return page


def until_mode(station: MavutilStation, mode: Mode, armed: bool | None = None) -> None:
    station.drain()
    station.wait_for(
        "HEARTBEAT",
        lambda beat: (
            (beat.get_srcSystem(), beat.get_srcComponent(), beat.custom_mode) == (1, 1, mode)
            and armed in (None, bool(beat.base_mode & ARMED))
        ),
    )
