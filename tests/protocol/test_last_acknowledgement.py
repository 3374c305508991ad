"""The last MISSION_ACK on lines that lose it: stations that ask again, and stations that never do."""

import pytest
from boat_rig import BOAT, HOME_ITEM, QGC, waypoint
from mission_station import ACK, count

from companion.mavlink.dialect import Message
from companion.mavlink.items import MissionResult, MissionType
from companion.mavlink.receiver import Receiver
from companion.mavlink.transfer import Completed
from sitl.world.sampling import generator

TICK_S = 0.02
LONG = [HOME_ITEM, *[waypoint(5.0 * n, 0.0) for n in range(1, 30)]]


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
    [(1.5, 0.1, 95), (2.5, 0.2, 90)],
    ids=["QGroundControl-10%", "MAVSDK-20%"],
)
def test_a_station_that_never_asks_again_learns_of_its_success_nearly_always(
    patience_s: float, loss: float, least: int
) -> None:
    ends = [hears_how_it_ends(loss, seed, patience_s) for seed in range(100)]
    assert ends.count(True) >= least
    assert ends.count(False) <= 3  # without repetition it would be 20
