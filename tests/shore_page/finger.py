"""A finger on the glass, or a mouse where there is no glass."""

from collections.abc import Iterator
from contextlib import contextmanager

from pictures.browser import SIZES
from playwright.sync_api import Locator, Page, Position, expect


def has_touch(page: Page) -> bool:
    """Whether this visitor has a finger."""
    size = page.viewport_size
    assert size is not None
    return any(known.has_touch and known.width == size["width"] for known in SIZES.values())


def press(page: Page, button: Locator, at: Position | None = None) -> None:
    """Press and let go."""
    if has_touch(page):
        button.tap(position=at)
    else:
        button.click(position=at)


@contextmanager
def holding(page: Page, button: Locator) -> Iterator[None]:
    """A finger, or the mouse, on a button."""
    button.scroll_into_view_if_needed()
    box = button.bounding_box()
    assert box is not None
    x, y = box["x"] + box["width"] / 2.0, box["y"] + box["height"] / 2.0
    if not has_touch(page):
        page.mouse.move(x, y)
        page.mouse.down()
        yield
        page.mouse.up()
        return
    wire = page.context.new_cdp_session(page)
    wire.send("Input.dispatchTouchEvent", {"type": "touchStart", "touchPoints": [{"x": x, "y": y}]})
    yield
    wire.send("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})
    wire.detach()


def hold(page: Page, button: Locator, acted: Locator) -> None:
    """Press until `acted` is seen."""
    with holding(page, button):
        expect(acted).to_be_visible()
