"""Fixtures of the page's tests, which share a browser, and a boat where they do not disturb it."""

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, ExitStack, contextmanager
from typing import TypeVar

import pytest
from mavutil_station import MavutilStation
from page_rig import WAIT_MS, ShoreBoat, Visit, boat_at_sea
from pictures.browser import Light, open_browser, open_context
from playwright.sync_api import Browser, Page, expect
from pymavlink.dialects.v20 import all as dialect

from companion.core.modes import Mode

DISARM_NOW = 21196.0
T = TypeVar("T")
_BOAT = pytest.StashKey[ShoreBoat]()
_BROWSER = pytest.StashKey[Browser]()


def shared(
    request: pytest.FixtureRequest, key: pytest.StashKey[T], make: Callable[[], AbstractContextManager[T]]
) -> T:
    """What the modules of this folder share: made for the first of them, ended after the last."""
    folder = request.node.parent
    if key not in folder.stash:
        ending = ExitStack()
        folder.stash[key] = ending.enter_context(make())
        ending.callback(folder.stash.__delitem__, key)
        folder.addfinalizer(ending.close)
    made: T = folder.stash[key]
    return made


@pytest.fixture(scope="module")
def shore(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> ShoreBoat:
    """The boat of all tests that leave it near its home."""
    return shared(request, _BOAT, lambda: contextmanager(boat_at_sea)(tmp_path_factory, "--speedup", "2"))


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
def browser(request: pytest.FixtureRequest) -> Browser:
    """Chromium, without a page."""
    return shared(request, _BROWSER, open_browser)


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
            page.emulate_media(reduced_motion="reduce")  # else Chromium draws the link's pulse all the time
            page.on("pageerror", lambda error: complaints.append(str(error)))
            page.goto(address or shore.address)
            return page

        expect.set_options(timeout=WAIT_MS)
        yield opened
    assert complaints == []
