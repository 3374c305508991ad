"""How often the boat asks for each item: of slow stations about once, and on bad lines until it has them."""

import pytest

from companion.mavlink.address import Address
from companion.mavlink.codec import Decoder, Encoder
from companion.mavlink.dialect import Message
from companion.mavlink.items import MissionItem, MissionType
from companion.mavlink.receiver import Receiver
from companion.mavlink.sender import Sender
from companion.mavlink.transfer import Completed, Failed
from sitl.radio.channel import Channel, Quality

BOAT, STATION = Address(1, 1), Address(255, 190)
TICK_S = 0.02


class Upload:
    """A station that answers each request after answer_s, and never by itself."""

    def __init__(self, count: int, answer_s: float, quality: Quality, seed: int = 1) -> None:
        self.requests = 0
        self.now_s = 0.0
        self._boat = Receiver(BOAT, MissionType.MISSION)
        self._station = Sender(STATION, MissionType.MISSION, retries=100)
        self._answer_s = answer_s
        self._up, self._down = Channel(quality, seed), Channel(quality, seed + 1)
        self._waiting: list[tuple[float, Message]] = []
        self._station.offer([MissionItem(3, 16, x=n + 1) for n in range(count)], BOAT, 0.0)

    def run(self) -> Completed | Failed:
        """Until the boat has all, or gives up."""
        to_boat, to_station = Encoder(STATION), Encoder(BOAT)
        boat_hears, station_hears = Decoder(True), Decoder(True)
        while self.now_s < 300.0:
            self._station.tick(self.now_s)
            due_s = self.now_s + self._answer_s
            self._waiting += [(due_s, message) for message in self._station.take_outbox()]
            while self._waiting and self._waiting[0][0] <= self.now_s:
                self._up.send(to_boat.encode(self._waiting.pop(0)[1]), self.now_s)
            for data in self._up.receive(self.now_s):
                for message, sender, _ in boat_hears.feed(data):
                    self._boat.handle(message, sender, self.now_s)
            self._boat.tick(self.now_s)
            for event in self._boat.take_events():
                if isinstance(event, Completed | Failed):
                    return event
            for message in self._boat.take_outbox():
                self.requests += message.get_type() == "MISSION_REQUEST_INT"
                self._down.send(to_station.encode(message), self.now_s)
            for data in self._down.receive(self.now_s):
                for message, sender, _ in station_hears.feed(data):
                    self._station.handle(message, sender, self.now_s)
            self.now_s += TICK_S
        raise AssertionError("it never ends")


@pytest.mark.parametrize(("answer_s", "most"), [(0.0, 30), (0.35, 30), (0.6, 32), (1.2, 38)])
def test_a_slow_station_is_asked_for_each_item_about_once(answer_s: float, most: int) -> None:
    upload = Upload(30, answer_s, Quality())
    assert isinstance(upload.run(), Completed)
    assert 30 <= upload.requests <= most


def test_a_fifth_of_the_messages_lost_at_300_ms_still_ends() -> None:
    uploads = [
        Upload(22, 0.0, Quality(loss=0.2, delay_s=0.15, jitter_s=0.05), seed) for seed in range(0, 16, 2)
    ]
    assert all(isinstance(upload.run(), Completed) for upload in uploads)
    assert sum(upload.requests for upload in uploads) < 1.8 * 22 * len(uploads)
    assert max(upload.now_s for upload in uploads) < 60.0
