"""The last MISSION_ACK on lines that lose it: stations that ask again, and stations that never do."""

from collections.abc import Callable

import pytest
from boat_rig import BOAT, HOME_ITEM, PLANNER, QGC, Peer, Rig, waypoint
from mission_station import ACK, FENCE, MISSION, count, loaded

from companion.mavlink.address import Address
from companion.mavlink.dialect import Message, dialect
from companion.mavlink.items import MissionItem, MissionResult, MissionType
from companion.mavlink.receiver import Receiver
from companion.mavlink.sender import Sender
from companion.mavlink.transfer import Completed
from sitl.world.sensors.sampling import generator

TICK_S = 0.02
LONG = [HOME_ITEM, *[waypoint(5.0 * n, 0.0) for n in range(1, 30)]]
NEW = [HOME_ITEM, *[waypoint(10.0 * n, 0.0) for n in range(1, 6)]]


class SilentStation:
    """Answers requests and says nothing twice, as MAVSDK and QGroundControl at the end of an upload."""

    def __init__(self, patience_s: float) -> None:
        self.result: int | None = None
        self._patience_s = patience_s
        self._heard_s = 0.0

    def is_waiting(self, now_s: float) -> bool:
        return self.result is None and now_s - self._heard_s < self._patience_s

    def answer(self, message: Message, now_s: float) -> Message | None:
        self._heard_s = now_s
        if message.get_type() == ACK:
            self.result = message.type
            return None
        item: Message = LONG[message.seq].to_message(message.seq, BOAT, MissionType.MISSION)
        return item


def hears_how_it_ends(loss: float, seed: int, patience_s: float) -> bool | None:
    """Upload over a line that loses this share each way; None if not all items came."""
    numbers = generator(seed, "test/last-word")
    boat, station = Receiver(BOAT, MissionType.MISSION), SilentStation(patience_s)
    now_s, is_whole = 0.0, False
    boat.handle(count(len(LONG)), QGC, now_s)
    while station.is_waiting(now_s):
        now_s += TICK_S
        boat.tick(now_s)
        if any(isinstance(event, Completed) for event in boat.take_events()):
            is_whole = True
            boat.confirm(now_s)
        for message in boat.take_outbox():
            if numbers.random() < loss:
                continue
            said = station.answer(message, now_s)
            if said is not None and numbers.random() >= loss:
                boat.handle(said, QGC, now_s)
    assert station.result in (None, MissionResult.ACCEPTED)
    return station.result is not None if is_whole else None


@pytest.mark.parametrize(
    ("patience_s", "loss", "least"),
    [(1.5, 0.1, 290), (1.5, 0.2, 250), (2.5, 0.2, 280)],
    ids=["QGroundControl-10%", "QGroundControl-20%", "MAVSDK-20%"],
)
def test_a_station_that_never_asks_again_learns_of_its_success_nearly_always(
    patience_s: float, loss: float, least: int
) -> None:
    ends = [hears_how_it_ends(loss, seed, patience_s) for seed in range(300)]
    assert ends.count(True) >= least
    assert ends.count(False) <= 6  # 0.8 % of them; without repetition it would be 60


class Line:
    """A station's link that loses what a test says, one way."""

    def __init__(self, rig: Rig, peer: Peer, loses: Callable[[Message], bool]) -> None:
        self.rig, self.peer, self._loses = rig, peer, loses

    def run(self, sender: Sender, for_s: float) -> list[object]:
        """Upload over it; the events of the station's side."""
        events: list[object] = []
        for _ in range(round(for_s / TICK_S)):
            for message in sender.take_outbox():
                self.peer.send(message)
            self.rig.step()
            for message in self.peer.listen():
                if message.get_type().startswith("MISSION_") and not self._loses(message):
                    sender.handle(message, BOAT, self.rig.now_s)
            sender.tick(self.rig.now_s)
            events += sender.take_events()
        return events


def offering(peer: Peer, now_s: float) -> Sender:
    sender = Sender(peer.address, MissionType.MISSION)
    sender.offer(NEW, BOAT, now_s)
    return sender


@pytest.mark.parametrize("lost", [1, 3, 5])
def test_our_own_station_asks_until_it_hears_the_boat_s_last_word(lost: int) -> None:
    rig = loaded()
    left = [lost]

    def loses(message: Message) -> bool:
        if message.get_type() != ACK or not left[0]:
            return False
        left[0] -= 1
        return True

    events = Line(rig, rig.peer, loses).run(offering(rig.peer, rig.now_s), 6.0)
    assert isinstance(events[-1], Completed)
    assert rig.items() == tuple(NEW)


def test_the_boat_s_last_word_does_not_go_on_for_ever() -> None:
    rig = loaded()
    rig.peer.forget()
    events = Line(rig, rig.peer, lambda m: m.get_type() == ACK).run(offering(rig.peer, rig.now_s), 30.0)
    assert not any(isinstance(event, Completed) for event in events)
    assert 4 <= len(rig.peer.said(ACK)) <= 16


def upload_with_a_loss(rig: Rig, peer: Peer) -> None:
    """An upload in which the boat has to ask for an item twice."""
    left = [1]

    def loses(message: Message) -> bool:
        left[0] -= message.get_type() == "MISSION_REQUEST_INT"
        return left[0] == 0 and message.get_type() == "MISSION_REQUEST_INT"

    sender = offering(peer, rig.now_s)
    line = Line(rig, peer, loses)
    while not any(isinstance(event, Completed) for event in line.run(sender, TICK_S)):
        assert rig.now_s < 60.0


def test_the_last_word_goes_to_its_station_alone() -> None:
    rig = loaded()
    other = rig.connect(PLANNER)
    rig.step()
    other.forget()
    rig.peer.forget()
    upload_with_a_loss(rig, rig.peer)
    rig.run(2.0)
    assert {(m.target_system, m.target_component) for m in rig.peer.said(ACK)} == {tuple(QGC)}
    assert len(rig.peer.said(ACK)) == 3
    assert not other.said(ACK)


def test_a_station_that_goes_on_with_its_fence_is_not_told_of_its_mission_again() -> None:
    rig = loaded()
    upload_with_a_loss(rig, rig.peer)
    assert isinstance(rig.upload(FENCE, rig.peer, MissionType.FENCE), Completed)
    rig.peer.forget()
    rig.run(2.0)
    assert not rig.peer.said(ACK)


def test_a_download_whose_last_word_is_lost_holds_up_nobody() -> None:
    rig = loaded()
    station = Receiver(rig.peer.address, MissionType.MISSION)
    station.request_list(BOAT, rig.now_s)
    held: tuple[MissionItem, ...] = ()
    for _ in range(100):
        for message in station.take_outbox():
            if message.get_type() != ACK:  # which is lost
                rig.peer.send(message)
        rig.step()
        for message in rig.peer.listen():
            if message.get_type().startswith("MISSION_"):
                station.handle(message, BOAT, rig.now_s)
        for event in station.take_events():
            if isinstance(event, Completed):
                held = event.items
                station.confirm(rig.now_s)
    assert held == tuple(MISSION)
    assert isinstance(rig.upload(NEW, rig.connect(Address(254, 190))), Completed)
    asked = dialect.MAVLink_mission_request_list_message(*BOAT, 0)
    assert rig.answer_to(asked, "MISSION_COUNT").count == len(NEW)
