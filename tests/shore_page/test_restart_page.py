"""The restart of the boat's program from the page, in Chromium."""

import re

import pytest
from finger import hold, press
from mavutil_station import MavutilStation
from page_rig import ShoreBoat, Visit, button, needs_chromium, skipper
from playwright.sync_api import Page, expect

pytest_plugins = ("page_fixtures",)
pytestmark = [pytest.mark.realtime, needs_chromium]


def open_restart(page: Page) -> None:
    press(page, page.get_by_role("link", name="Boat"))
    page.get_by_role("heading", name="Restart").click()


def test_a_restarted_boat_comes_back_to_the_same_page(
    visit: Visit, shore: ShoreBoat, station: MavutilStation
) -> None:
    page = skipper(visit, shore, "phone")
    open_restart(page)
    said, child = len(shore.program.out), shore.child
    restart = button(page, "Restart")
    expect(restart).to_be_enabled()
    hold(page, restart, page.get_by_text(re.compile("Waiting for the boat|The boat is back")))
    again = shore.program.wait_for(r"on tcpin:127\.0\.0\.1:(\d+)$", after=said)
    shore.program.wait_for(
        re.escape(f"the page is still at {shore.address} with PIN {shore.pin}"), after=said
    )
    expect(page.get_by_text("The boat is back, after")).to_be_visible()
    fresh = MavutilStation(int(again[1]), 254)
    try:
        assert fresh.wait_for("SYSTEM_TIME").time_boot_ms < 60_000
    finally:
        fresh.close()
    assert shore.child == child
