"""Several boats in one page: the list, and that only the chosen one does what is pressed."""

import re
from collections.abc import Iterator
from typing import NamedTuple

import pytest
from finger import hold, press
from mavutil_station import MavutilStation
from page_rig import ShoreBoat, Visit, boat_at_sea, button, needs_chromium, told, unlock
from playwright.sync_api import Page, expect

from companion.core.modes import Mode

pytest_plugins = ("page_fixtures",)
pytestmark = [pytest.mark.realtime, needs_chromium]

FOLLOW_SCALE = 2.0  # of shared/chart.js: pixels a metre at first


class Seen(NamedTuple):
    """Stations that see a boat each."""

    first: MavutilStation
    second: MavutilStation


@pytest.fixture(scope="module")
def shore(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ShoreBoat]:
    """Two boats."""
    yield from boat_at_sea(tmp_path_factory, "--count", "2", "--speedup", "2")


@pytest.fixture
def seen(shore: ShoreBoat) -> Iterator[Seen]:
    second = int(shore.program.wait_for(r"system 2 on tcpin:127\.0\.0\.1:(\d+)$")[1])
    stations = Seen(MavutilStation(shore.tcp, 255), MavutilStation(second, 254))
    yield stations
    for station in stations:
        station.close()


def modes(station: MavutilStation, boat: int, boat_s: float) -> set[int]:
    """Of a boat from now on, for a time of its own."""
    heard = [one for one in station.listen(boat_s) if one.get_type() == "HEARTBEAT"]
    return {one.custom_mode for one in heard if (one.get_srcSystem(), one.get_srcComponent()) == (boat, 1)}


def boats_button(page: Page, name: str) -> None:
    expect(page.get_by_role("button", name=re.compile(f"^{name}"), expanded=False)).to_be_visible()


def test_only_the_boat_that_is_chosen_does_what_is_pressed(
    visit: Visit, shore: ShoreBoat, seen: Seen
) -> None:
    page = visit("phone")
    unlock(page, shore.pin)
    expect(button(page, "Hold")).to_be_enabled()
    press(page, page.get_by_role("button", name=re.compile("^Boat 1"), expanded=False))
    rows = page.get_by_role("region", name="Boats").get_by_role("button")
    expect(rows).to_have_count(2)
    for row in rows.all():
        expect(row).to_contain_text(re.compile(r"Boat \d.*Disarmed.*Battery.*heard\s\d+\ss\sago"))
    expect(rows.nth(0)).to_have_attribute("aria-current", "true")
    press(page, rows.nth(1))
    expect(told(page, "Boat 2 is chosen")).to_be_visible()
    boats_button(page, "Boat 2")
    page.reload()
    boats_button(page, "Boat 2")
    expect(button(page, "Hold")).to_be_enabled()
    before = modes(seen.first, 1, 2.0)
    hold(page, button(page, "Hold"), told(page, "Hold: The boat keeps its place"))
    seen.second.wait_for(
        "HEARTBEAT",
        lambda beat: (beat.get_srcSystem(), beat.get_srcComponent(), beat.custom_mode) == (2, 1, Mode.LOITER),
    )
    assert modes(seen.first, 1, 4.0) == before
    assert Mode.LOITER not in before
    press(page, page.get_by_role("button", name=re.compile("^Boat 2"), expanded=False))
    expect(rows.nth(1)).to_contain_text("Keeps its place")
    expect(rows.nth(0)).not_to_contain_text("Keeps its place")
    page.keyboard.press("Escape")
    expect(rows.first).to_be_hidden()


def test_a_tap_near_another_boat_offers_to_choose_it(visit: Visit, shore: ShoreBoat) -> None:
    page = visit("phone")
    boats_button(page, "Boat 1")
    chart = page.locator("#chart")
    box = chart.bounding_box()
    assert box is not None
    east_px, north_px = page.evaluate(
        """async (scale) => {
            const [own, other] = (await (await fetch("/api/boats")).json()).map((boat) => boat.place);
            const { Plane } = await import("/shared/chart-view.js");
            return new Plane(own.lon, own.lat).to([other.lon, other.lat]).map((metres) => metres * scale);
        }""",
        FOLLOW_SCALE,
    )
    press(page, chart, {"x": box["width"] / 2.0 + east_px, "y": box["height"] / 2.0 - north_px})
    expect(page.get_by_text("Boat 2 is here. Choose it?")).to_be_visible()
    press(page, button(page, "Choose Boat 2"))
    boats_button(page, "Boat 2")
    assert "boat=2" in page.url
    expect(page.get_by_text("Boat 2 is here. Choose it?")).to_be_hidden()
