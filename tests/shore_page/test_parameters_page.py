"""The parameters panel in Chromium: what is changed there, a second station reads on the boat."""

import json
import re
from pathlib import Path

import pytest
from finger import press
from mavutil_station import MavutilStation
from page_rig import ShoreBoat, Visit, axe_faults, button, needs_chromium, skipper, unlock
from playwright.sync_api import Locator, Page, expect
from pymavlink import mavparm
from pymavlink.dialects.v20 import all as dialect

pytest_plugins = ("page_fixtures",)
pytestmark = [pytest.mark.realtime, needs_chromium]

LEAST_PX = 48.0


def open_panel(page: Page) -> Page:
    """The panel, downloaded, with its texts."""
    page.evaluate("location.hash = '#boat'")
    press(page, page.get_by_role("heading", name="Parameters"))
    expect(page.locator(".param-status")).to_have_text(re.compile(r"^[\d,]+ parameters\.$"))
    expect(page.get_by_text("The texts are still on their way")).to_be_hidden()
    return page


def find(page: Page, words: str, name: str = "") -> Locator:
    """Search, and unfold the parameter of this name, or of these words."""
    page.get_by_label("Search").fill(words)
    row = page.locator(f'.param[data-name="{name or words.upper()}"]')
    expect(row).to_be_visible()
    expect(page.locator(".param-status")).to_have_text(re.compile(r"^[\d,]+ of [\d,]+ parameters\.$"))
    if row.get_attribute("open") is None:
        press(page, row.locator("summary"))
    return row


def save(page: Page, row: Locator, value: str) -> Locator:
    """Write a number and save it; the boat's answer."""
    row.get_by_label("Value").fill(value)
    press(page, row.get_by_role("button", name="Save"))
    return row.get_by_role("status")


def on_board(station: MavutilStation, name: str) -> float:
    """As the boat tells another station."""
    station.drain()
    station.mav.param_request_read_send(1, 1, name.encode("ascii"), -1)
    return float(station.wait_for("PARAM_VALUE", lambda one: one.param_id == name).param_value)


def tell(station: MavutilStation, name: str, value: float) -> None:
    """Another station sets a parameter."""
    station.mav.param_set_send(1, 1, name.encode("ascii"), value, dialect.MAV_PARAM_TYPE_REAL32)
    station.wait_for("PARAM_VALUE", lambda one: one.param_id == name)


def test_a_parameter_is_found_by_its_text_changed_and_set_back(
    visit: Visit, shore: ShoreBoat, station: MavutilStation
) -> None:
    page = open_panel(skipper(visit, shore))
    row = find(page, "ground auto guided rtl", "CRUISE_SPEED")
    expect(row.locator("summary")).to_contain_text("CRUISE_SPEED")
    expect(row).to_contain_text(re.compile(r"Default.*m/s.*Range.*0\.001 to 20 m/s"))
    answer = save(page, row, "0.85")
    expect(answer).to_have_text("✓ CRUISE_SPEED is now 0.85")
    assert on_board(station, "CRUISE_SPEED") == pytest.approx(0.85)
    expect(row.locator("summary")).to_contain_text("0.85 m/s")
    expect(row.locator("summary")).to_contain_text("changed")
    expect(save(page, row, "77")).to_have_text("✕ CRUISE_SPEED: 77 m/s is outside 0.001 to 20 m/s")
    expect(save(page, row, "")).to_have_text("✕ Expected a number.")
    assert on_board(station, "CRUISE_SPEED") == pytest.approx(0.85)
    back = row.get_by_role("button", name="Back to default: ")
    default = float(back.inner_text().split(" ")[3])
    press(page, back)
    expect(row.get_by_role("status")).to_contain_text("✓ CRUISE_SPEED is now")
    assert on_board(station, "CRUISE_SPEED") == pytest.approx(default)
    expect(row.locator("summary")).not_to_contain_text("changed")
    set_choices_and_bits(page, station)


def set_choices_and_bits(page: Page, station: MavutilStation) -> None:
    """By their names."""
    row = find(page, "log_disarmed")
    choice = row.get_by_label("Value")
    before = int(choice.input_value())
    choice.select_option(str(1 - before))
    press(page, row.get_by_role("button", name="Save"))
    expect(row.get_by_role("status")).to_have_text(f"✓ LOG_DISARMED is now {1 - before}")
    assert on_board(station, "LOG_DISARMED") == 1 - before
    row = find(page, "arming_check")
    tick = row.get_by_role("group", name="Value").get_by_label("All")
    expect(tick).to_be_checked()
    press(page, tick)
    press(page, row.get_by_role("button", name="Save"))
    expect(row.get_by_role("status")).to_have_text("✓ ARMING_CHECK is now 0")
    assert on_board(station, "ARMING_CHECK") == 0
    tell(station, "ARMING_CHECK", 1.0)
    row = find(page, "ahrs_orientation")
    expect(row).to_contain_text("The boat has it fixed.")
    expect(row.get_by_role("button", name="Save")).to_have_count(0)


def test_a_file_is_saved_compared_and_applied(
    visit: Visit, shore: ShoreBoat, station: MavutilStation, tmp_path: Path
) -> None:
    page = open_panel(skipper(visit, shore))
    press(page, page.locator(".param-files > summary"))
    with page.expect_download() as download:
        press(page, page.get_by_role("link", name="Save all in a file"))
    assert download.value.suggested_filename == "boat-1.param"
    file = mavparm.MAVParmDict()
    assert file.load(str(download.value.path()))
    assert dict(file) == pytest.approx(station.parameters(), rel=1e-6)
    before = {name: file[name] for name in ("CRUISE_SPEED", "WP_RADIUS")}
    file.update({"CRUISE_SPEED": 0.6, "WP_RADIUS": 4.5, "AVOID_MARGIN": 1e9, "NOT_THERE": 1.0})
    file.save(str(tmp_path / "other.parm"))
    chosen = page.get_by_label("Compare with a file")
    chosen.set_input_files(tmp_path / "other.parm")
    lines = page.locator(".param-differences li")
    expect(lines).to_have_count(3)
    expect(page.get_by_text("The boat does not have 1: NOT_THERE.")).to_be_visible()
    press(page, lines.filter(has_text="WP_RADIUS").get_by_role("checkbox"))
    press(page, button(page, "Set the ticked ones"))
    expect(page.get_by_text("1 of 2 set.")).to_be_visible()
    expect(lines.filter(has_text="CRUISE_SPEED")).to_contain_text("✓ CRUISE_SPEED is now 0.6")
    expect(lines.filter(has_text="AVOID_MARGIN")).to_contain_text("✕ AVOID_MARGIN: 1000000000 m is outside")
    assert on_board(station, "CRUISE_SPEED") == pytest.approx(0.6)
    assert on_board(station, "WP_RADIUS") == pytest.approx(before["WP_RADIUS"])
    assert axe_faults(page) == []
    (tmp_path / "photo.param").write_bytes(b"\x89PNG\r\n\xff")
    chosen.set_input_files(tmp_path / "photo.param")
    expect(page.get_by_text("✕ This is no text file. Expected a .param file.")).to_be_visible()
    tell(station, "CRUISE_SPEED", before["CRUISE_SPEED"])


def test_the_panel_is_usable_by_finger_keyboard_and_reader(visit: Visit, shore: ShoreBoat) -> None:
    page = visit("phone", "dark")
    unlock(page, shore.pin)
    expect(button(page, "Hold")).to_be_enabled()
    open_panel(page)
    press(page, page.locator(".param-group > summary").first)
    find(page, "arming_check")
    press(page, page.locator(".param-files > summary"))
    assert axe_faults(page) == []
    assert page.evaluate("document.documentElement.scrollWidth - innerWidth") <= 0
    assert page.evaluate("(box => box.scrollWidth - box.clientWidth)(document.querySelector('#boat'))") <= 0
    low = [
        (one.inner_text(), box["height"])
        for one in page.locator(
            "#boat :is(button, select, summary, input:not([type=checkbox], [type=file]), .tick)"
        ).all()
        if (box := one.bounding_box()) is not None and box["height"] < LEAST_PX
    ]
    assert low == []
    page.get_by_label("Search").focus()
    page.keyboard.press("Tab")
    page.keyboard.press("Tab")  # past "Only changed ones", to the parameter
    assert page.evaluate("document.activeElement.textContent").startswith("ARMING_CHECK")
    page.keyboard.press("Enter")
    expect(page.locator(".param").first).not_to_have_attribute("open", "")


def test_two_thousand_hostile_parameters_are_text_and_stay_fluent(visit: Visit) -> None:
    row = {
        "value": 1.0, "type": "Float", "text": "<img src=x onerror=alert(1)> & {n}", "long": "x " * 500,
        "unit": "m",
        "min": None, "max": 1e30, "step": None, "decimals": None, "values": [], "bits": [], "default": None,
        "changed": False, "group": "<b>one</b>", "reboot_required": True, "read_only": False,
    }  # fmt: skip
    rows = [{**row, "name": f"<i>{number}", "value": None if number % 2 else 1e-7} for number in range(2000)]
    page = visit()
    body = json.dumps({"missing": 3, "texts": "here", "parameters": rows})
    page.route("**/parameters", lambda route: route.fulfill(body=body, headers={"ETag": '"1"'}))
    open_panel(page)
    expect(page.get_by_text("3 parameters are missing")).to_be_visible()
    expect(page.locator(".param-group h3")).to_have_text("<b>one</b>")
    assert page.locator(".param").count() == 0
    press(page, page.locator(".param-group > summary"))
    expect(page.locator(".param")).to_have_count(50)
    press(page, button(page, "Show 1,950 more"))
    expect(page.locator(".param")).to_have_count(100)
    shown = find(page, "<i>1234", "<i>1234")
    expect(shown.locator("summary")).to_contain_text("<img src=x onerror=alert(1)> & {n}")
    assert page.locator("#boat img, #boat i").count() == 0
    page.get_by_label("Search").fill("<i>")
    expect(page.get_by_text("2,000 of 2,000 parameters.")).to_be_visible()
    assert page.locator(".param").count() == 50
