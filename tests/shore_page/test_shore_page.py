"""The page in Chromium beside an emulated boat: what is pressed, and what a station then sees the boat do."""

import json
import math
import re
from collections.abc import Callable
from typing import Any

import pytest
from finger import hold, press
from mavutil_station import MavutilStation, Message, Place
from page_rig import (
    ARMED,
    ShoreBoat,
    Visit,
    axe_faults,
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
LOADS = 20  # of the page, until one is as fast as it must be: others use the machine too
FIRST_VIEW_MS = 1_000.0
FAIL_COMPASS = (dialect.FAILURE_UNIT_SENSOR_MAG, dialect.FAILURE_TYPE_OFF)
MEND_COMPASS = (dialect.FAILURE_UNIT_SENSOR_MAG, dialect.FAILURE_TYPE_OK)


@pytest.mark.parametrize("size", ["phone", "tablet", "desktop"])
def test_the_page_is_small_and_shows_the_boat_to_everybody(
    size: str, visit: Visit, shore: ShoreBoat, record_property: Callable[[str, object], None]
) -> None:
    page = visit(size)
    expect(page.get_by_text("Hold", exact=True).first).to_be_visible()
    expect(page.get_by_role("term").filter(has_text="Battery")).to_be_visible()
    expect(page.locator("dl")).to_contain_text(re.compile(r"Battery\D*\d"))
    expect(page.get_by_text("Connected").first).to_be_visible()
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
    assert axe_faults(page) == []
    unlock(page, shore.pin)
    expect(button(page, "Hold")).to_be_enabled()
    show_all_buttons(page)
    assert axe_faults(page) == []
    boxes = [(one.inner_text(), one.bounding_box()) for one in page.get_by_role("button").all()]
    assert len(boxes) > 10
    assert [(text, box) for text, box in boxes if box is not None and box["height"] < LEAST_BUTTON_PX] == []
    press(page, button(page, "Day or night"))
    assert axe_faults(page) == []


def test_nothing_acts_before_the_pin(visit: Visit, shore: ShoreBoat, station: MavutilStation) -> None:
    page = visit("phone")
    for name in ("Hold", "Return", "Motors off", "Start", "Pause", "Continue"):
        expect(button(page, name)).to_be_disabled()
    refused = page.evaluate(
        """() => new Promise((resolve) => {
            const socket = new WebSocket(`ws://${location.host}/live?boat=1`);
            const request = {type: "do", id: crypto.randomUUID(), boat: 1, what: "return", with: {}};
            socket.onopen = () => socket.send(JSON.stringify(request));
            socket.onmessage = ({data}) => {
                const message = JSON.parse(data);
                if (message.type === "answer") resolve(message);
            };
        })"""
    )
    assert not refused["ok"]
    unlock(page, "135790" if shore.pin != "135790" else "246801")
    expect(told(page, "That is not the PIN")).to_be_visible()
    expect(button(page, "Hold")).to_be_disabled()
    unlock(page, shore.pin)
    expect(button(page, "Hold")).to_be_enabled()
    press(page, button(page, "Lock"))
    expect(button(page, "Hold")).to_be_disabled()
    assert station.mode() == Mode.HOLD


@pytest.mark.parametrize("size", ["phone", "desktop"])
def test_each_button_does_on_the_boat_what_it_says(
    size: str, visit: Visit, shore: ShoreBoat, station: MavutilStation
) -> None:
    assert station.upload(ON_WATER) == dialect.MAV_MISSION_ACCEPTED
    page = skipper(visit, shore, size)
    show_all_buttons(page)
    hold(page, button(page, "Arm"), told(page, "The propellers may turn"))
    until_mode(station, Mode.HOLD, armed=True)
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


def until_speed(station: MavutilStation, least_m_s: float, most_m_s: float) -> None:
    """Over ground, for three messages one after the other: a gust is none."""
    in_turn = 0

    def is_so(at: Message) -> bool:
        nonlocal in_turn
        in_turn = in_turn + 1 if least_m_s <= math.hypot(at.vx, at.vy) / 100.0 <= most_m_s else 0
        return in_turn == 3

    station.drain()
    station.wait_for("GLOBAL_POSITION_INT", is_so)


def test_the_boat_sails_at_the_speed_that_was_set(
    visit: Visit, shore: ShoreBoat, station: MavutilStation
) -> None:
    assert station.upload(ON_WATER) == dialect.MAV_MISSION_ACCEPTED
    page = skipper(visit, shore)
    show_all_buttons(page)
    hold(page, button(page, "Arm"), told(page, "The propellers may turn"))
    press(page, button(page, "Start"))
    until_mode(station, Mode.AUTO, armed=True)
    for _ in range(6):
        press(page, button(page, "Slower"))
    press(page, page.get_by_role("button", name=re.compile("^Set 0.4")))
    expect(told(page, "Speed: The speed is now 0.4 m/s")).to_be_visible()
    until_speed(station, 0.25, 0.55)
    for _ in range(6):
        press(page, button(page, "Faster"))
    press(page, page.get_by_role("button", name=re.compile("^Set 1.0")))
    expect(told(page, "Speed: The speed is now 1 m/s")).to_be_visible()
    until_speed(station, 0.75, 1.25)
    hold(page, button(page, "Motors off"), told(page, "Motors off: "))


def test_a_place_on_land_offers_the_nearest_on_the_water(
    visit: Visit, shore: ShoreBoat, station: MavutilStation
) -> None:
    page = skipper(visit, shore)
    tap_land(page)
    expect(page.get_by_text(re.compile(r"The nearest place with room is .*\sm from there"))).to_be_visible()
    press(page, button(page, "Go to that place"))
    expect(page.get_by_text(re.compile("Way by the water: "))).to_be_visible()
    press(page, button(page, "Sail there"))
    expect(told(page, re.compile("Sail there: The boat sails the way"))).to_be_visible()


def test_the_boat_is_seen_within_a_second(
    visit: Visit, shore: ShoreBoat, record_property: Callable[[str, object], None]
) -> None:
    took: list[dict[str, float]] = []
    while len(took) < LOADS and not any(max(one.values()) < FIRST_VIEW_MS for one in took):
        page = visit("phone")  # a visitor who was never here
        took.append(first_view(page))
        page.context.close()
    record_property("first_view_ms", took)
    assert min(max(one.values()) for one in took) < FIRST_VIEW_MS


def first_view(page: Page) -> dict[str, float]:
    """When something was painted and when the boat's values were shown, ms after the page was asked for."""
    page.wait_for_function(
        """() => performance.getEntriesByName("values").length > 0
            && performance.getEntriesByName("first-contentful-paint").length > 0"""
    )
    names = ("first-contentful-paint", "values")
    return {
        name: page.evaluate("(name) => performance.getEntriesByName(name)[0].startTime", name)
        for name in names
    }


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


def tap_land(page: Page) -> None:
    """Tap the edges of the whole pond until the page finds no water."""
    for _ in range(4):
        press(page, button(page, "Zoom out"))
    chart = page.locator("canvas")
    box = chart.bounding_box()
    assert box is not None
    ashore = page.get_by_text("That place is not on the map's water.").first
    way = page.get_by_text(re.compile("Way by the water: "))
    for x, y in ((0.02, 0.3), (0.3, 0.97), (0.98, 0.97), (0.5, 0.02)):
        press(page, chart, {"x": x * box["width"], "y": y * box["height"]})
        expect(way.or_(ashore)).to_be_visible()
        if ashore.is_visible():
            return
    raise AssertionError("no land was tapped")


def metres(at: Message, place: Place) -> float:
    north, east = at.lat - place.lat_e7, (at.lon - place.lon_e7) * math.cos(math.radians(at.lat / 1e7))
    return math.hypot(north, east) * 0.0111319


def test_the_page_says_why_the_boat_does_not_arm_and_what_to_do(
    visit: Visit, shore: ShoreBoat, station: MavutilStation
) -> None:
    page = skipper(visit, shore)
    assert station.enter(Mode.LOITER) == dialect.MAV_RESULT_ACCEPTED
    assert station.command(dialect.MAV_CMD_INJECT_FAILURE, *FAIL_COMPASS) == dialect.MAV_RESULT_ACCEPTED
    reasons = page.get_by_role("region", name="Why not")
    expect(reasons).to_contain_text("Cannot arm")
    press(page, reasons.locator("summary"))
    expect(reasons.get_by_role("listitem").filter(has_text="Compass: no heading")).to_be_visible()
    assert station.command(dialect.MAV_CMD_INJECT_FAILURE, *MEND_COMPASS) == dialect.MAV_RESULT_ACCEPTED
    expect(reasons).to_be_hidden()


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


def test_a_phone_shows_arm_while_the_boat_is_disarmed(
    visit: Visit, shore: ShoreBoat, station: MavutilStation
) -> None:
    page = skipper(visit, shore, "phone")
    arm = button(page, "Arm")
    expect(arm).to_be_visible()
    expect(button(page, "Set mode")).to_be_hidden()
    hold(page, arm, told(page, "The propellers may turn"))
    expect(button(page, "Disarm")).to_be_hidden()
    press(page, button(page, "Arm and modes"))
    expect(button(page, "Disarm")).to_be_visible()
    expect(button(page, "Set mode")).to_be_visible()
