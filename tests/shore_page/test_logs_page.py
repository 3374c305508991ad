"""The Logs view: what the boat has logged is listed, downloaded byte by byte, and shown as a voyage."""

import math
import re
import subprocess
import sys
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import pytest
from finger import press
from page_rig import ShoreBoat, Visit, axe_faults, boat_at_sea, button, needs_chromium, skipper, unlock
from playwright.sync_api import Page, expect
from pymavlink import DFReader

pytest_plugins = ("page_fixtures",)
pytestmark = [pytest.mark.realtime, needs_chromium]

NAME = "00001.bin"
NEAR_THE_END = ("--start", "50.0012,-1.1980")  # a minute


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Of a boat that sailed the end of the lake's mission, in the folder of logs of the boat to come."""
    folder = tmp_path_factory.mktemp("state") / "logs"
    folder.mkdir()
    sail = [sys.executable, "-m", "sitl", "sail", "lake", *NEAR_THE_END, "--log", str(folder / NAME)]
    subprocess.run(sail, check=True, stdout=subprocess.DEVNULL)
    return folder / NAME


@pytest.fixture(scope="module")
def shore(log: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[ShoreBoat]:
    """A boat that keeps logs."""
    yield from boat_at_sea(tmp_path_factory, "--state", str(log.parent.parent))


def sailed_m(log: Path) -> float:
    """The way by pymavlink's reader, through a position a second."""
    reader = DFReader.DFReader_binary(str(log))
    places = []
    while (record := reader.recv_match(type="POS")) is not None:
        places.append((math.radians(record.Lat), math.radians(record.Lng)))
    reader.filehandle.close()
    way_m = 0.0
    for (lat_a, lon_a), (lat_b, lon_b) in pairwise(places[::10]):
        h = math.sin((lat_b - lat_a) / 2) ** 2
        h += math.cos(lat_a) * math.cos(lat_b) * math.sin((lon_b - lon_a) / 2) ** 2
        way_m += 2 * 6_371_008.8 * math.asin(math.sqrt(h))
    return way_m


def open_logs(page: Page) -> None:
    press(page, page.get_by_role("link", name="Logs"))
    expect(page.get_by_text("One log")).to_be_visible()


def open_voyage(page: Page) -> None:
    open_logs(page)
    press(page, button(page, f"Show the voyage of {NAME}"))
    expect(page.get_by_role("article", name="Voyage")).to_be_visible()


def test_a_download_has_the_bytes_of_the_file_on_the_boat(visit: Visit, shore: ShoreBoat, log: Path) -> None:
    page = skipper(visit, shore, "desktop")
    open_logs(page)
    with page.expect_download() as started:
        press(page, page.get_by_role("link", name=f"Download {NAME}"))
    assert started.value.suggested_filename == f"boat1-{NAME}"
    assert Path(started.value.path()).read_bytes() == log.read_bytes()


def test_a_voyage_is_as_long_as_pymavlink_says_and_a_moment_is_shown_everywhere(
    visit: Visit, shore: ShoreBoat, log: Path
) -> None:
    page = skipper(visit, shore)
    open_voyage(page)
    shown = page.locator("#logs dl div").filter(has_text="Distance").locator("dd").inner_text()
    number, unit = shown.split()
    assert unit == "m"
    assert float(number) == pytest.approx(sailed_m(log), rel=0.03)
    graphs = page.get_by_role("slider")
    expect(graphs).to_have_count(3)
    graphs.first.focus()
    page.keyboard.press("End")
    told = graphs.first.get_attribute("aria-valuetext")
    assert told is not None
    expect(page.locator("#logs .moment")).to_have_text(told)
    for n in range(3):
        expect(graphs.nth(n)).to_have_attribute("aria-valuetext", told)
    page.keyboard.press("Home")
    expect(page.locator("#logs .moment")).to_have_text(re.compile("^0:0"))
    press(page, page.get_by_role("button", name=re.compile("^1:0[45].*Mode Keeps its place$")))
    expect(graphs.last).to_have_attribute("aria-valuetext", re.compile("^1:0[45], Keeps its place"))
    track = page.get_by_role("application", name="Track of the voyage")
    box = track.bounding_box()
    assert box is not None
    press(page, track, {"x": 0.5 * box["width"], "y": 0.5 * box["height"]})  # half-way
    expect(graphs.first).to_have_attribute("aria-valuetext", re.compile(r"^0:[2-4]\d.*Auto"))
    assert axe_faults(page) == []
    overflow = "document.getElementById('logs').scrollWidth - document.getElementById('logs').clientWidth"
    assert page.evaluate(overflow) == 0


def test_a_log_is_charted_by_the_skipper_only_and_a_refusal_is_a_sentence(
    visit: Visit, shore: ShoreBoat
) -> None:
    page = visit("phone")
    open_logs(page)
    chart = button(page, f"Chart the depths of {NAME}")
    expect(chart).to_be_disabled()
    unlock(page, shore.pin)
    press(page, chart)
    expect(page.get_by_role("status").filter(has_text="no soundings (DPTH)")).to_be_visible()
    figures = {
        "max_depth_m": 3.2,
        "mean_depth_m": None,
        "band_median_m": 0.07,
        "volume_m3": 1e4,
        "coverage": 0.5,
    }
    page.route("**/chart", lambda route: route.fulfill(json=figures))
    press(page, chart)
    shown = page.get_by_role("article", name=f"Depths by {NAME}")
    expect(shown.locator("dd")).to_have_text(["3.20 m", "–", "± 0.07 m", "10,000 m³", "50 %"])
    files = shown.get_by_role("navigation").get_by_role("link")
    expect(files).to_have_text(["depth.tif", "chart.gpkg", "gaps.geojson", "lake.geojson"])
    expect(files.first).to_have_attribute("href", f"/api/boats/1/logs/{NAME}/chart/depth.tif")
    press(page, button(page, "Back to the list"))
    expect(chart).to_be_focused()
