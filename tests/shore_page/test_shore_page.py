"""The page in Chromium beside an emulated boat: what is pressed, and what a station then sees the boat do."""

import json
import math
import re
from collections.abc import Callable, Iterator
from typing import Any

import pytest
from finger import hold, press
from mavutil_station import MavutilStation, Message, Place
from page_rig import (
    ARMED,
    ShoreBoat,
    Visit,
    axe_faults,
    boat_at_sea,
    button,
    needs_chromium,
    show_all_buttons,
    skipper,
    told,
    unlock,
    until_mode,
)
from playwright.sync_api import Page, Position, expect
from pymavlink.dialects.v20 import all as dialect

from companion.core.modes import Mode

pytest_plugins = ("page_fixtures",)
pytestmark = [pytest.mark.realtime, needs_chromium]

FIRST_VIEW_BYTES = 300_000
LEAST_BUTTON_PX = 48.0
WAYPOINT, FRAME = dialect.MAV_CMD_NAV_WAYPOINT, dialect.MAV_FRAME_GLOBAL_RELATIVE_ALT
ON_WATER = [  # the first is home
    Place(WAYPOINT, FRAME, 499987600, -12029200),
    Place(WAYPOINT, FRAME, 499990000, -12010000),
    Place(WAYPOINT, FRAME, 499994000, -11990000),
]
PAUSED, SAILING = dialect.MISSION_STATE_PAUSED, dialect.MISSION_STATE_ACTIVE


@pytest.fixture(scope="module")
def shore(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ShoreBoat]:
    """A boat of these tests only: they sail it away."""
    yield from boat_at_sea(tmp_path_factory, "--speedup", "3")


@pytest.mark.parametrize("size", ["phone", "desktop"])
def test_the_page_is_small_and_shows_the_boat_to_everybody(
    size: str, visit: Visit, shore: ShoreBoat, record_property: Callable[[str, object], None]
) -> None:
    page = visit(size)
    expect(page.get_by_text("Hold", exact=True).first).to_be_visible()
    expect(page.get_by_role("term").filter(has_text="Battery")).to_be_visible()
    expect(page.locator("dl")).to_contain_text(re.compile(r"Battery\D*\d"))
    expect(page.get_by_text("Connected", exact=True).first).to_be_visible()
    expect(page.locator("#now-links .note")).to_contain_text(re.compile(r"^This computer, station 250:\s\d"))
    seen: dict[str, Any] = page.evaluate(
        """() => ({
            bytes: ["navigation", "resource"].flatMap((kind) => performance.getEntriesByType(kind))
                .reduce((sum, entry) => sum + entry.transferSize, 0),
            others: performance.getEntriesByType("resource").map((entry) => new URL(entry.name).host)
                .filter((host) => host !== location.host),
            painted_ms: performance.getEntriesByName("first-contentful-paint")[0]?.startTime,
            wide: document.documentElement.scrollWidth - innerWidth,
        })"""
    )
    record_property("bytes", seen["bytes"])
    record_property("painted_ms", seen["painted_ms"])
    assert 0 < seen["bytes"] <= FIRST_VIEW_BYTES
    assert seen["others"] == []
    assert seen["wide"] <= 0
    assert size == "desktop" or axe_faults(page) == []
    unlock(page, shore.pin)
    expect(button(page, "Hold")).to_be_enabled()
    show_all_buttons(page)
    assert axe_faults(page) == []
    boxes = [(one.inner_text(), one.bounding_box()) for one in page.get_by_role("button").all()]
    assert len(boxes) > 10
    assert [(text, box) for text, box in boxes if box is not None and box["height"] < LEAST_BUTTON_PX] == []
    press(page, button(page, "Day or night"))
    assert size == "desktop" or axe_faults(page) == []


def test_each_button_does_on_the_boat_what_it_says(
    visit: Visit, shore: ShoreBoat, station: MavutilStation
) -> None:
    assert station.upload(ON_WATER) == dialect.MAV_MISSION_ACCEPTED
    page = skipper(visit, shore)
    hold(
        page, button(page, "Arm"), told(page, "The propellers may turn")
    )  # which a phone shows while disarmed
    until_mode(station, Mode.HOLD, armed=True)
    expect(button(page, "Disarm")).to_be_hidden()
    show_all_buttons(page)
    for _ in range(6):
        press(page, button(page, "Slower"))
    press(page, page.get_by_role("button", name=re.compile("^Set 0.4")))
    expect(told(page, "Speed: The speed is now 0.4 m/s")).to_be_visible()
    press(page, button(page, "Start"))
    until_mode(station, Mode.AUTO, armed=True)
    press(page, button(page, "Pause"))
    expect(told(page, re.compile("Pause: Paused"))).to_be_visible()
    until_stage(station, PAUSED)
    press(page, button(page, "Continue"))
    expect(told(page, re.compile("Continue: The boat goes on"))).to_be_visible()
    until_stage(station, SAILING)
    until_mode(station, Mode.AUTO, armed=True)
    hold(page, button(page, "Return"), told(page, "Return: The boat returns home"))
    until_mode(station, Mode.RTL, armed=True)
    hold(page, button(page, "Hold"), told(page, "Hold: The boat keeps its place"))
    until_mode(station, Mode.LOITER, armed=True)
    sail_to_a_tapped_place(page, station)
    hold(page, button(page, "Motors off"), told(page, "Motors off: "))
    station.drain()
    station.wait_for("HEARTBEAT", lambda beat: beat.get_srcSystem() == 1 and not beat.base_mode & ARMED)
    page.get_by_label("Mode", exact=True).select_option("HOLD")
    press(page, button(page, "Set mode"))
    until_mode(station, Mode.HOLD, armed=False)


def until_stage(station: MavutilStation, stage: int) -> None:
    """What the boat itself says of its mission."""
    station.drain()
    station.wait_for("MISSION_CURRENT", lambda now: (now.get_srcSystem(), now.mission_state) == (1, stage))


def sail_to_a_tapped_place(page: Page, station: MavutilStation) -> None:
    """By the way that the page shows; the boat then makes for the place that was tapped."""
    asked: list[dict[str, Any]] = []
    page.expose_function("noteRequest", lambda text: asked.append(json.loads(text)))
    page.evaluate(
        """() => {
            const send = WebSocket.prototype.send;
            WebSocket.prototype.send = function (text) { noteRequest(text); return send.call(this, text); };
        }"""
    )
    tap_open_water(page)
    expect(page.get_by_text(f"Replaces the mission on board: {len(ON_WATER) - 1} items.")).to_be_visible()
    press(page, button(page, "Sail there"))
    until_mode(station, Mode.AUTO, armed=True)
    place = [one["with"] for one in asked if one["what"] == "route"][-1]
    goal = Place(WAYPOINT, FRAME, round(place["lat"] * 1e7), round(place["lon"] * 1e7))
    begun_m = station.metres_from(goal)
    station.wait_for("GLOBAL_POSITION_INT", lambda at: metres(at, goal) < 0.7 * begun_m)


def tap_open_water(page: Page) -> None:
    """Tap about the middle of the chart until the page has a way."""
    chart = page.locator("canvas")
    box = chart.bounding_box()
    assert box is not None
    told_way = page.get_by_text(re.compile("Way by the water: "))
    ashore = page.get_by_text(re.compile("is not on the map's water|from the shore or the fence"))
    for east, north in ((60.0, 40.0), (100.0, 40.0), (60.0, 90.0), (140.0, 0.0), (60.0, -60.0)):
        at: Position = {"x": 0.5 * box["width"] + east, "y": 0.5 * box["height"] - north}
        press(page, chart, at)
        expect(told_way.or_(ashore)).to_be_visible()
        if told_way.is_visible():
            return
    raise AssertionError("no water was tapped")


def metres(at: Message, place: Place) -> float:
    north, east = at.lat - place.lat_e7, (at.lon - place.lon_e7) * math.cos(math.radians(at.lat / 1e7))
    return math.hypot(north, east) * 0.0111319


def test_the_mode_chooser_follows_the_boat_and_sets_only_what_was_chosen(
    visit: Visit, shore: ShoreBoat, station: MavutilStation
) -> None:
    page = skipper(visit, shore, "desktop")
    chooser, set_mode = page.get_by_label("Mode", exact=True), button(page, "Set mode")
    expect(chooser).to_have_value("HOLD")
    expect(set_mode).to_be_disabled()
    station.enter(Mode.LOITER)
    expect(chooser).to_have_value("LOITER")
    expect(set_mode).to_be_disabled()
    chooser.select_option("MANUAL")
    expect(set_mode).to_be_enabled()
    station.enter(Mode.HOLD)  # by another station: what was chosen for LOITER is not set now
    expect(chooser).to_have_value("HOLD")
    expect(set_mode).to_be_disabled()
    chooser.select_option("LOITER")
    press(page, set_mode)
    until_mode(station, Mode.LOITER, armed=False)
    expect(chooser).to_have_value("LOITER")
    expect(set_mode).to_be_disabled()
