"""The page when its server is gone, hangs or is told nonsense."""

import os
import signal
import socket
import sys
from collections.abc import Iterator

import pytest
from finger import hold
from mavutil_station import MavutilStation
from page_rig import (
    ShoreBoat,
    Visit,
    boat_at_sea,
    button,
    needs_chromium,
    show_all_buttons,
    skipper,
    told,
    until_mode,
)
from playwright.sync_api import expect
from programs import RunProgram
from pymavlink.dialects.v20 import all as dialect

from companion.core.modes import Mode

pytest_plugins = ("page_fixtures", "program_fixtures")
pytestmark = [pytest.mark.realtime, needs_chromium]

SCRIPT = "<img src=x onerror=document.title='taken'><b>Why"


def test_what_the_boat_says_is_text_and_no_part_of_the_page(visit: Visit, shore: ShoreBoat) -> None:
    page = visit("phone")
    expect(page.get_by_text("Connected", exact=True).first).to_be_visible()
    link = dialect.MAVLink(None, 1, 1)
    options = shore.options()
    port = int(options[options.index("--connect") + 1].rpartition(":")[2])
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as wire:
        text = dialect.MAVLink_statustext_message(2, SCRIPT.encode())
        wire.sendto(text.pack(link), ("127.0.0.1", port))
    expect(page.get_by_text(SCRIPT).first).to_be_attached()
    assert page.title() != "taken"
    assert page.locator("img").count() == 0


def test_a_request_while_the_server_hangs_is_done_once_when_it_is_back(
    visit: Visit, shore: ShoreBoat, station: MavutilStation
) -> None:
    page = skipper(visit, shore)
    show_all_buttons(page)
    hold(page, button(page, "Arm"), told(page, "Arm: The propellers may turn"))
    child = shore.child
    os.kill(child, signal.SIGSTOP)
    try:
        hold(page, button(page, "Return"), told(page, "Return: asked"))
        expect(page.get_by_text("Not connected. Trying again.").first).to_be_visible()
        expect(page.get_by_text("Last heard").first).to_be_visible()
        until_mode(station, Mode.HOLD, armed=True)
    finally:
        os.kill(child, signal.SIGCONT)
    until_mode(station, Mode.RTL, armed=True)
    station.enter(Mode.HOLD)
    expect(told(page, "Return: The boat returns home")).to_be_visible()
    expect(page.get_by_text("Connected", exact=True).first).to_be_visible()
    beats = [message for message in station.listen(5.0) if message.get_type() == "HEARTBEAT"]
    modes = [beat.custom_mode for beat in beats if beat.get_srcSystem() == 1]
    assert set(modes[1:]) == {Mode.HOLD}
    hold(page, button(page, "Motors off"), told(page, "Motors off: Stopped"))


SLOW_SERVER = """async () => {
  const { Live } = await import("/shared/live.js");
  let now = 0;
  const sockets = [];
  const open = () => {
    const one = { readyState: 1, sinceMs: now, send() {}, close() { one.isClosed = true; } };
    sockets.push(one);
    return one;
  };
  const live = new Live({ hello() {}, state() {}, link() {} }, { now: () => now, open });
  live.connect();
  for (; now < 120_000 && !live.isConnected; now += 250) {
    for (const one of sockets)
      if (!one.isClosed && now - one.sinceMs >= 10_000)
        one.onmessage({ data: '{"type": "hello", "role": "viewer", "boats": []}' });
    live.tick();
  }
  return [live.isConnected, sockets.length];
}"""


def test_a_server_that_greets_after_ten_seconds_is_waited_for(visit: Visit, shore: ShoreBoat) -> None:
    assert visit("desktop").evaluate(SLOW_SERVER) == [True, 2]


@pytest.fixture
def lonely(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ShoreBoat]:
    """A boat of which the page's program may die."""
    yield from boat_at_sea(tmp_path_factory)


def test_the_boat_does_not_notice_that_the_server_dies_and_the_page_goes_on_when_it_starts_again(
    visit: Visit, lonely: ShoreBoat, run_program: RunProgram
) -> None:
    page = visit("phone", address=lonely.address)
    expect(page.get_by_text("Connected", exact=True).first).to_be_visible()
    options = lonely.options()
    options[options.index("--listen") + 1] = lonely.address.removeprefix("http://").rstrip("/")
    os.kill(lonely.child, signal.SIGKILL)
    lonely.program.wait_for(r"^boat-sitl: the page's program ended with -9; the boat does not need it$")
    station = MavutilStation(lonely.tcp)  # which hears a heartbeat
    station.close()
    expect(page.get_by_text("Not connected. Trying again.").first).to_be_visible()
    expect(page.get_by_text("Last heard").first).to_be_visible()
    run_program(sys.executable, "-m", "mission_tools.shore", *options)
    expect(page.get_by_text("Connected", exact=True).first).to_be_visible()
    expect(page.get_by_text("Last heard").first).to_be_hidden()
