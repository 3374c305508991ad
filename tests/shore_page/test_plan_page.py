"""Plan in Chromium beside an emulated boat: what is planned, and the mission that a station then reads."""

import json
import math
import re
from pathlib import Path

import pytest
from finger import hold, press
from mavutil_station import MavutilStation, Place
from page_rig import ShoreBoat, Visit, axe_faults, button, needs_chromium, skipper, told, until_mode
from plan_rig import GOALS, open_plan, tap_places
from playwright.sync_api import Locator, Page, expect
from pymavlink.dialects.v20 import all as dialect

from companion.core.modes import Mode

pytest_plugins = ("page_fixtures",)
pytestmark = [pytest.mark.realtime, needs_chromium]

WAYPOINT, FRAME = dialect.MAV_CMD_NAV_WAYPOINT, dialect.MAV_FRAME_GLOBAL_RELATIVE_ALT
CLOSE_M = 3.0  # a tap is a pixel or two off, and the boat drifts between its position and the tap

ON_LAND = (-1.203690, 49.998654)


def metres(a: tuple[float, float], b: tuple[float, float]) -> float:
    """Between two places: longitude, latitude."""
    east = (a[0] - b[0]) * math.cos(math.radians(a[1]))
    return math.hypot(east, a[1] - b[1]) * 111_320.0


def sailed(mission: list[Place]) -> list[tuple[float, float]]:
    """The places that a mission sails to, home left out."""
    return [(item.lon_e7 / 1e7, item.lat_e7 / 1e7) for item in mission[1:] if item.command == WAYPOINT]


def planned(page: Page, view: Locator) -> Locator:
    """Press Plan and wait for the voyage."""
    press(page, button(page, "Plan"))
    expect(told(page, re.compile(r"Planned: \d"))).to_be_visible()
    voyage = view.get_by_role("region", name="Planned voyage")
    expect(voyage).to_be_visible()
    return voyage


def test_a_route_of_tapped_places_becomes_the_mission_on_board(
    visit: Visit, shore: ShoreBoat, station: MavutilStation
) -> None:
    old = [Place(WAYPOINT, FRAME, 499987600 + 20 * n, -12029200) for n in range(4)]
    assert station.upload(old) == dialect.MAV_MISSION_ACCEPTED
    page = skipper(visit, shore)
    view = open_plan(page)
    tap_places(page, station, GOALS)
    voyage = planned(page, view)
    straight_m = metres(GOALS[0], GOALS[1]) + metres(GOALS[1], GOALS[2])
    length = re.search(r"Length(\d+)\sm", voyage.text_content() or "")
    assert length is not None, voyage.text_content()
    assert straight_m < float(length[1]) < 4.0 * straight_m
    expect(voyage).to_contain_text(re.compile(r"Time\d+\s(s|min)"))
    expect(voyage).to_contain_text(re.compile(r"Clearance[\d.]+\sm"))
    expect(voyage).to_contain_text("Replaces the mission on board: 3 items.")
    press(page, button(page, "Upload"))
    expect(told(page, re.compile("Upload: .*on board"))).to_be_visible()
    way = sailed(station.download())
    assert way != sailed(old)
    nearest = [min(range(len(way)), key=lambda n, goal=goal: metres(way[n], goal)) for goal in GOALS]  # type: ignore[misc]
    assert [metres(way[n], goal) < CLOSE_M for n, goal in zip(nearest, GOALS, strict=True)] == [True] * 3
    assert nearest == sorted(nearest)
    assert nearest[-1] == len(way) - 1
    expect(voyage).to_contain_text("Arm the boat in Sail, then press Start.")
    assert axe_faults(page) == []


def test_a_voyage_is_uploaded_and_started_and_watched(
    visit: Visit, shore: ShoreBoat, station: MavutilStation
) -> None:
    page = skipper(visit, shore)
    view = open_plan(page)
    tap_places(page, station, GOALS[1:])
    voyage = planned(page, view)
    assert station.arm() == dialect.MAV_RESULT_ACCEPTED
    until_mode(station, Mode.HOLD, armed=True)
    expect(page.locator("#go.armed")).to_be_attached()
    start = button(page, "Upload and start")
    press(page, start)
    expect(told(page, "Upload and start: press longer.")).to_be_visible()
    hold(page, start, told(page, "Upload and start: The boat sails the plan"))
    until_mode(station, Mode.AUTO, armed=True)
    begun = station.metres_from(Place(WAYPOINT, FRAME, round(GOALS[1][1] * 1e7), round(GOALS[1][0] * 1e7)))
    expect(voyage).to_contain_text("The boat sails it.")
    press(page, page.get_by_role("link", name="Go to Sail"))
    expect(page.locator("#mode")).to_have_text("Auto")
    station.wait_for(
        "GLOBAL_POSITION_INT", lambda at: metres((at.lon / 1e7, at.lat / 1e7), GOALS[1]) < 0.7 * begun
    )


def test_files_are_imported_and_exported(
    visit: Visit, shore: ShoreBoat, station: MavutilStation, tmp_path: Path
) -> None:
    page = skipper(visit, shore, "tablet")
    view = open_plan(page)
    tap_places(page, station, GOALS[1:])
    voyage = planned(page, view)
    plan = saved(page, voyage.get_by_role("link", name="Save the plan as: .plan"), tmp_path)
    tree = json.loads(plan.read_text("utf-8"))
    assert tree["fileType"] == "Plan"
    items = [item["params"][5:3:-1] for item in tree["mission"]["items"] if item["command"] == WAYPOINT]
    assert metres((items[-1][0], items[-1][1]), GOALS[-1]) < CLOSE_M
    expect(voyage.get_by_role("link", name="Save the plan as: KML")).to_be_visible()
    other = tmp_path / "harbour round.plan"
    other.write_bytes(plan.read_bytes())
    press(page, view.get_by_text("Files", exact=True))
    with page.expect_file_chooser() as chooser:
        press(page, button(page, "Import a file"))
    chooser.value.set_files(other)
    expect(voyage).to_contain_text("From harbour round")
    expect(view).to_contain_text("Tap the places to sail to")  # the places of another plan are gone
    press(page, button(page, "Upload"))
    expect(told(page, re.compile("Upload: .*on board"))).to_be_visible()
    assert metres(sailed(station.download())[-1], GOALS[-1]) < CLOSE_M
    board = saved(page, page.get_by_role("link", name=re.compile(r"mission on board .*: GeoJSON")), tmp_path)
    assert json.loads(board.read_text("utf-8"))["type"] == "FeatureCollection"
    broken = tmp_path / "broken.gpx"
    broken.write_text("<gpx><wpt", "utf-8")
    with page.expect_file_chooser() as chooser:
        press(page, button(page, "Import a file"))
    chooser.value.set_files(broken)
    expect(told(page, re.compile("✕ .*broken.gpx"))).to_be_visible()


def saved(page: Page, link: Locator, folder: Path) -> Path:
    """The file that a link gives."""
    with page.expect_download() as download:
        press(page, link)
    path = folder / download.value.suggested_filename
    download.value.save_as(path)
    return path


def test_a_tap_on_land_is_said_by_its_number_and_moved_to_the_nearest_water(
    visit: Visit, shore: ShoreBoat, station: MavutilStation
) -> None:
    page = skipper(visit, shore, "desktop")
    view = open_plan(page)
    tap_places(page, station, (GOALS[0], ON_LAND))
    expect(told(page, "Place 2 lies on land.")).to_be_visible()
    offer = view.get_by_role("group", name="A place on land")
    expect(offer).to_contain_text(re.compile(r"The nearest water with room is [\d.]+\sm from Place 2."))
    assert axe_faults(page) == []
    press(page, offer.get_by_role("button", name="Move it there"))
    expect(told(page, "Place 2 is on the water now.")).to_be_visible()
    expect(offer).to_be_hidden()
    planned(page, view)
