"""What the tests of the mission service share: lists, and a station's way to read and to ask."""

from boat_rig import BOAT, HOME_ITEM, Peer, Rig, waypoint

from companion.mavlink.dialect import Message, dialect
from companion.mavlink.items import MissionItem, MissionResult, MissionType
from companion.mavlink.receiver import Receiver
from companion.mavlink.transfer import Completed, Failed

MISSION = [HOME_ITEM, waypoint(40.0, 0.0), waypoint(40.0, 40.0), waypoint(0.0, 40.0)]
OTHER = [HOME_ITEM, waypoint(-30.0, 0.0), waypoint(-30.0, -30.0)]
FENCE = [MissionItem(frame=0, command=5001, param1=3.0, x=500_000_000 + n, y=-12_000_000) for n in range(3)]
RALLY = [MissionItem(frame=3, command=5100, x=500_001_000, y=-12_001_000)]
ACK = "MISSION_ACK"


def download(
    rig: Rig, peer: Peer, mission_type: MissionType = MissionType.MISSION
) -> tuple[MissionItem, ...]:
    """Read a list back as a station does."""
    receiver = Receiver(peer.address, MissionType(mission_type))
    receiver.request_list(BOAT, rig.now_s)
    for _ in range(2000):
        for message in receiver.take_outbox():
            peer.send(message)
        rig.receive()
        for message in peer.listen():
            if message.get_type().startswith("MISSION_"):
                receiver.handle(message, BOAT, rig.now_s)
        for event in receiver.take_events():
            if isinstance(event, Completed):
                receiver.confirm(rig.now_s)
                for message in receiver.take_outbox():
                    peer.send(message)
                rig.receive()
                return event.items
            assert not isinstance(event, Failed)
    raise AssertionError("the download never ended")


def count(items: int, mission_type: int = 0, system: int = 1, component: int = 1) -> Message:
    message: Message = dialect.MAVLink_mission_count_message(system, component, items, mission_type)
    return message


def clear(mission_type: int, system: int = 1) -> Message:
    message: Message = dialect.MAVLink_mission_clear_all_message(system, 1, mission_type)
    return message


def result_of(rig: Rig, message: Message, peer: Peer | None = None) -> MissionResult:
    return MissionResult(rig.answer_to(message, ACK, peer).type)


def loaded(rig: Rig | None = None, items: list[MissionItem] | None = None) -> Rig:
    rig = rig or Rig()
    rig.step()
    assert isinstance(rig.upload(items or MISSION), Completed)
    return rig
