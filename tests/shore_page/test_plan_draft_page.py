"""What is drawn in the Plan view: it is kept, can be changed by keyboard, and needs no PIN.

The server's answers are the test's own: figures that are known, answers that never come.
"""

import json
import os
import re
import signal
from typing import Any

import pytest
from finger import press
from mavutil_station import MavutilStation
from page_rig import ShoreBoat, Visit, axe_faults, button, needs_chromium, skipper, told
from plan_rig import CORNERS, GOALS, open_plan, rows, tap_places
from playwright.sync_api import Page, Route, expect

pytest_plugins = ("page_fixtures",)
pytestmark = [pytest.mark.realtime, needs_chromium]

PLAN = {
    "id": "a1", "name": "route", "task": "route", "items": 4, "length_m": 64.0, "time_s": 64.0,
    "charge_percent": 131.0,
    "fits": False, "clearance_m": 2.5, "warnings": ["Narrow water."], "has_areas": False,
    "points": [list(GOALS[0]), list(GOALS[1])],
}  # fmt: skip


def answer_plans(page: Page, asked: list[dict[str, Any]], **more: Any) -> None:  # noqa: ANN401
    """The server's answer to a plan."""

    def answer(route: Route) -> None:
        asked.append(json.loads(route.request.post_data or ""))
        route.fulfill(status=200, content_type="application/json", body=json.dumps(PLAN | more))

    page.route("**/api/boats/1/plan", answer)


def kept(page: Page) -> dict[str, Any]:
    """What the browser keeps over a reload."""
    found: dict[str, Any] = page.evaluate("JSON.parse(sessionStorage.getItem('mavboat.plan'))")
    return found


def test_tapped_places_are_numbered_moved_removed_and_taken_back(
    visit: Visit, shore: ShoreBoat, station: MavutilStation
) -> None:
    page = visit("phone")
    view = open_plan(page)
    expect(button(page, "Undo")).to_be_disabled()
    chart = page.locator("canvas").bounding_box()
    tap_places(page, station, GOALS)
    expect(rows(view)).to_have_count(3)
    assert page.locator("canvas").bounding_box() == chart, "the chart moves under the finger"
    expect(view).to_contain_text("3 places. Tap the next one, or press Plan.")
    for goal, kept_goal in zip(GOALS, kept(page)["places"]["route"], strict=True):
        assert kept_goal == pytest.approx(goal, abs=3e-5)
    first, second, third = kept(page)["places"]["route"]
    press(page, button(page, "Move up: Place 3"))
    assert kept(page)["places"]["route"] == [first, third, second]
    press(page, button(page, "Move down: Place 1"))
    assert kept(page)["places"]["route"] == [third, first, second]
    press(page, button(page, "Remove: Place 2"))
    assert kept(page)["places"]["route"] == [third, second]
    press(page, button(page, "Undo"))
    assert kept(page)["places"]["route"] == [third, first, second]
    press(page, button(page, "Clear all"))
    expect(rows(view)).to_have_count(0)
    press(page, button(page, "Undo"))
    expect(rows(view)).to_have_count(3)


def test_places_and_a_plan_outlast_a_lost_link_and_a_reload_until_the_server_forgets_it(
    visit: Visit, shore: ShoreBoat, station: MavutilStation
) -> None:
    page = skipper(visit, shore)
    answer_plans(page, [])
    view = open_plan(page)
    tap_places(page, station, GOALS[:2])
    child = shore.child
    os.kill(child, signal.SIGSTOP)
    try:
        expect(page.get_by_text("Not connected. Trying again.").first).to_be_visible()
        press(page, button(page, "Plan"))
        expect(told(page, "Not connected. The places are kept")).to_be_visible()
    finally:
        os.kill(child, signal.SIGCONT)
    expect(page.get_by_text("Connected", exact=True).first).to_be_visible()
    press(page, button(page, "Plan"))
    voyage = view.get_by_role("region", name="Planned voyage")
    expect(voyage).to_contain_text("64 m")
    page.route("**/api/plans/a1.geojson", lambda route: route.fulfill(status=200, body="{}"))
    page.reload()
    expect(rows(view)).to_have_count(2)
    expect(voyage).to_contain_text("64 m")
    page.unroute("**/api/plans/a1.geojson")
    page.route("**/api/plans/a1.geojson", lambda route: route.fulfill(status=404, body="{}"))
    page.reload()
    expect(told(page, "The server no longer has the plan")).to_be_visible()
    expect(voyage).to_be_hidden()
    expect(rows(view)).to_have_count(2)


def test_planning_is_cancelled_and_a_refusal_is_told(
    visit: Visit, shore: ShoreBoat, station: MavutilStation
) -> None:
    page = skipper(visit, shore, "tablet")
    page.route("**/api/boats/1/plan", lambda _route: None)  # never answered
    open_plan(page)
    tap_places(page, station, GOALS[:1])
    press(page, button(page, "Plan"))
    expect(page.get_by_text(re.compile(r"Planning … [1-9]\d* s"))).to_be_visible()
    expect(button(page, "Plan")).to_be_disabled()
    press(page, button(page, "Cancel"))
    expect(told(page, "Planning is cancelled")).to_be_visible()
    expect(button(page, "Plan")).to_be_enabled()
    page.unroute("**/api/boats/1/plan")
    refusal = json.dumps({"error": "Place 1 is on land", "expected": "a place on the water"})
    page.route("**/api/boats/1/plan", lambda route: route.fulfill(status=422, body=refusal))
    press(page, button(page, "Plan"))
    expect(told(page, "Place 1 is on land: a place on the water")).to_be_visible()


def test_options_are_sent_and_a_plan_of_other_places_is_not_uploaded(
    visit: Visit, shore: ShoreBoat, station: MavutilStation
) -> None:
    page = skipper(visit, shore, "desktop")
    asked: list[dict[str, Any]] = []
    answer_plans(page, asked)
    view = open_plan(page)
    tap_places(page, station, GOALS[:2])
    page.get_by_label("In any order, the shortest").check()
    page.get_by_label("Back to the start").check()
    page.get_by_label("Distance from the shore, m").fill("2,5")
    page.get_by_label("Speed, m/s").fill("fast")
    press(page, button(page, "Plan"))
    expect(told(page, "Speed, m/s: fast is not a number from 0.1 to 10.")).to_be_visible()
    expect(page.get_by_label("Speed, m/s")).to_be_focused()
    assert asked == []
    page.get_by_label("Speed, m/s").fill("1.2")
    page.get_by_label("Wind, m/s").fill("4")
    page.get_by_label("Wind from, °").fill("270")
    press(page, button(page, "Plan"))
    voyage = view.get_by_role("region", name="Planned voyage")
    for text in (
        "Length64 m",
        "Time1 min",
        "Charge131 %",
        "Clearance2.5 m",
        "does not last",
        "Narrow water.",
    ):
        expect(voyage).to_contain_text(text)
    assert asked[0].pop("goals") == kept(page)["places"]["route"]
    assert asked == [
        {
            "task": "route", "start": None, "area": [], "any_order": True, "return": True, "clearance_m": 2.5,
            "speed_m_s": 1.2, "wind_m_s": 4.0, "wind_from_deg": 270.0, "footprint_m": None, "overlap": None,
            "angle_deg": None,
        }
    ]  # fmt: skip
    expect(button(page, "Upload")).to_be_enabled()
    assert axe_faults(page) == []
    press(page, button(page, "Remove: Place 2"))
    expect(voyage).to_contain_text("Changed since it was planned")
    expect(button(page, "Upload")).to_be_disabled()
    expect(button(page, "Upload and start")).to_be_disabled()
    press(page, button(page, "Undo"))
    expect(button(page, "Upload")).to_be_enabled()
    page.get_by_label("Survey", exact=True).check()
    tap_places(page, station, CORNERS)
    press(page, button(page, "Plan"))
    expect(told(page, "Width of a track, m: a survey needs it")).to_be_visible()
    page.get_by_label("Width of a track, m").fill("4")
    page.get_by_label("Overlap of tracks, %").fill("20")
    page.get_by_label("Course of the tracks, °").fill("90")
    expect(view).to_contain_text(re.compile(r"4 corners, 1,2\d\d m²"))
    press(page, button(page, "Plan"))
    expect(button(page, "Upload")).to_be_enabled()
    assert asked[1].pop("area") == kept(page)["places"]["survey"]
    assert asked[1] == {
        "task": "survey", "start": None, "goals": [], "any_order": False, "return": False, "clearance_m": 2.5,
        "speed_m_s": 1.2, "wind_m_s": 4.0, "wind_from_deg": 270.0, "footprint_m": 4.0, "overlap": 0.2,
        "angle_deg": 90.0,
    }  # fmt: skip
