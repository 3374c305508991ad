"""A second language is one file: the page beside a real boat in a made-up one has no English of ours."""

import asyncio
import json
import re
import shutil
import threading
from collections.abc import Iterator
from pathlib import Path

import pytest
from finger import hold, press
from mavutil_station import MavutilStation
from page_rig import WAIT_MS, ShoreBoat, needs_chromium
from pictures.browser import SIZES
from playwright.sync_api import Browser, Page, expect
from pymavlink.dialects.v20 import all as dialect

from companion.core.modes import Mode
from mission_tools.shore.chart import WaterChart
from mission_tools.shore.clock import Clock
from mission_tools.shore.web.listening import Listening
from mission_tools.shore.web.login.pin_file import PinFile
from mission_tools.shore.web.login.session import Sessions
from mission_tools.shore.web.server import make_app
from mission_tools.station.boats import Boats
from mission_tools.station.words import FOLDER

pytest_plugins = ("page_fixtures",)
pytestmark = [pytest.mark.realtime, needs_chromium]

PIN = "482913"
MAP = Path(__file__).parents[2] / "examples" / "maps" / "mill_pond.geojson"
ENGLISH = re.compile(r"[A-Za-z]{2,}")
FAIL_COMPASS = (dialect.FAILURE_UNIT_SENSOR_MAG, dialect.FAILURE_TYPE_OFF)
MEND_COMPASS = (dialect.FAILURE_UNIT_SENSOR_MAG, dialect.FAILURE_TYPE_OK)
SHOWN = """() => {
    const named = ["aria-label", "title", "placeholder", "alt", "aria-description", "aria-valuetext"];
    const texts = [document.title];
    const walk = document.createTreeWalker(document.body, NodeFilter.SHOW_ELEMENT | NodeFilter.SHOW_TEXT);
    for (let node = walk.nextNode(); node !== null; node = walk.nextNode()) {
        if (node.nodeType === Node.TEXT_NODE) texts.push(node.data);
        else for (const name of named) if (node.hasAttribute(name)) texts.push(node.getAttribute(name));
    }
    return texts.map((text) => text.trim()).filter((text) => text !== "");
}"""


def foreign(text: str) -> str:
    """Each Latin letter outside of {names} as its full-width form."""
    parts = re.split(r"(\{\w+\})", text)
    return "".join(part if part.startswith("{") else part.translate(WIDE) for part in parts)


WIDE = {code: code + 0xFEE0 for code in range(0x41, 0x7B) if chr(code).isalpha()}


@pytest.fixture(scope="module")
def foreign_page(shore: ShoreBoat, tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """The page's server with words.xx.json in its folder, a station of the module's boat."""
    room = tmp_path_factory.mktemp("foreign")
    shutil.copytree(FOLDER.parents[1] / "shore" / "page", room / "page")
    words = json.loads((FOLDER / "words.en.json").read_text("utf-8"))
    made_up = {key: foreign(text) for key, text in words.items()} | {"language": "xx"}
    (room / "page" / "words.xx.json").write_text(json.dumps(made_up), encoding="utf-8")
    pin_file = PinFile(room / "pin")
    pin_file.write(PIN)
    boats = Boats(f"tcp:127.0.0.1:{shore.tcp}", 249)
    app = make_app(boats, WaterChart(MAP), Sessions(pin_file), room / "page", Clock())
    listening = Listening(app)
    loop = asyncio.new_event_loop()
    thread = threading.Thread(target=loop.run_forever)  # playwright has a loop of its own in this one
    thread.start()
    port = asyncio.run_coroutine_threadsafe(listening.open("127.0.0.1", 0), loop).result(60)
    yield f"http://127.0.0.1:{port}/"
    asyncio.run_coroutine_threadsafe(listening.close(), loop).result(60)
    loop.call_soon_threadsafe(loop.stop)
    thread.join()
    loop.close()
    boats.close()


@pytest.fixture
def page(browser: Browser, foreign_page: str) -> Iterator[Page]:
    """A visitor who reads xx, and no English."""
    phone = SIZES["phone"]
    context = browser.new_context(
        viewport={"width": phone.width, "height": phone.height},
        has_touch=True,
        is_mobile=True,
        locale="xx",
        reduced_motion="reduce",
    )
    context.set_default_timeout(WAIT_MS)
    expect.set_options(timeout=WAIT_MS)
    page = context.new_page()
    page.goto(foreign_page)
    yield page
    context.close()


def english(page: Page) -> list[str]:
    """What the page shows or names in Latin letters, but for what the boat or the map says."""
    shown = page.evaluate(SHOWN)  # before what is said, which only grows
    said: list[str] = page.evaluate(
        """() => ["#latest", "#lines span", ".wire"]
            .flatMap((name) => [...document.querySelectorAll(name)].map((one) => one.textContent.trim()))"""
    )
    return [text for text in shown if ENGLISH.search(text) and text not in said]


def test_in_another_language_no_english_of_ours_is_left(page: Page, station: MavutilStation) -> None:
    expect(page.get_by_text(foreign("Connected")).first).to_be_visible()
    assert page.evaluate("document.documentElement.lang") == "xx"
    expect(page.locator("#now-battery .value")).not_to_have_text("–")
    assert english(page) == []
    answer = page.locator("#answer")

    def told(text: str) -> None:
        expect(answer).to_contain_text(foreign(text))
        assert english(page) == []

    page.locator("#pin").fill("111111")
    page.locator("#unlock").tap()
    told("That is not the PIN.")
    page.locator("#pin").fill(PIN)
    page.locator("#unlock").tap()
    expect(page.locator("#hold")).to_be_enabled()
    page.locator("#go-more").tap()
    hold(page, page.locator("#return"), answer.filter(has_text=foreign("returns home")))
    told("The boat returns home as soon")
    hold(page, page.locator("#arm"), answer.filter(has_text=foreign("The propellers")))
    told("The propellers may turn")
    page.locator("#speed").tap()
    told("The speed is now ")
    hold(page, page.locator("#stop"), answer.filter(has_text=foreign("Stopped")))
    told("Stopped: motors off, disarmed")
    press(page, page.locator("#chart"), {"x": 5.0, "y": 5.0})
    expect(answer).not_to_have_text(re.compile(foreign("Planning")))
    assert english(page) == []
    assert station.enter(Mode.LOITER) == dialect.MAV_RESULT_ACCEPTED
    assert station.command(dialect.MAV_CMD_INJECT_FAILURE, *FAIL_COMPASS) == dialect.MAV_RESULT_ACCEPTED
    expect(page.locator("#why-title")).to_have_text(foreign("Cannot arm"))
    page.locator("#why summary").tap()
    expect(page.locator("#why-list .why").first).to_be_visible()
    assert english(page) == []
    assert station.command(dialect.MAV_CMD_INJECT_FAILURE, *MEND_COMPASS) == dialect.MAV_RESULT_ACCEPTED
