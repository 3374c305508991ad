"""The views of the page: each has its address, and an armed boat is held and stopped from all of them."""

import pytest
from finger import hold, press
from mavutil_station import MavutilStation
from page_rig import ARMED, ShoreBoat, Visit, button, needs_chromium, skipper, told, until_mode
from playwright.sync_api import expect
from pymavlink.dialects.v20 import all as dialect

from companion.core.modes import Mode

pytest_plugins = ("page_fixtures",)
pytestmark = [pytest.mark.realtime, needs_chromium]


def test_the_armed_boat_is_held_and_stopped_from_every_view(
    visit: Visit, shore: ShoreBoat, station: MavutilStation
) -> None:
    page = skipper(visit, shore)
    links = page.get_by_role("navigation", name="Views").get_by_role("link")
    others = [name for name in links.all_inner_texts() if name != "Sail"]
    assert len(others) >= 2
    for name in others:
        press(page, links.filter(has_text=name))
        expect(page.get_by_role("region", name=name, exact=True)).to_be_visible()
        expect(button(page, "Hold")).to_be_hidden()
        assert station.command(dialect.MAV_CMD_COMPONENT_ARM_DISARM, 1.0) == dialect.MAV_RESULT_ACCEPTED
        hold(page, button(page, "Hold"), told(page, "Hold: The boat keeps its place"))
        until_mode(station, Mode.LOITER, armed=True)
        hold(page, button(page, "Motors off"), told(page, "Motors off: "))
        station.drain()
        station.wait_for("HEARTBEAT", lambda beat: beat.get_srcSystem() == 1 and not beat.base_mode & ARMED)
        expect(button(page, "Hold")).to_be_hidden()


def test_the_address_names_the_view(visit: Visit, shore: ShoreBoat) -> None:
    page = visit("desktop", address=f"{shore.address}#plan")
    link = page.get_by_role("link", name="Plan")
    expect(link).to_have_attribute("aria-current", "page")
    expect(page.get_by_role("region", name="Plan", exact=True)).to_be_visible()
    press(page, page.get_by_role("link", name="Sail"))
    expect(page.get_by_role("region", name="Go")).to_be_visible()
    expect(button(page, "Hold")).to_be_visible()
    page.go_back()
    expect(page.get_by_role("region", name="Plan", exact=True)).to_be_visible()
