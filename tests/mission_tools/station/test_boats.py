"""Boats: what is seen of one boat or several, over links that come and go."""

import struct
from pathlib import Path

import msgspec
import pytest
from blank_messages import blank
from boat_rig import HOME_ITEM, Rig, scenario, waypoint
from pymavlink.dialects.v20 import all as peer
from shore_rig import UNIX_S, LossyEnd, Shore

from companion.core.geo import Point
from companion.links.memory import MemoryLink, memory_pair
from companion.mavlink.dialect import dialect
from mission_tools.station import boats
from mission_tools.station.boats import Boats
from mission_tools.station.view import HANDLERS, View

pytestmark = pytest.mark.slow


def test_the_main_values_of_a_boat() -> None:
    rig = Rig()
    shore = Shore(rig).ready()
    shore.run(3.0)
    seen, truth = shore.snapshot(), rig.world.truth
    assert (seen.boat, seen.mode, seen.armed, seen.state) == (1, "HOLD", False, "standby")
    assert "LOITER" in seen.modes
    assert seen.heard_s is not None
    assert abs(seen.heard_s - (UNIX_S + shore.now_s)) <= 1.1
    assert seen.battery is not None
    assert seen.battery.voltage_v is not None
    assert 11.0 < seen.battery.voltage_v < 13.0
    assert seen.battery.left_s is None, "at rest the charge lasts for hours"
    assert seen.fix is not None
    assert seen.compass is not None
    assert (seen.fix.type, seen.compass.text) == ("RTK float", "good")
    assert seen.fix.error_m is not None
    assert seen.place is not None
    at = scenario().frame.to_global(Point(truth.north_m, truth.east_m))
    assert abs(seen.place.lat - at.lat_deg) < 1e-4
    assert abs(seen.place.lon - at.lon_deg) < 1e-4
    assert seen.home is not None
    assert seen.home.distance_m is not None
    assert seen.cruise_m_s == scenario().vehicle.speed.cruise_m_s
    assert seen.obstacles is not None
    assert len(seen.obstacles.ranges_m) == 72
    assert None not in (seen.current, seen.sonar, seen.load)
    assert b"NaN" not in msgspec.json.encode(seen)


def test_two_boats_are_told_apart() -> None:
    other = Rig(config={"identity.system_id": 2})
    rig = Rig()
    shore = Shore(rig, other).ready()
    assert [one.id for one in shore.boats.names()] == [1, 2]
    assert shore.ask("arm", boat=2).ok
    assert shore.ask("set_mode", {"mode": "LOITER"}, boat=2).ok
    assert (rig.boat.vehicle.armed, other.boat.vehicle.armed) == (False, True)
    shore.run(1.5)
    assert (shore.snapshot(1).mode, shore.snapshot(2).mode) == ("HOLD", "LOITER")
    first, second = shore.boats.names()
    assert (first.mode, first.armed, second.mode, second.armed) == ("HOLD", False, "LOITER", True)
    seen = shore.snapshot(2)
    assert seen.battery is not None
    assert (second.place, second.heading_deg) == (seen.place, seen.heading_deg)
    assert second.percent == seen.battery.percent is not None
    shore.ends[1].loss = 1.0
    shore.run(5.0)
    ages_s = [one.age_s or 0.0 for one in shore.boats.names()]
    assert ages_s[0] < 1.1
    assert 4.9 < ages_s[1] < 6.5
    assert shore.snapshot(2).place is not None


def test_a_restarted_boat_is_asked_for_its_streams_again() -> None:
    rig = Rig()
    shore = Shore(rig).ready()
    shore.ends[0].close()
    rig.reboot()
    shore.ends.append(shore.link(rig))
    shore.run(20.0)
    before = shore.snapshot().sonar
    seen = {str(before)}
    for _ in range(25):
        shore.run(0.2)
        seen.add(str(shore.snapshot().sonar))
    assert len(seen) > 8  # pings at the rate asked for
    assert shore.ask("arm").ok


def test_a_list_that_another_station_changes_gets_a_new_version() -> None:
    rig = Rig().ready()
    rig.upload([HOME_ITEM, waypoint(60.0, 0.0)])
    shore = Shore(rig).ready()
    before = shore.snapshot().mission
    assert before is not None
    assert before.version == 1
    shore.run(35.0)  # it is read again meanwhile
    assert shore.snapshot().mission == before  # home moves with the boat: no new version
    rig.upload([HOME_ITEM, waypoint(60.0, 0.0), waypoint(0.0, 60.0)])
    shore.run(3.0)
    after = shore.snapshot().mission
    assert after is not None
    assert (after.count, after.version) == (2, 2)
    rig.upload([HOME_ITEM, waypoint(61.0, 0.0), waypoint(0.0, 60.0)])  # as many items
    shore.until(lambda: (last := shore.snapshot().mission) is not None and last.version == 3, 40.0)


def test_the_page_is_the_operator_only_while_somebody_steers() -> None:
    rig = Rig()
    shore = Shore(rig)
    shore.boats.is_operator = False
    shore.run(3.0)
    kinds = {one.type for one in rig.peer.said("HEARTBEAT")}
    assert dialect.MAV_TYPE_ONBOARD_CONTROLLER in kinds
    assert dialect.MAV_TYPE_GCS not in kinds
    shore.boats.is_operator = True
    shore.run(3.0)
    shore.ends[0].loss = 1.0  # the page's computer is gone
    shore.run(8.0)
    assert any(text.startswith("Failsafe: Operator lost") for text in rig.peer.texts)


def stranger(shore: Shore) -> MemoryLink:
    """A link on which a test says what boats say."""
    near, far = memory_pair("stranger")
    shore.port.fresh.append(LossyEnd(far, 0.0, 1))
    return near


def heartbeat(system: int, *, armed: bool = False) -> bytes:
    said = peer.MAVLink(None, system, 1)
    return bytes(said.heartbeat_encode(11, 3, 128 if armed else 0, 0, 4).pack(said))


def mission_current(*ids: int, total: int = 0) -> bytes:
    """MISSION_CURRENT as common.xml has it now: the three ids are extensions behind mission_mode."""
    payload = struct.pack("<HHBB3I", 0, total, 0, 0, *ids).rstrip(b"\0") or b"\0"
    head = struct.pack("<BBBBBB", len(payload), 0, 0, 0, 1, 1) + (42).to_bytes(3, "little")
    crc = peer.x25crc(head + payload)
    crc.accumulate(b"\x1c")  # CRC_EXTRA 28
    return b"\xfd" + head + payload + struct.pack("<H", crc.crc)


def asked_lists(link: MemoryLink) -> list[int]:
    """The lists that the station has asked for, by mission type; each is answered with an empty one."""
    decoder, said = peer.MAVLink(None), peer.MAVLink(None, 1, 1)
    asked = []
    for chunk in link.receive():
        for message in decoder.parse_buffer(chunk) or []:
            if message.get_type() == "MISSION_REQUEST_LIST":
                asked.append(message.mission_type)
                count = said.mission_count_encode(250, 190, 0, message.mission_type)
                link.send(bytes(count.pack(said)))
    return asked


def test_a_list_with_a_new_id_is_read_again_at_once() -> None:
    shore = Shore()
    link = stranger(shore)

    def asked_within(seconds: int, *ids: int, total: int = 0) -> list[int]:
        asked = []
        for _ in range(seconds * 10):
            link.send(heartbeat(1))
            link.send(mission_current(*ids, total=total))
            shore.run(0.1)
            asked += asked_lists(link)
        return asked

    assert asked_within(5, 7, 3, 0) == [0, 1, 2]
    assert asked_within(10, 7, 3, 0) == []
    assert asked_within(2, 8, 3, 0) == [0]
    assert asked_within(2, 8, 4, 0) == [1]
    assert asked_within(2, 8, 4, 1) == [2]
    assert asked_within(10, 8, 4, 1) == []
    assert asked_within(2, 8, 4, 1, total=5) == [0], "another number of items, of a boat without ids"


def test_a_boat_that_is_heard_on_another_link_is_asked_for_its_streams_there() -> None:
    shore = Shore()
    for link in (stranger(shore), stranger(shore)):
        link.send(heartbeat(1))
        shore.run(0.2)
        decoder = peer.MAVLink(None)
        names = [one.get_type() for data in link.receive() for one in decoder.parse_buffer(data) or []]
        assert names.count("COMMAND_LONG") >= 12


def test_boats_that_were_heard_once_give_way_to_one_that_comes() -> None:
    shore = Shore()
    link = stranger(shore)
    link.send(heartbeat(1))
    shore.run(0.1)
    for system in range(100, 99 + boats.MOST_BOATS):
        link.send(heartbeat(system, armed=True))
    shore.run(0.1)
    assert len(shore.boats.names()) == boats.MOST_BOATS
    link.send(heartbeat(2))
    shore.run(0.1)
    assert shore.boats.snapshot(2) is None, "all others are heard"
    shore.run(6.0)
    link.send(heartbeat(2))
    shore.run(0.1)
    assert shore.boats.snapshot(2) is not None
    assert shore.boats.snapshot(1) is not None, "the first boat stays, however silent"
    assert len(shore.boats.names()) == boats.MOST_BOATS


def test_a_boat_that_is_silent_for_an_hour_is_forgotten_but_not_the_first() -> None:
    shore = Shore()
    link = stranger(shore)
    link.send(heartbeat(3))
    shore.run(0.1)
    link.send(heartbeat(77, armed=True))
    shore.run(0.1)
    shore.now_s += 3600.0 - 2.0
    shore.poll()
    assert len(shore.boats.names()) == 2
    shore.now_s += 3.0
    shore.poll()
    assert [one.id for one in shore.boats.names()] == [3]


def test_the_time_left_is_told_once_the_armed_boat_has_sailed_for_a_minute() -> None:
    view, left_s = View(), []

    def hear(kind: str, **values: float) -> None:
        message = blank(kind, **values)
        HANDLERS[message.get_msgId()](view, message)

    hear("battery_status", time_remaining=900)
    for armed, speed_cm_s, boot_ms in (
        (0, 50, 0),
        (1, 29, 10_000),
        (1, 30, 20_000),
        (1, 0, 79_999),
        (1, 0, 80_000),
    ):
        hear("heartbeat", base_mode=128 * armed)
        hear("global_position_int", lat=500000000, lon=1, vx=speed_cm_s, time_boot_ms=boot_ms)
        hear("sys_status")
        assert view.battery is not None
        left_s.append(view.battery.left_s)
    assert left_s == [None, None, None, None, 900.0]
    hear("heartbeat")
    hear("global_position_int", lat=500000000, lon=1, time_boot_ms=90_000)
    assert not view.has_sailed


@pytest.mark.parametrize(
    ("clocks", "starts"),
    [
        ([0, 1000, 2000], 0),
        ([90_000, 89_600, 90_200], 0),  # two links that change the order
        ([90_000, 89_600, 89_200, 90_200], 1),
        ([90_000, 100, 1000, 0, 50], 2),
    ],
)
def test_a_clock_that_goes_back_counts_as_a_start(clocks: list[int], starts: int) -> None:
    view = View()
    for boot_ms in clocks:
        HANDLERS[dialect.MAVLINK_MSG_ID_SYSTEM_TIME](view, dialect.MAVLink_system_time_message(0, boot_ms))
    assert view.starts == starts


def test_the_first_boat_is_the_one_of_this_computer(tmp_path: Path) -> None:
    file = tmp_path / "status.json"
    file.write_bytes(b'{"load": 0.25, "links": {"links": []}, "system_id": 3}')
    shore = Shore()
    shore.boats = Boats(shore.port, 250, status_file=file)
    link = stranger(shore)
    link.send(heartbeat(1, armed=True))
    shore.run(0.1)
    assert shore.boats.first == 1
    link.send(heartbeat(3))
    shore.run(0.1)
    assert shore.boats.first == 3
    assert (shore.snapshot(1).load, shore.snapshot(3).load) == (None, 0.25)
