"""A headless Chromium for the shore page: three sizes, by day and by night."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Literal, NamedTuple

from playwright.sync_api import Browser, BrowserContext, sync_playwright

CHROMIUM = Path("/usr/bin/chromium")
_ARGUMENTS = (
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    # Chromium knows only the last list: it replaces that of Playwright, from which the first four are
    "--disable-features=HttpsUpgrades,MediaRouter,OptimizationHints,PaintHolding,"
    # Pages of its own address bar and a process in reserve took half of what a visit costs
    "WebUIOmniboxPopup,WebUIOmniboxAimPopup,PreloadTopChromeWebUI,SpareRendererForSitePerProcess",
)

Light = Literal["light", "dark"]


class Size(NamedTuple):
    """Of a screen, in CSS pixels."""

    width: int
    height: int
    has_touch: bool


SIZES = {
    "phone": Size(390, 844, has_touch=True),
    "tablet": Size(820, 1180, has_touch=True),
    "desktop": Size(1440, 900, has_touch=False),
}


@contextmanager
def open_browser() -> Iterator[Browser]:
    """Debian's Chromium, closed afterwards."""
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=list(_ARGUMENTS))
        try:
            yield browser
        finally:
            browser.close()


def open_context(browser: Browser, size: str, light: Light = "light") -> BrowserContext:
    """A visitor: cookies and storage of their own, a screen of one of the SIZES."""
    width, height, has_touch = SIZES[size]
    return browser.new_context(
        viewport={"width": width, "height": height},
        has_touch=has_touch,
        is_mobile=has_touch,
        color_scheme=light,
        locale="en-GB",
    )
