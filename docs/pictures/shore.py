"""The pictures of docs/shore.md: the page beside an emulated boat that sails a planned mission.

python -m pictures shore
"""

import re
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

from playwright.sync_api import Browser, Page

from pictures.browser import Light, open_browser, open_context

FOLDER = Path("docs/pictures")
FENCE = Path("examples/maps/mill_pond_fence.geojson")
_SPEEDUP = "8"
_SETTLED_MS = 5_000.0  # for the chart, the mission and some metres of track
_TURNED_MS = 1_500.0  # for the outputs and the current to be told
_DRAWN_MS = 500.0
_WAIT_MS = 60_000.0
_MAGNETOMETER = ("--set", "sensors.compass.magnetometer_mg=203")
_SCRIPTS = Path(sys.executable).parent


class Emulator(NamedTuple):
    """A boat with its page. port: for stations."""

    page: str
    pin: str
    port: int


@contextmanager
def emulator(*options: str) -> Iterator[Emulator]:
    """`boat-sitl serve lake --shore` on ports that the system chooses."""
    command = [str(_SCRIPTS / "boat-sitl"), "serve", "lake", "--shore", "--shore-at", "127.0.0.1:0"]
    command += ["--tcp", "0", "--no-udp", "--state", "none", *options]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as program:  # noqa: S603
        try:
            assert program.stdout is not None  # noqa: S101
            said, found = "", None
            while found is None or "ready" not in said:
                line = program.stdout.readline()
                if not line:
                    raise RuntimeError(f"boat-sitl ended: {said}")
                said += line
                found = re.search(r"page is at (\S+) with PIN (\d+)", said)
            port = re.search(r"tcpin:127\.0\.0\.1:(\d+)", said)
            assert port is not None  # noqa: S101
            yield Emulator(found[1], found[2], int(port[1]))
        finally:
            program.terminate()


def draw_shore() -> None:
    """Make them all. The boat sails a planned mission meanwhile."""
    with emulator("--speedup", _SPEEDUP) as boat, open_browser() as browser:
        open_page(browser, boat, "phone")  # an operator all the while: the boat's failsafe would stop it
        upload = [str(_SCRIPTS / "mission-upload"), "lake", "--connect", f"tcp:127.0.0.1:{boat.port}"]
        subprocess.run([*upload, "--fence", str(FENCE), "--start"], check=True, stdout=subprocess.DEVNULL)  # noqa: S603
        _draw(browser, boat, "shore_desktop", "desktop")
        _draw(browser, boat, "shore_tablet", "tablet")
        _draw(browser, boat, "shore_phone", "phone")
        _draw(browser, boat, "shore_phone_night", "phone", "dark")
    with emulator(*_MAGNETOMETER) as boat, open_browser() as browser:
        _draw_boat_view(browser, boat)
    draw_voyage()


def _draw_boat_view(browser: Browser, boat: Emulator) -> None:
    """The sensors of a disarmed boat, and a motor turned by a held button."""
    page = open_page(browser, boat, "desktop")
    page.get_by_role("link", name="Boat").click()
    page.wait_for_timeout(_SETTLED_MS)
    page.screenshot(path=FOLDER / "shore_boat.png")
    page.context.close()
    page = open_page(browser, boat, "phone")
    page.get_by_role("link", name="Boat").click()
    page.get_by_role("heading", name="Motors", exact=True).click()
    page.locator("#boat .motor-safe input:visible").check()
    page.get_by_role("button", name="Left ahead").focus()
    page.keyboard.down(" ")
    page.wait_for_timeout(_TURNED_MS)
    page.screenshot(path=FOLDER / "shore_boat_phone.png")
    page.keyboard.up(" ")
    page.context.close()


def draw_voyage() -> None:
    """A voyage of the Logs view: the mission of the lake, sailed in lockstep."""
    with tempfile.TemporaryDirectory() as state:
        logs = Path(state) / "logs"
        logs.mkdir()
        sail = [str(_SCRIPTS / "boat-sitl"), "sail", "lake", "--log", str(logs / "00001.bin")]
        subprocess.run(sail, check=True, stdout=subprocess.DEVNULL)  # noqa: S603
        with emulator("--state", state) as boat, open_browser() as browser:
            _draw_voyage(browser, boat, "shore_voyage", "desktop")
            _draw_voyage(browser, boat, "shore_voyage_phone", "phone")


def _draw_voyage(browser: Browser, boat: Emulator, name: str, size: str) -> None:
    page = open_page(browser, boat, size)
    page.goto(f"{boat.page}#logs")
    page.get_by_role("button", name="Show the voyage of 00001.bin").click()
    speed = page.get_by_role("slider").first
    box = speed.bounding_box()
    assert box is not None  # noqa: S101
    speed.click(position={"x": 0.5 * box["width"], "y": 0.5 * box["height"]})
    page.get_by_role("heading", name="Voyage").scroll_into_view_if_needed()
    page.locator("#logs").evaluate("view => { view.scrollTop = 0; }")
    page.wait_for_timeout(_DRAWN_MS)
    page.screenshot(path=FOLDER / f"{name}.png")
    page.context.close()


def open_page(browser: Browser, boat: Emulator, size: str, light: Light = "light") -> Page:
    """The page of a visitor who has entered the PIN."""
    context = open_context(browser, size, light)
    context.set_default_timeout(_WAIT_MS)
    page = context.new_page()
    page.goto(boat.page)
    page.get_by_label("PIN").fill(boat.pin)
    page.get_by_role("button", name="Unlock").click()
    page.locator("fieldset:enabled").first.wait_for(state="attached")
    return page


def _draw(browser: Browser, boat: Emulator, name: str, size: str, light: Light = "light") -> None:
    page = open_page(browser, boat, size, light)
    page.wait_for_timeout(_SETTLED_MS)
    page.screenshot(path=FOLDER / f"{name}.png")
    page.context.close()
