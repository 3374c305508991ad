"""MAVProxy's commands, one after the other, typed at the real program that is connected to the emulator."""

import re
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from patience import MOMENT_S
from programs import Program, start_boat

pytestmark = pytest.mark.realtime


@pytest.fixture(scope="module")
def proxy(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Program]:
    """One boat and one MAVProxy for all."""
    rooms: Path = tmp_path_factory.mktemp("mavproxy")
    boat = start_boat(rooms / "boat", "open")
    program = Program(rooms / "proxy", ["mavproxy.py", f"--master={boat.url}", "--state-basedir=."])
    try:
        program.wait_for("Received [0-9]+ parameters")
        yield program
    finally:
        program.close()
        boat.program.close()


def typed(proxy: Program, line: str, answer: str, timeout_s: float = MOMENT_S) -> re.Match[str]:
    """Type a command and wait for what it must bring."""
    said = len(proxy.out)
    proxy.say(line)
    return proxy.wait_for(answer, timeout_s, after=said)


def typed_until(proxy: Program, line: str, answer: str, timeout_s: float = MOMENT_S) -> None:
    """Type a command again and again until it brings what it must: MAVProxy carries some out later."""
    give_up_s = time.monotonic() + timeout_s
    while True:
        said = len(proxy.out)
        proxy.say(line)
        try:
            proxy.wait_for(answer, 0.5, after=said)
        except AssertionError:
            if time.monotonic() > give_up_s:
                raise
        else:
            return


def test_param_shows_sets_and_fetches(proxy: Program) -> None:
    assert float(typed(proxy, "param show CRUISE_SPEED", r"CRUISE_SPEED +([0-9.]+)")[1]) == 2.0
    proxy.say("param set CRUISE_SPEED 1.5")
    typed_until(proxy, "param fetch CRUISE_SPEED", r"CRUISE_SPEED *= *1\.5")
    proxy.say("param set CRUISE_SPEED 2")
    typed_until(proxy, "param fetch CRUISE_SPEED", r"CRUISE_SPEED *= *2\.0")
    typed(proxy, "param fetch", "Received [0-9]+ parameters")


def test_mode_changes_the_mode(proxy: Program) -> None:
    for mode in ("manual", "loiter", "guided", "hold"):
        typed(proxy, f"mode {mode}", f"Mode {mode.upper()}")


def test_wp_loads_lists_sets_and_clears_a_mission_that_is_sailed(proxy: Program) -> None:
    rows = [f"{n}\t0\t3\t16\t0\t0\t0\t0\t{50.0 + 1e-4 * n:.7f}\t-1.2\t0\t1" for n in range(6)]
    (proxy.room / "plan.txt").write_text("\n".join(["QGC WPL 110", *rows, ""]), encoding="ascii")
    typed(proxy, "wp load plan.txt", "Got MISSION_ACK: TYPE_MISSION: ACCEPTED")
    typed(proxy, "wp list", "Saved 6 waypoints to")
    typed(proxy, "arm throttle", "^ARMED")
    typed(proxy, "mode auto", "^waypoint 2")
    typed(proxy, "mode hold", "Mode HOLD")
    typed(proxy, "disarm", "^DISARMED")
    proxy.say("wp set 3")
    typed_until(proxy, "status MISSION_CURRENT", r"MISSION_CURRENT \{.*seq : 3")
    typed(proxy, "wp clear", "Got MISSION_ACK: TYPE_MISSION: ACCEPTED")
    typed(proxy, "wp list", "Requesting 0 waypoints|Saved 0|No waypoints")


def test_fence_loads_and_lists(proxy: Program) -> None:
    corners = [(50.001, -1.201), (50.001, -1.199), (49.999, -1.199), (49.999, -1.201)]
    rows = [
        f"{n}\t0\t0\t5001\t4\t0\t0\t0\t{lat:.7f}\t{lon:.7f}\t0\t1" for n, (lat, lon) in enumerate(corners)
    ]
    (proxy.room / "fence.txt").write_text("\n".join(["QGC WPL 110", *rows, ""]), encoding="ascii")
    typed(proxy, "fence load fence.txt", "Got MISSION_ACK: TYPE_FENCE: ACCEPTED")
    typed(proxy, "fence list", "Saved 4 fence items to|Saved 4 ")
    typed(proxy, "fence clear", "Got MISSION_ACK: TYPE_FENCE: ACCEPTED")


def test_rally_loads_and_lists(proxy: Program) -> None:
    rows = [f"{n}\t0\t3\t5100\t0\t0\t0\t0\t{50.0005 + 1e-4 * n:.7f}\t-1.2\t0\t1" for n in range(3)]
    (proxy.room / "rally.txt").write_text("\n".join(["QGC WPL 110", *rows, ""]), encoding="ascii")
    typed(proxy, "rally load rally.txt", "Got MISSION_ACK: TYPE_RALLY: ACCEPTED")
    typed(proxy, "rally list", "Saved 3 ")
    typed(proxy, "rally clear", "Got MISSION_ACK: TYPE_RALLY: ACCEPTED")


def test_rc_drives_an_armed_boat_in_manual_and_arm_and_disarm_work(proxy: Program) -> None:
    typed(proxy, "mode manual", "Mode MANUAL")
    typed(proxy, "arm throttle", "^ARMED")
    proxy.say("rc 3 1800")
    typed_until(
        proxy, "status SERVO_OUTPUT_RAW", r"SERVO_OUTPUT_RAW \{.*servo1_raw : (1[6-9][0-9][0-9]|2000)"
    )
    proxy.say("rc 3 0")
    typed(proxy, "disarm", "^DISARMED")
    typed(proxy, "mode hold", "Mode HOLD")


def test_nothing_went_wrong_on_the_way(proxy: Program) -> None:
    assert proxy.is_running
    assert not re.search("Traceback|error", proxy.err, re.IGNORECASE)
