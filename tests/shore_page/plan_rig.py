"""The Plan view in a test: opened, and its chart tapped at places of the water."""

import math

from finger import press
from mavutil_station import MavutilStation
from playwright.sync_api import Locator, Page, expect

GOALS = ((-1.2024312, 49.998788), (-1.2021523, 49.9987094), (-1.2020825, 49.9989791))  # near the pier
CORNERS = ((-1.2028, 49.99885), (-1.2020, 49.99885), (-1.2020, 49.99905), (-1.2028, 49.99905))
_PIXELS_PER_M = 2.0  # of a chart that follows its boat and was not zoomed
_M_PER_DEGREE = 111_320.0


def open_plan(page: Page) -> Locator:
    """The view's own part of the page."""
    expect(page.get_by_text("Connected", exact=True).first).to_be_visible()
    press(page, page.get_by_role("link", name="Plan", exact=True))
    view = page.get_by_role("region", name="Plan", exact=True)
    expect(view.get_by_role("button", name="Plan", exact=True)).to_be_visible()
    return view


def tap_places(page: Page, station: MavutilStation, places: tuple[tuple[float, float], ...]) -> None:
    """Tap places (longitude, latitude); the boat is in the middle of the chart."""
    station.drain()
    at = station.wait_for("GLOBAL_POSITION_INT", lambda one: one.get_srcSystem() == 1)
    for lon, lat in places:
        north_m = (lat - at.lat / 1e7) * _M_PER_DEGREE
        east_m = (lon - at.lon / 1e7) * _M_PER_DEGREE * math.cos(math.radians(lat))
        box = page.locator("canvas").bounding_box()
        assert box is not None
        x, y = box["width"] / 2.0 + _PIXELS_PER_M * east_m, box["height"] / 2.0 - _PIXELS_PER_M * north_m
        assert 0.0 < x < box["width"], "the place is beside the chart"
        assert 0.0 < y < box["height"], "the place is above or below the chart"
        press(page, page.locator("canvas"), {"x": x, "y": y})


def rows(view: Locator) -> Locator:
    """The places of the list."""
    return view.get_by_role("list", name="Places").get_by_role("listitem")
