"""The page by keyboard alone: a visitor without a mouse does on the boat what the others do."""

import re

import pytest
from mavutil_station import MavutilStation
from page_rig import ShoreBoat, Visit, button, needs_chromium, told, until_mode
from playwright.sync_api import Locator, Page, expect
from pymavlink.dialects.v20 import all as dialect

from companion.core.modes import Mode

pytest_plugins = ("page_fixtures",)
pytestmark = [pytest.mark.realtime, needs_chromium]

MOST_TABS = 60  # through the whole page and round again
FAIL_COMPASS = (dialect.FAILURE_UNIT_SENSOR_MAG, dialect.FAILURE_TYPE_OFF)
MEND_COMPASS = (dialect.FAILURE_UNIT_SENSOR_MAG, dialect.FAILURE_TYPE_OK)
FOCUSED = """(goal) => {
    const one = document.activeElement;
    if (one === null || one === document.body) return [null, false, false];
    const isNew = one.dataset.tabbed === undefined;
    one.dataset.tabbed = "";
    return [getComputedStyle(one).outlineStyle, isNew, one === goal];
}"""


def test_a_visitor_without_a_mouse_sails_the_boat(
    visit: Visit, shore: ShoreBoat, station: MavutilStation
) -> None:
    page = visit("desktop")
    tab_to(page, page.get_by_label("PIN"))
    page.keyboard.type(shore.pin)
    page.keyboard.press("Enter")
    expect(button(page, "Hold")).to_be_enabled()
    open_why_not(page, station)
    for name, region in (("Plan", "Plan"), ("Sail", "Go")):
        tab_to(page, page.get_by_role("link", name=name, exact=True))
        page.keyboard.press("Enter")
        expect(page.get_by_role("region", name=region, exact=True)).to_be_visible()
    hold_space(page, "Arm", "The propellers may turn")
    hold_space(page, "Hold", "Hold: The boat keeps its place")
    until_mode(station, Mode.LOITER, armed=True)
    pick_water(page)
    tab_to(page, button(page, "Sail there"))
    page.keyboard.press("Enter")
    until_mode(station, Mode.AUTO, armed=True)
    assert station.enter(Mode.HOLD) == dialect.MAV_RESULT_ACCEPTED  # near its home, for the next test


def test_a_screen_reader_hears_the_regions_and_what_changes(visit: Visit, shore: ShoreBoat) -> None:
    page = visit("desktop")
    expect(page.locator("dl")).to_contain_text(re.compile(r"Battery\D*\d"))
    heard = page.locator("body").aria_snapshot()
    for name in ("Now", "Chart", "Messages", "Go"):
        assert f'region "{name}"' in heard
    go = page.get_by_role("region", name="Go", exact=True)
    assert "- status: " in go.aria_snapshot()


def open_why_not(page: Page, station: MavutilStation) -> None:
    """A boat whose compass fails, until it is mended."""
    assert station.enter(Mode.LOITER) == dialect.MAV_RESULT_ACCEPTED
    assert station.command(dialect.MAV_CMD_INJECT_FAILURE, *FAIL_COMPASS) == dialect.MAV_RESULT_ACCEPTED
    reasons = page.get_by_role("region", name="Why not")
    expect(reasons).to_contain_text("Compass: no heading")  # other reasons go when the boat is ready
    expect(reasons).to_contain_text("Cannot arm")
    tab_to(page, reasons.locator("summary"))
    page.keyboard.press("Enter")
    expect(reasons.get_by_role("listitem").filter(has_text="Compass: no heading")).to_be_visible()
    assert station.command(dialect.MAV_CMD_INJECT_FAILURE, *MEND_COMPASS) == dialect.MAV_RESULT_ACCEPTED
    expect(reasons).to_be_hidden()


def hold_space(page: Page, name: str, answer: str) -> None:
    tab_to(page, button(page, name))
    page.keyboard.down(" ")
    try:
        expect(told(page, answer)).to_be_visible()
    finally:
        page.keyboard.up(" ")


def pick_water(page: Page) -> None:
    """Move the chart and pick its middle, until the page has a way there."""
    way = page.get_by_text(re.compile("Way by the water: "))
    ashore = page.get_by_text(re.compile("is not on the map's water"))
    tab_to(page, page.locator("canvas"))
    for arrow in ("ArrowRight", "ArrowUp", "ArrowRight", "ArrowDown"):
        page.keyboard.press(arrow)
        page.keyboard.press("Enter")
        expect(way.or_(ashore).first).to_be_visible()
        if way.is_visible():
            return
    raise AssertionError("no water was picked")


def tab_to(page: Page, wanted: Locator) -> None:
    """Whatever has the focus on the way shows it and has a name."""
    goal = wanted.element_handle()
    for _ in range(MOST_TABS):
        page.keyboard.press("Tab")
        outline, is_new, is_there = page.evaluate(FOCUSED, goal)
        if outline is None:  # between the page's end and its beginning
            continue
        focused = page.locator(":focus")
        assert outline != "none", focused.aria_snapshot()
        assert not is_new or is_named(focused), focused.evaluate("one => one.outerHTML")
        if is_there:
            return
    raise AssertionError(f"not reached by Tab: {wanted}")


def is_named(focused: Locator) -> bool:
    """A summary has its text for a name; of all others the browser tells it in quotes."""
    if focused.evaluate("one => one.tagName") == "SUMMARY":
        return focused.inner_text().strip() != ""
    return re.match(r'- [\w ]+"[^"]+"', focused.aria_snapshot()) is not None
