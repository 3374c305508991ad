"""The board's panel in Chromium: what is set up there, and what becomes of it on the boat."""

import json
import os
import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from finger import hold, press
from mavutil_station import MavutilStation
from page_rig import ShoreBoat, Visit, axe_faults, button, needs_chromium, skipper, start_shore, told
from playwright.sync_api import Page, expect
from twins.wifi_air import Air
from wheels import make_wheel

from companion import __version__

pytest_plugins = ("page_fixtures",)
pytestmark = [pytest.mark.realtime, needs_chromium]

PASSWORD = "a pass word"  # noqa: S105
BOAT = """\
# the lake boat
links = ["tcpin:127.0.0.1:0"]
parts.motors.driver = "l298n"
external = { position = 2, heading = 2 }

[heading]
kp = 1.5
"""


@pytest.fixture(scope="module")
def config(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("etc") / "boat.toml"


@pytest.fixture(scope="module")
def air(tmp_path_factory: pytest.TempPathFactory) -> Air:
    """Networks in reach."""
    air = Air(tmp_path_factory.mktemp("wifi") / "air")
    air.add("home", signal=40)
    air.add("<b>harbour</b>", PASSWORD, signal=70)
    air.add("work", PASSWORD, security="WPA2 802.1X", signal=30)
    air.know("home", is_active=True)
    return air


@pytest.fixture(scope="module")
def updates(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder for updates, and beside it the installer's result."""
    folder = tmp_path_factory.mktemp("spool") / "update"
    folder.mkdir()
    return folder


@pytest.fixture(scope="module")
def shore(
    tmp_path_factory: pytest.TempPathFactory, config: Path, air: Air, updates: Path
) -> Iterator[ShoreBoat]:
    """A boat whose page has a configuration and Wi-Fi."""
    config.write_text(BOAT, encoding="utf-8")
    room = tmp_path_factory.mktemp("shore") / "room"
    options = f"--config {config} --wifi --updates {updates} --update-result {updates.parent}/result.json"
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("PATH", f"{air.nmcli.parent}:{os.environ['PATH']}")
        boat = start_shore(room, "--speedup", "5", "--shore-options", options)
    yield boat
    boat.program.close()
    assert boat.program.wait(0.0)[::2] == (0, ""), "the boat ended badly"


def board(visit: Visit, shore: ShoreBoat, size: str = "phone") -> Page:
    """The panel, opened by somebody who knows the PIN."""
    page = skipper(visit, shore, size)
    press(page, page.get_by_role("link", name="Boat"))
    page.get_by_text("Configuration, restart, update, Wi-Fi").click()
    return page


def test_a_wrong_configuration_is_shown_with_its_line_and_a_right_one_is_saved(
    visit: Visit, shore: ShoreBoat, config: Path
) -> None:
    page = board(visit, shore)
    text = page.get_by_label("The boat's TOML file")
    expect(text).to_have_value(BOAT)
    text.fill(BOAT.replace("1.5", "'much'"))
    press(page, button(page, "Save"))
    wrong = page.get_by_role("list", name="What is wrong")
    expect(wrong).to_contain_text("Line 7: Expected `float`, got `str`")
    expect(told(page, "nothing was saved")).to_be_visible()
    press(page, button(page, "Go to line 7"))
    assert text.evaluate("area => area.value.slice(area.selectionStart, area.selectionEnd)") == "kp = 'much'"
    expect(page.get_by_text("Line 7. Changed, not saved.")).to_be_visible()
    assert axe_faults(page) == []
    assert config.read_text("utf-8") == BOAT

    right = BOAT.replace("1.5", "2.5")
    text.fill(right)
    press(page, button(page, "Check"))
    expect(told(page, "takes this configuration")).to_be_visible()
    assert config.read_text("utf-8") == BOAT
    press(page, button(page, "Save"))
    expect(told(page, "Saved.")).to_be_visible()
    assert config.read_text("utf-8") == right
    assert config.with_name("boat.toml.1").read_text("utf-8") == BOAT

    press(page, button(page, "Show"))
    expect(text).to_have_value(BOAT)
    press(page, button(page, "Save"))
    expect(told(page, "Saved.")).to_be_visible()
    assert config.read_text("utf-8") == BOAT


def test_an_armed_boat_is_not_set_up(visit: Visit, shore: ShoreBoat, station: MavutilStation) -> None:
    page = board(visit, shore, "tablet")
    expect(button(page, "Save")).to_be_enabled()
    station.arm()
    expect(page.get_by_text("The boat is armed: disarm it to change anything here.")).to_be_visible()
    for name in ("Check", "Save", "Restart"):
        expect(button(page, name)).to_be_disabled()


def test_a_viewer_is_asked_for_the_pin(visit: Visit, shore: ShoreBoat) -> None:
    page = visit("desktop")
    page.get_by_role("link", name="Boat").click()
    page.get_by_text("Configuration, restart, update, Wi-Fi").click()
    expect(page.get_by_text("Enter the PIN to set up the boat's computer.")).to_be_visible()
    expect(page.get_by_label("The boat's TOML file")).to_have_count(0)


def test_the_boat_joins_a_network_and_stays_once_the_page_is_heard(
    visit: Visit, shore: ShoreBoat, air: Air, station: MavutilStation
) -> None:
    page = board(visit, shore)
    networks = page.get_by_role("list", name="Networks in reach")
    expect(networks.get_by_role("listitem")).to_have_count(3)
    expect(networks).to_contain_text("work, signal 30 %, asks for more than a password")
    press(page, button(page, "Join <b>harbour</b>"))
    page.get_by_label("Password of <b>harbour</b>").fill("not the password")
    press(page, button(page, "Join"))
    news = page.get_by_text(re.compile("the boat went back: .*Secrets were required"))
    expect(news).to_be_visible()
    assert air.active() == ["home"]
    assert axe_faults(page) == []

    press(page, button(page, "Join <b>harbour</b>"))
    page.get_by_label("Password of <b>harbour</b>").fill(PASSWORD)
    press(page, button(page, "Join"))
    expect(page.get_by_text("The boat is in <b>harbour</b> and stays there.")).to_be_visible()
    assert air.active() == ["<b>harbour</b>"]
    press(page, button(page, "Forget home"))
    expect(button(page, "Forget home")).to_have_count(0)
    assert [one["ssid"] for one in air.known()] == ["<b>harbour</b>"]


def test_the_boat_offers_its_own_network(
    visit: Visit, shore: ShoreBoat, air: Air, station: MavutilStation
) -> None:
    page = board(visit, shore, "desktop")
    expect(button(page, "Switch off")).to_be_disabled()
    page.get_by_label("Its password").fill(PASSWORD)
    press(page, button(page, "Switch on"))
    expect(
        page.get_by_text("The boat offers its own network, mavboat. Its address is 192.168.4.1.")
    ).to_be_visible()
    expect(page.get_by_text("The boat is in mavboat and stays there.")).to_be_visible()
    assert air.active() == ["mavboat"]
    expect(button(page, "Switch off")).to_be_enabled()


def test_a_restarted_boat_comes_back_to_the_same_page(
    visit: Visit, shore: ShoreBoat, station: MavutilStation
) -> None:
    page = board(visit, shore)
    said, child = len(shore.program.out), shore.child
    restart = button(page, "Restart")
    expect(restart).to_be_enabled()
    hold(page, restart, page.get_by_text(re.compile("Waiting for the boat|The boat is back")))
    again = shore.program.wait_for(r"on tcpin:127\.0\.0\.1:(\d+)$", after=said)
    shore.program.wait_for(
        re.escape(f"the page is still at {shore.address} with PIN {shore.pin}"), after=said
    )
    expect(page.get_by_text("The boat is back, after")).to_be_visible()
    fresh = MavutilStation(int(again[1]), 254)
    try:
        assert fresh.wait_for("SYSTEM_TIME").time_boot_ms < 60_000
    finally:
        fresh.close()
    assert shore.child == child


def test_a_wheel_is_installed_and_the_result_is_shown(
    visit: Visit, shore: ShoreBoat, updates: Path, station: MavutilStation, tmp_path: Path
) -> None:
    page = board(visit, shore)
    wheel = make_wheel(tmp_path)
    expect(page.get_by_text(f"mavboat {__version__} is installed.")).to_be_visible()
    expect(button(page, "Install")).to_be_hidden()
    page.get_by_label("Wheel file of mavboat").set_input_files(wheel)
    waits = page.get_by_text(f"Version 0.2.0 replaces {__version__}.").first
    expect(waits).to_be_visible()
    assert (updates / "new" / wheel.name).read_bytes() == wheel.read_bytes()
    assert not (updates / "start").exists()
    assert axe_faults(page) == []

    hold(page, button(page, "Install"), page.get_by_text("Installing 0.2.0. Leave the boat switched on."))
    assert (updates / "start").exists()
    text = "the boat's program did not start"
    told = {"state": "went back", "version": "0.2.0", "before": __version__, "text": text, "at_s": 1.8e9}
    aside = updates.parent / "aside"
    aside.write_text(json.dumps(told), encoding="utf-8")
    aside.replace(updates.parent / "result.json")
    (updates / "start").unlink()
    expect(
        page.get_by_text(f"Version 0.2.0 did not work, so the boat went back to {__version__}: {text}")
    ).to_be_visible()
    press(page, button(page, "Discard"))
    expect(button(page, "Install")).to_be_hidden()
    assert list((updates / "new").iterdir()) == []
