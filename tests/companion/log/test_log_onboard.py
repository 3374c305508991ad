"""The boat's own log: what it says against what the boat did, when it begins and ends, and in need."""

import math
import subprocess
import sys
from itertools import pairwise
from pathlib import Path

import msgspec
import pytest
from boat_rig import OK, waypoint
from log_rig import LogRig, MemorySink, OpenRig, Record, of_kind, read_log
from payload_rig import CAMERA, PAYLOAD

from companion.control.heading import learned_gains
from companion.core.geo import LatLon
from companion.core.state import MotorCommand, NavState, PidOutput
from companion.core.status_text import Severity, StatusText
from companion.mavlink.items import MissionItem

pytest_plugins = ("log_fixtures",)

AUTO, LOITER = 10, 5


class Voyage:
    """A short mission, and what the boat knew at each tick of it."""

    def __init__(self, folder: Path) -> None:
        rig = self.rig = LogRig(folder)
        self.nav: dict[int, NavState] = {}
        self.heading: dict[int, PidOutput] = {}
        self.speed: dict[int, PidOutput] = {}
        self.commands: dict[int, MotorCommand] = {}
        rig.sail(waypoint(12, 0), waypoint(12, 9))
        while rig.mode == "AUTO":
            self._step()
        rig.disarm()
        rig.boat.close()
        self.records = read_log(folder / "00001.bin")

    def _step(self) -> None:
        rig, boat = self.rig, self.rig.boat
        us = round(rig.now_s * 1e6)
        rig.step()
        self.commands[us] = boat.command
        if boat.nav is not None:
            self.nav[us] = boat.nav
        if boat.guidance.helm.heading_pid is not None and boat.guidance.helm.speed_pid is not None:
            self.heading[us], self.speed[us] = boat.guidance.helm.heading_pid, boat.guidance.helm.speed_pid

    def of(self, name: str) -> list[Record]:
        """Records of a kind from the ticks that were watched."""
        return [record for record in of_kind(self.records, name) if record.TimeUS in self.nav]


@pytest.fixture(scope="module")
def voyage(tmp_path_factory: pytest.TempPathFactory) -> Voyage:
    return Voyage(tmp_path_factory.mktemp("logs"))


def near(value: float) -> object:
    """The same, but for what a 32-bit float loses."""
    return pytest.approx(value, rel=1e-6, abs=1e-6)


def test_attitude_and_estimate_are_the_boats_at_the_same_tick(voyage: Voyage) -> None:
    assert len(voyage.of("ATT")) > 50
    for att in voyage.of("ATT"):
        nav = voyage.nav[att.TimeUS]
        assert att.Yaw == pytest.approx(math.degrees(nav.heading_rad) % 360.0, abs=1e-4)
    for one in voyage.of("XKF1"):
        nav = voyage.nav[one.TimeUS]
        assert (near(nav.north_m), near(nav.east_m)) == (one.PN, one.PE)
        assert (near(nav.north_m_s), near(nav.east_m_s)) == (one.VN, one.VE)
    frame = voyage.rig.boat.estimator.frame
    assert frame is not None
    for pos in voyage.of("POS"):
        place = frame.to_global(voyage.nav[pos.TimeUS].point)
        assert (pos.Lat, pos.Lng) == pytest.approx((place.lat_deg, place.lon_deg), abs=1.1e-7)
    for boat in voyage.of("BOAT"):
        nav = voyage.nav[boat.TimeUS]
        assert (boat.Surge, boat.Sway) == (near(nav.surge_m_s), near(nav.sway_m_s))
        assert boat.YawRate == near(math.degrees(nav.yaw_rate_rad_s))


def test_pid_terms_are_those_of_the_loops(voyage: Voyage) -> None:
    assert len(voyage.of("PIDS")) > 50
    for pids in voyage.of("PIDS"):
        pid = voyage.heading[pids.TimeUS]
        assert (pids.P, pids.I, pids.D, pids.Limit) == (near(pid.p), near(pid.i), near(pid.d), pid.saturated)
        assert near(pid.ff) == pids.FF
        nav, config = voyage.nav[pids.TimeUS], voyage.rig.config
        stiffness, _ = learned_gains(nav.yaw_accel_rad_s2, nav.yaw_damping_per_s, config.handling)
        kp = stiffness * config.heading.kp
        assert math.radians(pids.Err) * kp == pytest.approx(pid.p, abs=1e-5)
    for pida in voyage.of("PIDA"):
        pid = voyage.speed[pida.TimeUS]
        assert (pida.P, pida.I, pida.Limit) == (near(pid.p), near(pid.i), pid.saturated)
        assert pida.Act == near(voyage.nav[pida.TimeUS].surge_m_s)


def test_outputs_are_what_the_motors_were_given(voyage: Voyage) -> None:
    assert len(voyage.of("RCOU")) > 50
    for out in voyage.of("RCOU"):
        command = voyage.commands[out.TimeUS]
        assert round(1500 + 500 * command.left) == out.C1
        assert round(1500 + 500 * command.right) == out.C3
    for throttle in voyage.of("THR"):
        command = voyage.commands[throttle.TimeUS]
        assert throttle.ThrOut == near(50.0 * (command.left + command.right))


def test_motion_is_logged_ten_times_a_second_and_status_once(voyage: Voyage) -> None:
    times = [record.TimeUS for record in voyage.of("ATT")]
    assert {after - before for before, after in pairwise(times)} == {100_000}
    times = [record.TimeUS for record in voyage.of("DSF")]
    assert {after - before for before, after in pairwise(times)} == {1_000_000}


def test_each_fix_is_logged_once_at_its_own_time_with_its_date(voyage: Voyage) -> None:
    fixes = of_kind(voyage.records, "GPS")
    times = [fix.TimeUS for fix in fixes]
    assert len(times) > 20
    assert times == sorted(set(times))
    epoch_s = 315_964_800 - 18
    starts = [epoch_s + fix.GWk * 604_800 + fix.GMS / 1e3 - fix.TimeUS / 1e6 for fix in fixes]
    # The boot's date, whichever fix it is worked out from; the boat still learns the delay of the line
    assert max(starts) - min(starts) < 0.05
    assert 1.7e9 < min(starts) < 2e9


def test_battery_sonar_and_links_are_logged(voyage: Voyage) -> None:
    packs = of_kind(voyage.records, "BAT")
    assert all(11.0 < pack.Volt < 13.0 and pack.Curr >= 0.0 for pack in packs)
    assert packs[-1].CurrTot > packs[0].CurrTot
    pings = of_kind(voyage.records, "SONR")
    assert {ping.Max for ping in pings} == {4.0}
    assert len(of_kind(voyage.records, "RFND")) == len(pings) > 50
    first, *_, last = of_kind(voyage.records, "MAV")
    assert (first.chan, last.rxdp, last.tf) == (1, 0, 0)
    assert last.txp > first.txp > 0
    assert last.rxp >= first.rxp > 0


def test_events_tell_the_story_of_the_voyage(voyage: Voyage) -> None:
    assert [mode.ModeNum for mode in of_kind(voyage.records, "MODE")] == [AUTO, LOITER]
    assert [event.Id for event in of_kind(voyage.records, "EV")] == [10, 25, 11]
    assert [arm.ArmState for arm in of_kind(voyage.records, "ARM")] == [1, 0]
    lines = [line.Message for line in of_kind(voyage.records, "MSG")]
    story = (
        "Armed",
        "Mode AUTO",
        "Reached item 1",
        "Reached item 2",
        "Mission complete",
        "Disarmed by command",
    )
    assert tuple(line for line in lines if line in story) == story
    assert [item.CNum for item in of_kind(voyage.records, "MISE")] == [1, 2]


def test_the_whole_mission_and_every_parameter_are_in_it(voyage: Voyage) -> None:
    assert [(item.CTot, item.CNum, item.CId) for item in of_kind(voyage.records, "CMD")] == [
        (3, 0, 16), (3, 1, 16), (3, 2, 16)
    ]  # fmt: skip
    held = voyage.rig.boat.parameters
    logged = {parm.Name: parm.Value for parm in of_kind(voyage.records, "PARM")}
    assert logged == {row.name: near(held.value(row)) for row in held.rows}


def test_pymavlinks_own_tool_reads_it_without_complaint(voyage: Voyage) -> None:
    tool = Path(sys.executable).parent / "mavlogdump.py"
    path = voyage.rig.store.folder / "00001.bin"
    done = subprocess.run(
        [sys.executable, str(tool), "--types", "MODE,MSG", str(path)],
        capture_output=True,
        text=True,
        check=True,
    )
    assert "ModeNum : 10" in done.stdout
    assert "bad header" not in done.stdout + done.stderr


def test_a_parameter_changed_under_way_is_logged_with_its_new_value(
    open_rig: OpenRig, tmp_path: Path
) -> None:
    rig = open_rig(tmp_path)
    rig.sail(waypoint(50, 0)).run(3.0)
    assert rig.boat.parameters.set("CRUISE_SPEED", 1.25) == ""
    rig.run(2.0)
    rig.boat.close()
    logged = of_kind(read_log(tmp_path / "00001.bin"), "PARM")
    assert [parm.Value for parm in logged if parm.Name == "CRUISE_SPEED"] == [2.0, 1.25]


def test_the_log_begins_with_arming_and_ends_some_time_after_disarming(
    open_rig: OpenRig, tmp_path: Path
) -> None:
    rig = open_rig(tmp_path, config={"log.after_disarm_s": 3.0})
    rig.ready().run(2.0)
    assert rig.store.files == ()
    assert rig.arm() == OK
    rig.run(1.0)
    rig.ask(400, 0.0)
    disarmed_us = rig.now_s * 1e6
    rig.run(2.9)
    writing = [rig.log.is_writing]
    rig.run(0.2)
    assert [*writing, rig.log.is_writing] == [True, False]
    last = of_kind(read_log(tmp_path / "00001.bin"), "ATT")[-1]
    assert last.TimeUS - disarmed_us == pytest.approx(2.9e6, abs=0.15e6)
    assert rig.arm() == OK
    rig.run(1.0)
    rig.boat.close()
    assert of_kind(read_log(tmp_path / "00002.bin"), "EV"), "each arming has a log of its own"


def test_a_boat_may_log_from_boot_on_or_never(open_rig: OpenRig, tmp_path: Path) -> None:
    always = open_rig(tmp_path / "always", config={"log.disarmed": True})
    always.run(1.0)
    assert always.log.is_writing
    never = open_rig(tmp_path / "never", config={"log.onboard": False}).ready()
    assert never.arm() == OK
    never.run(1.0)
    assert (tmp_path / "never" / "00001.bin").exists() is False


def test_a_log_that_grows_past_half_the_quota_is_followed_by_another(
    open_rig: OpenRig, tmp_path: Path
) -> None:
    rig = open_rig(tmp_path, quota_mb=1.0, config={"log.quota_mb": 1.0, "log.motion_hz": 50.0})
    rig.sail(waypoint(2000, 0)).run(35.0)
    rig.boat.close()
    sizes = [file.size_bytes for file in rig.store.logs]
    assert len(sizes) >= 2
    assert sizes[0] == pytest.approx(500_000, rel=0.1)
    assert sum(sizes) <= 1_600_000
    assert of_kind(read_log(tmp_path / rig.store.logs[-1].name), "ATT")


def test_blocks_are_handed_over_as_they_fill(open_rig: OpenRig, tmp_path: Path) -> None:
    clerk = MemorySink()
    rig = open_rig(tmp_path, sink=clerk, config={"log.motion_hz": 50.0})
    rig.sail(waypoint(500, 0)).run(3.0)
    sizes = [len(block) for block in clerk.blocks]
    assert max(sizes[1:]) < 2 * 4096  # the first holds the definitions
    assert sum(sizes) / len(sizes) > 2048


def test_what_the_medium_is_too_slow_for_is_lost_counted_and_logged(
    open_rig: OpenRig, tmp_path: Path
) -> None:
    clerk = MemorySink()
    rig = open_rig(tmp_path, sink=clerk)
    rig.sail(waypoint(500, 0)).run(5.0)
    clerk.takes = False
    rig.run(3.0)
    assert rig.log.dropped > 100
    clerk.takes = True
    rig.run(3.0)
    path = tmp_path / "with_a_gap.bin"
    path.write_bytes(b"".join(clerk.blocks))
    assert of_kind(read_log(path), "DSF")[-1].Dp == rig.log.dropped
    assert rig.log.is_writing


def test_a_full_medium_stops_the_log_once_and_the_boat_goes_on(open_rig: OpenRig, tmp_path: Path) -> None:
    clerk = MemorySink()
    rig = open_rig(tmp_path, sink=clerk, config={"log.after_disarm_s": 0.5})
    rig.sail(waypoint(500, 0)).run(3.0)
    clerk.fault = "No space left on device"
    rig.run(5.0)
    assert [text for text in rig.peer.texts if "Log" in text] == ["Log stopped: No space left on device"]
    assert (rig.mode, rig.boat.vehicle.armed, rig.log.is_writing, clerk.begun) == ("AUTO", True, False, 1)
    assert rig.boat.command.left > 0.1
    rig.disarm()
    assert rig.arm() == OK  # a new attempt with each arming
    rig.run(1.0)
    assert (rig.log.is_writing, clerk.begun) == (True, 2)


def test_a_log_whose_definitions_are_not_taken_is_given_up(open_rig: OpenRig, tmp_path: Path) -> None:
    clerk = MemorySink()
    clerk.takes = False
    rig = open_rig(tmp_path, sink=clerk).ready()
    assert rig.arm() == OK
    rig.run(3.0)
    assert not rig.log.is_writing
    assert [text for text in rig.peer.texts if "Log" in text] == ["Log stopped: the write queue is full"]


def test_a_number_that_no_field_holds_costs_a_record_not_the_boat(open_rig: OpenRig, tmp_path: Path) -> None:
    rig = open_rig(tmp_path)
    rig.sail(waypoint(500, 0)).run(2.0)
    rig.boat.guidance.helm.heading_pid = PidOutput(1e300, 0.0, 0.0, 0.0, False)
    later_s = rig.now_s + 1.0
    now = msgspec.structs.replace(rig.boat.take_snapshot(), now_s=later_s)
    rig.log.tick(later_s, lambda: now, rig.boat.channels)
    assert rig.log.faults == 1
    rig.run(2.0)
    assert rig.log.faults == 1
    assert rig.mode == "AUTO"


def test_lines_said_just_before_the_log_began_are_in_it(open_rig: OpenRig, tmp_path: Path) -> None:
    rig = open_rig(tmp_path).ready()
    for number in range(30):
        rig.logbook.note(StatusText(Severity.INFO, f"before {number}"))
    assert rig.arm() == OK
    rig.run(1.2)
    rig.logbook.note(StatusText(Severity.INFO, "x" * 100))
    rig.boat.close()
    lines = [line.Message for line in of_kind(read_log(tmp_path / "00001.bin"), "MSG")]
    assert [line for line in lines if line.startswith("before")] == [f"before {n}" for n in range(11, 30)]
    assert lines[-2:] == ["x" * 64, "x" * 36]


def test_lost_parts_and_low_packs_are_errors_with_ardupilots_numbers(
    open_rig: OpenRig, tmp_path: Path
) -> None:
    rig = open_rig(tmp_path, config={"failsafe.battery_low_v": 20.0, "failsafe.battery_low_s": 1.0})
    rig.sail(waypoint(500, 0)).run(3.0)
    rig.boat.close()
    errors = [(error.Subsys, error.ECode) for error in of_kind(read_log(tmp_path / "00001.bin"), "ERR")]
    assert errors == [(6, 1)]


def test_a_transmitters_channels_are_logged_and_its_loss_is_an_error_until_it_is_heard_again(
    open_rig: OpenRig, tmp_path: Path
) -> None:
    receiver = (
        "sensors.rc={fitted=true, noise_us=0.0, quality=0.75, sticks=[{channels=[1510, 1200, 1500, 1400]}]}"
    )
    rig = open_rig(tmp_path, receiver, 'faults=[{what="rc", at_s=6.0, for_s=4.0}]').ready()
    assert rig.arm() == OK
    rig.run(12.0)
    rig.boat.close()
    records = read_log(tmp_path / "00001.bin")
    assert [(error.Subsys, error.ECode) for error in of_kind(records, "ERR")] == [(5, 1), (5, 0)]
    heard = of_kind(records, "RCIN")
    assert len(heard) > 40
    assert {(one.C1, one.C2, one.C3, one.C4, one.C5) for one in heard} == {(1510, 1200, 1500, 1400, 0)}
    assert {(one.RXLQ, one.RXRSSI) for one in of_kind(records, "RSSI")} == {(75.0, -60.0)}


def test_payload_actions_and_images_are_logged_with_their_place(tmp_path: Path) -> None:
    rig = LogRig(tmp_path, PAYLOAD, CAMERA)
    servo = MissionItem(2, 183, param1=9.0, param2=1250.0)
    image = MissionItem(2, 2000, param3=1.0)
    rig.sail(waypoint(12, 0), servo, image, waypoint(24, 0))
    rig.until(lambda: rig.mode != "AUTO", 60.0)
    rig.disarm()
    rig.boat.close()
    records = read_log(tmp_path / "00001.bin")
    (written,) = [one for one in of_kind(records, "PAYL") if one.Val == 1250.0]
    (taken,) = of_kind(records, "CAM")
    assert written.Name.startswith("servo 9 (bait)")
    frame = rig.scenario.frame
    for one in (written, taken):
        point = frame.to_local(LatLon(one.Lat, one.Lng))
        assert abs(point.north_m - 12.0) < 3.0
        assert abs(point.east_m) < 3.0
    assert taken.TimeUS == pytest.approx(written.TimeUS, abs=40_000)  # at the shutter
    assert taken.Img == 0
    assert min(taken.Y, 360.0 - taken.Y) < 20.0
    assert [one.C9 for one in of_kind(records, "RCOU")][-1] == 1250
