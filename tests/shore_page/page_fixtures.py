"""Fixtures of the page's tests: a plugin, as `program_fixtures`."""

from collections.abc import Iterator
from contextlib import ExitStack

import pytest
from mavutil_station import MavutilStation
from page_rig import WAIT_MS, ShoreBoat, Visit, start_shore
from pictures.browser import Light, open_browser, open_context
from playwright.sync_api import Browser, Page, expect
from pymavlink.dialects.v20 import all as dialect

from companion.core.modes import Mode

DISARM_NOW = 21196.0


@pytest.fixture(scope="module")
def shore(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ShoreBoat]:
    """One boat for the tests of a module."""
    boat = start_shore(tmp_path_factory.mktemp("shore") / "room", "--speedup", "5")
    yield boat
    boat.program.close()
    assert boat.program.wait(0.0)[::2] == (0, ""), "the boat ended badly"


@pytest.fixture
def station(shore: ShoreBoat) -> Iterator[MavutilStation]:
    """A station that sees what the boat does, on a link of its own; the boat is disarmed in HOLD at first."""
    station = MavutilStation(shore.tcp, 255)
    assert (
        station.command(dialect.MAV_CMD_COMPONENT_ARM_DISARM, 0.0, DISARM_NOW) == dialect.MAV_RESULT_ACCEPTED
    )
    assert station.enter(Mode.HOLD) == dialect.MAV_RESULT_ACCEPTED
    yield station
    station.close()


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    """Chromium, for the tests of a module."""
    with open_browser() as browser:
        yield browser


@pytest.fixture
def visit(shore: ShoreBoat, browser: Browser) -> Iterator[Visit]:
    """Opens the page for a new visitor. What the browser complains of fails the test."""
    complaints: list[str] = []
    with ExitStack() as ending:

        def opened(size: str = "phone", light: Light = "light", address: str | None = None) -> Page:
            context = open_context(browser, size, light)
            ending.callback(context.close)
            context.set_default_timeout(WAIT_MS)
            page = context.new_page()
            page.on("pageerror", lambda error: complaints.append(str(error)))
            page.goto(address or shore.address)
            return page

        expect.set_options(timeout=WAIT_MS)
        yield opened
    assert complaints == []
