"""The chart of the page in real Chromium: it draws, pans, zooms, follows, and tells a tapped place."""

import asyncio
import json
import math
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from aiohttp import web
from page_rig import needs_chromium
from playwright.sync_api import Browser, ConsoleMessage, Error, Page, ViewportSize

from companion.core.geo import LatLon, LocalFrame, Point, distance_m
from mission_tools.shore.chart import WaterChart, Way
from mission_tools.station.messages import Place
from mission_tools.station.words import FOLDER

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
PAGE = ROOT / "mission_tools" / "shore" / "page"
MAPS = ROOT / "examples" / "maps"
POLICY = "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'"
PHONE: ViewportSize = {"width": 390, "height": 844}
DESKTOP: ViewportSize = {"width": 1280, "height": 800}
PATIENCE_MS = 60_000
FRAME = LocalFrame(LatLon(50.0, -1.2))
BOAT = FRAME.to_global(Point(-100.0, -100.0))

pytest_plugins = ("page_fixtures",)
pytestmark = [pytest.mark.realtime, needs_chromium]


@pytest.fixture(scope="module")
def address() -> Iterator[str]:
    """A server of the page's files and the rig's, with the page's content security policy."""

    @web.middleware
    async def with_policy(request: web.Request, handler: Any) -> web.StreamResponse:  # noqa: ANN401
        answer: web.StreamResponse = await handler(request)
        answer.headers["Content-Security-Policy"] = POLICY
        return answer

    async def chart(_: web.Request) -> web.Response:
        return web.Response(
            body=WaterChart(MAPS / "mill_pond.geojson").geojson(), content_type="application/json"
        )

    async def words(_: web.Request) -> web.FileResponse:
        return web.FileResponse(FOLDER / "words.en.json")

    app = web.Application(middlewares=[with_policy])
    app.router.add_get("/api/chart", chart)
    app.router.add_get("/page/words.en.json", words)
    app.router.add_static("/page", PAGE)
    app.router.add_static("/rig", HERE)
    loop = asyncio.new_event_loop()
    runner = web.AppRunner(app)

    async def start() -> int:
        await runner.setup()
        site = web.TCPSite(runner, "127.0.0.1", 0)
        await site.start()
        return int(runner.addresses[0][1])

    thread = threading.Thread(target=loop.run_forever)  # playwright has a loop of its own in this one
    thread.start()
    port = asyncio.run_coroutine_threadsafe(start(), loop).result(60)
    yield f"http://127.0.0.1:{port}"
    asyncio.run_coroutine_threadsafe(runner.cleanup(), loop).result(60)
    loop.call_soon_threadsafe(loop.stop)
    thread.join()
    loop.close()


class Screen:
    """A page, and what the browser has complained of there."""

    def __init__(self, page: Page) -> None:
        self.page = page
        self.faults: list[str] = []
        page.set_default_timeout(PATIENCE_MS)
        page.on("pageerror", self.on_error)
        page.on("console", self.on_line)

    def on_error(self, error: Error) -> None:
        self.faults.append(str(error))

    def on_line(self, line: ConsoleMessage) -> None:
        if line.type == "error":
            self.faults.append(line.text)


@pytest.fixture(scope="module")
def screens(browser: Browser) -> Iterator[dict[str, Screen]]:
    """One on a phone and one on a desktop, for all tests."""
    contexts = {
        "phone": browser.new_context(viewport=PHONE, device_scale_factor=3, has_touch=True),
        "desktop": browser.new_context(viewport=DESKTOP),
    }
    yield {size: Screen(context.new_page()) for size, context in contexts.items()}
    for context in contexts.values():
        context.close()


@pytest.fixture
def page(request: pytest.FixtureRequest, screens: dict[str, Screen], address: str) -> Iterator[Page]:
    """The chart with the boat on it and no map yet, on a phone, or where asked for on a desktop."""
    screen = screens[getattr(request, "param", "phone")]
    page, faults = screen.page, screen.faults
    faults.clear()
    page.goto(f"{address}/rig/chart_rig.html")
    page.wait_for_function("() => window.chart !== undefined && window.draws > 0")
    yield page
    assert [fault for fault in faults if "favicon" not in fault and "404" not in fault] == []


def state(at: LatLon = BOAT, heading_deg: float | None = 40.0, **more: Any) -> dict[str, Any]:  # noqa: ANN401
    return {"boat": 1, "place": {"lat": at.lat_deg, "lon": at.lon_deg}, "heading_deg": heading_deg, **more}


def show(page: Page, what: str, *values: object) -> None:
    """Call the chart, and wait until it has drawn what it was given."""
    page.evaluate(
        "async ([what, values]) => { window.chart[what](...values);"
        " await new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done))); }",
        [what, list(values)],
    )


def show_pond(page: Page) -> None:
    tree = json.loads(WaterChart(MAPS / "mill_pond.geojson").geojson())
    show(page, "showChart", tree)


def middle(page: Page) -> tuple[float, float]:
    box = page.locator("#chart").bounding_box()
    assert box is not None
    return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2


def tapped(page: Page, x: float, y: float) -> Point:
    """The place that a tap at these pixels tells, in metres of FRAME."""
    page.evaluate("window.taps.length = 0")
    page.mouse.click(x, y)
    page.wait_for_function("() => window.taps.length === 1")
    lat, lon = page.evaluate("window.taps[0]")
    return FRAME.to_local(LatLon(lat, lon))


def scale(page: Page) -> float:
    """Pixels a metre, as two taps tell."""
    x, y = middle(page)
    return 100.0 / distance_m(tapped(page, x - 50, y + 90), tapped(page, x + 50, y + 90))


def colour(page: Page, x: float, y: float) -> tuple[int, int, int]:
    red, green, blue = page.evaluate(
        "([x, y]) => { const canvas = document.getElementById('chart'), "
        " k = canvas.width / canvas.clientWidth;"
        " return [...canvas.getContext('2d').getImageData(x * k, y * k, 1, 1).data].slice(0, 3); }",
        [x, y],
    )
    return red, green, blue


@pytest.mark.parametrize("page", ["desktop"], indirect=True)  # the others have a phone
def test_a_tap_tells_its_place_within_a_tenth_of_a_metre(page: Page) -> None:
    show_pond(page)
    show(page, "showState", state())
    x, y = middle(page)
    boat = FRAME.to_local(BOAT)
    assert distance_m(tapped(page, x, y), boat) < 0.1
    pixels_a_metre = scale(page)
    for dx, dy in ((120, 0), (-90, 150), (40, -200)):
        there = Point(boat.north_m - dy / pixels_a_metre, boat.east_m + dx / pixels_a_metre)
        assert distance_m(tapped(page, x + dx, y + dy), there) < 0.1


def test_what_is_drawn_at_a_place_is_where_a_tap_finds_it(page: Page) -> None:
    show_pond(page)
    show(page, "showState", state())
    water = WaterChart(MAPS / "mill_pond.geojson")
    x, y = middle(page)
    for dx, dy in ((-150, -140), (150, -140), (-150, 200), (150, 200), (0, 100)):
        at = FRAME.to_global(tapped(page, x + dx, y + dy))
        place = Place(lat=at.lat_deg, lon=at.lon_deg)
        is_water = isinstance(water.way(Place(lat=BOAT.lat_deg, lon=BOAT.lon_deg), place), Way)
        page.evaluate("document.activeElement.blur()")
        shown = colour(page, x + dx, y + dy)
        assert (shown == (0xB7, 0xDA, 0xEB)) == is_water, (dx, dy, shown, is_water)


def test_dragging_moves_the_chart_and_the_button_follows_the_boat_again(page: Page) -> None:
    show_pond(page)
    show(page, "showState", state())
    x, y = middle(page)
    boat = FRAME.to_local(BOAT)
    pixels_a_metre = scale(page)
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 60, y - 30, steps=6)
    page.mouse.up()
    assert page.evaluate("window.taps.length") == 1  # the one of `scale`: a drag is none
    follow = page.get_by_role("button", name="chart.follow")
    assert follow.get_attribute("aria-pressed") == "false"
    moved = tapped(page, x, y)
    assert moved.east_m - boat.east_m == pytest.approx(-60 / pixels_a_metre, abs=0.1)
    assert moved.north_m - boat.north_m == pytest.approx(-30 / pixels_a_metre, abs=0.1)
    away = FRAME.to_global(Point(-60.0, -40.0))
    show(page, "showState", state(away))
    assert distance_m(tapped(page, x, y), moved) < 0.1  # it stays while it is not asked to follow
    follow.click()
    assert follow.get_attribute("aria-pressed") == "true"
    assert distance_m(tapped(page, x, y), Point(-60.0, -40.0)) < 0.1


def test_the_wheel_zooms_about_its_place(page: Page) -> None:
    show_pond(page)
    show(page, "showState", state())
    x, y = middle(page)
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x - 30, y, steps=4)
    page.mouse.up()
    before, scale_before = tapped(page, x + 80, y + 60), scale(page)
    page.mouse.move(x + 80, y + 60)
    draws = page.evaluate("window.draws")
    page.evaluate("addEventListener('wheel', event => { window.turned = event.deltaY; })")
    page.mouse.wheel(0, -300)
    page.wait_for_function(f"() => window.draws > {draws}")
    turned = page.evaluate("window.turned")  # in the page's pixels
    assert turned < -50
    assert distance_m(tapped(page, x + 80, y + 60), before) < 0.1
    assert scale(page) == pytest.approx(scale_before * math.exp(-0.0015 * turned), rel=0.01)


def test_buttons_and_keys_zoom_and_pan(page: Page) -> None:
    show(page, "showState", state())
    x, y = middle(page)
    before = scale(page)
    page.get_by_role("button", name="chart.in").click()
    assert scale(page) == pytest.approx(1.6 * before, rel=0.01)
    page.get_by_role("button", name="chart.out").click()
    assert scale(page) == pytest.approx(before, rel=0.01)
    canvas = page.locator("#chart")
    canvas.press("+")
    assert scale(page) == pytest.approx(1.4 * before, rel=0.01)
    canvas.press("-")
    canvas.press("ArrowRight")
    boat = FRAME.to_local(BOAT)
    assert tapped(page, x, y).east_m - boat.east_m == pytest.approx(60 / before, abs=0.1)
    canvas.press("0")
    page.evaluate("window.taps.length = 0")
    canvas.press("Enter")
    (tap,) = page.evaluate("window.taps")
    assert distance_m(FRAME.to_local(LatLon(*tap)), boat) < 0.1
    for name in ("chart.follow", "chart.in", "chart.out"):
        box = page.get_by_role("button", name=name).bounding_box()
        assert box is not None
        assert min(box["width"], box["height"]) >= 48


def test_real_fingers_pan_pinch_and_tap(page: Page) -> None:
    """By the browser's own touch events."""
    show_pond(page)
    show(page, "showState", state())
    x, y = middle(page)
    before, boat = scale(page), FRAME.to_local(BOAT)
    screen = page.context.new_cdp_session(page)

    def touch(kind: str, *fingers: tuple[float, float]) -> None:
        points = [{"x": px, "y": py, "id": number} for number, (px, py) in enumerate(fingers)]
        screen.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})

    page.evaluate("window.taps.length = 0")
    touch("touchStart", (x - 40, y), (x + 40, y))
    for n in range(1, 9):
        touch("touchMove", (x - 40 - 5 * n, y), (x + 40 + 5 * n, y))
    touch("touchEnd")
    assert page.evaluate("window.taps.length") == 0
    assert scale(page) == pytest.approx(2.0 * before, rel=0.02)
    page.evaluate("window.taps.length = 0")
    touch("touchStart", (x, y))
    for n in range(1, 7):
        touch("touchMove", (x + 10 * n, y))
    touch("touchEnd")
    assert page.evaluate("window.taps.length") == 0
    touch("touchStart", (x, y))
    touch("touchEnd")
    page.wait_for_function("() => window.taps.length === 1")
    at = FRAME.to_local(LatLon(*page.evaluate("window.taps[0]")))
    assert at.east_m - boat.east_m == pytest.approx(-30 / before, abs=0.2)


def test_words_of_vessels_side_by_side_do_not_cover_each_other_and_the_nearest_has_its_own(
    page: Page,
) -> None:
    here = FRAME.to_local(BOAT)
    vessels: dict[str, object] = {}
    for number in range(6):
        at = FRAME.to_global(Point(here.north_m + 20.0 + number, here.east_m))
        vessels[f"{9 - number}"] = {
            "name": f"SHIP {number}", "place": {"lat": at.lat_deg, "lon": at.lon_deg}, "course_deg": None,
            "heading_deg": None, "speed_m_s": None, "length_m": None,
        }  # fmt: skip
    hear_words(page)
    show(page, "showState", state(vessels=vessels))
    said = {one for one in page.evaluate("window.said") if one.startswith("SHIP")}
    assert "SHIP 0" in said
    assert len(said) < 6


def hear_words(page: Page) -> None:
    """Keep what is written on the chart in window.said."""
    page.evaluate(
        "() => { window.said = []; const fill = CanvasRenderingContext2D.prototype.fillText;"
        " CanvasRenderingContext2D.prototype.fillText = function (text, ...at) {"
        " window.said.push(text); fill.call(this, text, ...at); }; }"
    )


def test_a_vessel_with_ais_is_drawn_as_long_as_it_is_with_its_way_and_closest_approach(page: Page) -> None:
    """100 m ahead it comes towards the boat, and passes 20 m away in 25 s."""
    north = FRAME.to_local(BOAT).north_m
    east = FRAME.to_local(BOAT).east_m
    ship = FRAME.to_global(Point(north + 60.0, east + 20.0))
    vessel = {
        "name": "RED FALCON", "place": {"lat": ship.lat_deg, "lon": ship.lon_deg}, "course_deg": 180.0,
        "heading_deg": 180.0, "speed_m_s": 2.0, "length_m": 40,
    }  # fmt: skip
    hear_words(page)
    show(page, "showState", state(course_deg=0.0, speed_m_s=1.0, vessels={"235001234": vessel}))
    (label,) = {one for one in page.evaluate("window.said") if one.startswith("RED FALCON")}
    assert label == "RED FALCON · 2.0 m/s · CPA 20 m, 20 s"
    x, y = middle(page)
    pixels_a_metre = scale(page)
    green = (0x1D, 0x6B, 0x3A)
    for off_m in (-15.0, 0.0, 15.0):
        assert colour(page, x + 20.0 * pixels_a_metre, y - (60.0 + off_m) * pixels_a_metre) == green
    assert colour(page, x + 20.0 * pixels_a_metre, y - 85.0 * pixels_a_metre) != green
    show(page, "showState", state(course_deg=180.0, speed_m_s=3.0, vessels={"235001234": vessel}))
    assert "RED FALCON · 2.0 m/s" in page.evaluate("window.said"), "they go apart"
    show(page, "showState", state())
    assert colour(page, x + 20.0 * pixels_a_metre, y - 60.0 * pixels_a_metre) != green
