"""MISSION_CURRENT's identities of the lists, by which a station notices what another one has uploaded."""

from boat_rig import HOME_ITEM, PLANNER, Rig, waypoint
from pymavlink.dialects.v20 import ardupilotmega as older

from companion.mavlink.items import MissionType
from companion.mavlink.metadata_messages import MissionCurrent

ITEMS = {
    MissionType.MISSION: [HOME_ITEM, waypoint(20.0, 0.0)],
    MissionType.FENCE: [waypoint(0.0, 0.0, command=5003, param1=50.0)],
    MissionType.RALLY: [waypoint(5.0, 5.0, command=5100)],
}


def ids(rig: Rig) -> tuple[int, int, int]:
    rig.peer.forget()
    rig.run(1.0)
    said = rig.peer.said("MISSION_CURRENT")[-1]
    return said.mission_id, said.fence_id, said.rally_points_id


def test_each_upload_by_another_station_changes_the_identity_of_its_list_alone() -> None:
    rig = Rig().ready()
    other = rig.connect(PLANNER)
    before = ids(rig)
    assert before == (0, 0, 0)
    for kind in MissionType:
        rig.upload(ITEMS[kind], other, kind)
        now = ids(rig)
        assert [number for number in range(3) if now[number] != before[number]] == [kind]
        before = now
    for kind in MissionType:
        rig.upload([], other, kind)
    assert ids(rig) == (0, 0, 0)


def test_a_reader_of_the_older_definition_reads_the_rest() -> None:
    assert "mission_id" not in older.MAVLink_mission_current_message.fieldnames
    frame = MissionCurrent(3, 9, 4, 1, 7, 8, 9).pack(older.MAVLink(None, 1, 1))
    (message,) = older.MAVLink(None).parse_buffer(frame)
    assert (message.seq, message.total, message.mission_state, message.mission_mode) == (3, 9, 4, 1)
