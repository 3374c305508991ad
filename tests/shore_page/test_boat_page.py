"""Sensors, calibration and motors of the Boat view in Chromium: what is pressed, and what a station sees."""

import re
import time
from collections.abc import Iterator

import pytest
from finger import holding, press
from mavutil_station import MavutilStation
from page_rig import (
    ShoreBoat,
    Visit,
    axe_faults,
    boat_at_sea,
    button,
    needs_chromium,
    skipper,
    told,
)
from patience import MOMENT_S
from playwright.sync_api import Locator, Page, expect
from pymavlink.dialects.v20 import all as dialect

from companion.core.modes import Mode

pytest_plugins = ("page_fixtures",)
pytestmark = [pytest.mark.realtime, needs_chromium]

MAGNETOMETER = ("--set", "sensors.compass.magnetometer_mg=203", "--set", "sensors.compass.hard_iron_deg=25")
ACCEPTED, REST_US = dialect.MAV_RESULT_ACCEPTED, 1500
GNSS = dialect.FAILURE_UNIT_SENSOR_GPS


@pytest.fixture(scope="module")
def shore(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ShoreBoat]:
    """A boat with a bare magnetometer, at its own pace: motor tests are counted by its clock."""
    yield from boat_at_sea(tmp_path_factory, *MAGNETOMETER)


def boat_view(page: Page, panel: str | None = None) -> Page:
    press(page, page.get_by_role("link", name="Boat"))
    if panel is not None:
        press(page, page.get_by_role("heading", name=panel, exact=True, level=2))
    return page


def sensor(page: Page, name: str) -> Locator:
    return page.locator(f'.sensor[data-sensor="{name}"]')


def clear(page: Page) -> None:
    """Tick the box of the motors' panel."""
    page.locator("#boat .motor-safe input:visible").check()


def outputs(station: MavutilStation, left: bool, right: bool) -> None:
    """Until the boat's outputs are so."""
    station.wait_for(
        "SERVO_OUTPUT_RAW",
        lambda one: (one.servo1_raw != REST_US, one.servo3_raw != REST_US) == (left, right),
    )


@pytest.fixture
def watching(station: MavutilStation) -> MavutilStation:
    """A second station that gets the outputs ten times a second."""
    number = dialect.MAVLINK_MSG_ID_SERVO_OUTPUT_RAW
    assert station.command(dialect.MAV_CMD_SET_MESSAGE_INTERVAL, number, 100_000) == ACCEPTED
    return station


def test_everybody_sees_the_sensors_and_a_fault_changes_a_verdict(
    visit: Visit, station: MavutilStation
) -> None:
    page = boat_view(visit("phone"))
    expect(sensor(page, "gnss")).to_have_attribute("data-verdict", "fine")
    expect(sensor(page, "gnss")).to_contain_text(re.compile(r"Fix\s*3-D\s*Satellites\s*\d+"))
    expect(sensor(page, "battery")).to_contain_text(re.compile(r"Voltage\s*1\d\.\d\d\sV"))
    expect(sensor(page, "rc")).to_contain_text("Not fitted", ignore_case=True)
    assert axe_faults(page) == []
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
    assert station.command(dialect.MAV_CMD_INJECT_FAILURE, GNSS, dialect.FAILURE_TYPE_OFF) == ACCEPTED
    expect(sensor(page, "gnss")).to_have_attribute("data-verdict", "failed")
    expect(sensor(page, "gnss")).to_contain_text("Check its supply")
    expect(page.get_by_role("status").filter(has_text="1 failed")).to_be_visible()
    assert station.command(dialect.MAV_CMD_INJECT_FAILURE, GNSS, dialect.FAILURE_TYPE_OK) == ACCEPTED
    expect(sensor(page, "gnss")).not_to_have_attribute("data-verdict", "failed")


def test_a_motor_turns_while_its_button_is_held_and_stops_when_it_is_let_go(
    visit: Visit, shore: ShoreBoat, watching: MavutilStation
) -> None:
    page = boat_view(skipper(visit, shore), "Motors")
    ahead = button(page, "Left ahead")
    expect(ahead).to_be_disabled()
    clear(page)
    expect(ahead).to_be_enabled()
    assert axe_faults(page) == []
    with holding(page, ahead):
        outputs(watching, left=True, right=False)
        expect(page.locator("[data-output=left]")).to_contain_text("15 %")
        page.wait_for_timeout(2_000)  # longer than one test
        watching.drain()
        outputs(watching, left=True, right=False)
    outputs(watching, left=False, right=False)
    expect(told(page, "Left ahead: The motors are at rest")).to_be_visible()


def test_the_box_is_unticked_at_each_opening_and_after_a_minute(visit: Visit, shore: ShoreBoat) -> None:
    page = skipper(visit, shore, "desktop")
    page.clock.install()
    boat_view(page, "Motors")
    box = page.locator("#boat .motor-safe input:visible")
    box.check()
    press(page, page.get_by_role("heading", name="Sensors", exact=True, level=2))
    press(page, page.get_by_role("heading", name="Motors", exact=True, level=2))
    expect(box).not_to_be_checked()
    box.check()
    expect(button(page, "Left ahead")).to_be_enabled()
    page.clock.run_for(61_000)
    expect(box).not_to_be_checked()
    expect(button(page, "Left ahead")).to_be_disabled()


def test_the_compass_calibration_shows_its_progress_and_is_cancelled(
    visit: Visit, shore: ShoreBoat, station: MavutilStation
) -> None:
    page = boat_view(skipper(visit, shore, "phone"), "Calibration")
    press(page, button(page, "Start: Compass"))
    bar = page.get_by_role("progressbar", name="Progress: Compass")
    expect(bar).to_be_visible()
    expect(told(page, "Turn the boat slowly through a full circle")).to_be_visible()
    assert axe_faults(page) == []
    assert station.enter(Mode.MANUAL) == ACCEPTED
    assert station.command(dialect.MAV_CMD_COMPONENT_ARM_DISARM, 1.0, 2989.0) == ACCEPTED
    give_up_s = time.monotonic() + MOMENT_S
    while page.evaluate("document.querySelector('.calibration[data-kind=compass] progress').value") < 0.15:
        assert time.monotonic() < give_up_s
        station.mav.manual_control_send(1, 0, 600, 500, 0, 0)
        page.wait_for_timeout(100)
    press(page, button(page, "Cancel"))  # while armed, too
    expect(told(page, "Cancelled: nothing has changed.")).to_be_visible()
    expect(bar).to_be_hidden()


@pytest.mark.usefixtures("station")  # disarms the boat
def test_a_request_of_the_moment_is_not_sent_again_on_a_new_connection(
    visit: Visit, shore: ShoreBoat
) -> None:
    page = boat_view(skipper(visit, shore, "desktop"), "Motors")
    clear(page)
    page.evaluate("""() => {
        const send = WebSocket.prototype.send;
        window.sent = [];
        WebSocket.prototype.send = function (text) {
            window.sent.push(JSON.parse(text).what);
            window.socket = this;
            if (window.sent.at(-1) !== "motor") send.call(this, text);  // it has no answer
        };
    }""")
    with holding(page, button(page, "Left ahead")):
        page.wait_for_function("() => window.sent.includes('motor')")
        page.evaluate("() => { window.before = window.sent.splice(0); window.socket.close(); }")
        expect(told(page, "Left ahead: Not connected: nothing was sent.")).to_be_visible()
    expect(button(page, "Left ahead")).to_be_enabled()  # connected again
    page.wait_for_timeout(500)
    assert "motor" not in page.evaluate("window.sent")
