"""The picture of docs/shore.md that shows the parameters panel."""

from pictures.browser import open_browser
from pictures.shore import FOLDER, emulator, open_page

_DRAWN_MS = 800.0


def draw_parameters() -> None:
    """Parameters found by a word, one of them changed; on a phone."""
    with emulator() as boat, open_browser() as browser:
        page = open_page(browser, boat, "phone")
        page.get_by_role("link", name="Boat", exact=True).click()
        page.get_by_role("heading", name="Parameters").click()
        page.get_by_label("Search").fill("cruise")
        row = page.locator('.param[data-name="CRUISE_SPEED"]')
        row.get_by_text("Speed over ground").wait_for()
        row.locator("summary").click()
        row.get_by_label("Value").fill("1.2")
        row.get_by_role("button", name="Save").click()
        row.get_by_text("CRUISE_SPEED is now 1.2").wait_for()
        page.wait_for_timeout(_DRAWN_MS)
        page.screenshot(path=FOLDER / "shore_parameters.png")
        page.context.close()
