"""The pictures of docs/shore.md that show the Plan view."""

from playwright.sync_api import Browser, Page

from pictures.browser import open_browser
from pictures.shore import FOLDER, Emulator, emulator, open_page

_GOALS = ((42, -189), (193, -178), (328, -158), (286, -12))  # pixels from the boat, two steps zoomed out
_AREA = ((28, -14), (112, -25), (112, -94), (30, -75))  # one step zoomed out
_FOOTPRINT_M = "8"
_SPEEDUP = "8"
_DRAWN_MS = 500.0


def draw_plan() -> None:
    """A route on a laptop, a survey on a phone; the boat lies at the pier."""
    with emulator("--speedup", _SPEEDUP) as boat, open_browser() as browser:
        page = _planning(browser, boat, "desktop", 2, _GOALS)
        page.get_by_label("Back to the start").check()
        _draw_planned(page, "shore_plan")
        page = _planning(browser, boat, "phone", 1, _AREA)
        _draw_planned(page, "shore_plan_phone")


def _planning(
    browser: Browser, boat: Emulator, size: str, steps: int, places: tuple[tuple[int, int], ...]
) -> Page:
    page = open_page(browser, boat, size)
    page.get_by_role("link", name="Plan", exact=True).click()
    page.get_by_role("button", name="Plan", exact=True).wait_for()
    if places is _AREA:
        page.get_by_label("Survey", exact=True).check()
        page.get_by_text("Options", exact=True).click()
        page.get_by_label("Width of a track").fill(_FOOTPRINT_M)
        page.get_by_text("Options", exact=True).click()
    for _ in range(steps):
        page.get_by_role("button", name="Zoom out").click()
    canvas = page.locator("canvas")
    box = canvas.bounding_box()
    assert box is not None  # noqa: S101
    for east, south in places:
        canvas.click(position={"x": box["width"] / 2.0 + east, "y": box["height"] / 2.0 + south})
    return page


def _draw_planned(page: Page, name: str) -> None:
    page.get_by_role("button", name="Plan", exact=True).click()
    page.get_by_role("button", name="Upload", exact=True).wait_for()
    page.wait_for_timeout(_DRAWN_MS)
    page.screenshot(path=FOLDER / f"{name}.png")
    page.context.close()
