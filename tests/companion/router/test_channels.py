import pytest
from boat_rig import BOAT, QGC

from companion.links.memory import MemoryLink, MemoryPort, memory_pair
from companion.mavlink.codec import Decoder, Encoder
from companion.mavlink.dialect import Message, dialect
from companion.router.channels import Channels


def beat(number: int = 0) -> Message:
    message: Message = dialect.MAVLink_heartbeat_message(11, 3, 0, number, 4, 3)
    return message


def opened(links: int) -> tuple[Channels, MemoryPort, list[MemoryLink]]:
    port = MemoryPort()
    far: list[MemoryLink] = []
    for number in range(links):
        near, end = memory_pair(f"link {number}")
        port.offer(near)
        far.append(end)
    channels = Channels([port], BOAT)
    assert channels.accept() == list(range(1, links + 1))
    return channels, port, far


def heard(link: MemoryLink) -> list[int]:
    decoder = Decoder(datagram=True)
    return [r.message.custom_mode for chunk in link.receive() for r in decoder.feed(chunk)]


def test_a_message_leaves_by_one_channel_or_by_all() -> None:
    channels, _, far = opened(3)
    channels.send(beat(7), 2)
    channels.send(beat(8), None)
    channels.send(beat(9), 99)
    chunks = [link.receive() for link in far]
    assert [[chunk[4] for chunk in one] for one in chunks] == [[0], [0, 1], [0]], "numbered by channel"
    decoder = Decoder(datagram=True)
    modes = [[r.message.custom_mode for chunk in one for r in decoder.feed(chunk)] for one in chunks]
    assert modes == [[8], [7, 8], [8]]


def test_a_closed_link_is_forgotten_and_its_number_never_used_again() -> None:
    channels, port, far = opened(2)
    far[0].close()
    assert channels.drop_closed() == [1]
    assert channels.drop_closed() == []
    near, _ = memory_pair()
    port.offer(near)
    assert channels.accept() == [3]
    assert sorted(channels.open) == [2, 3]
    near.close()
    assert channels.drop_closed() == [3]
    port.offer(memory_pair()[0])
    assert channels.accept() == [4]


def test_frames_wait_for_a_full_link_and_stale_ones_are_dropped_whole_and_counted() -> None:
    near, far = memory_pair(queue_frames=5)
    port = MemoryPort(near)
    channels = Channels([port], BOAT)
    channels.accept()
    for number in range(8):
        channels.send(beat(number), 1)
    assert heard(far) == [0, 1, 2, 3, 4]
    list(channels.receive(0.5))
    assert heard(far) == [5, 6, 7]
    for number in range(8):
        channels.send(beat(number), 1)
    list(channels.receive(2.0))
    assert channels.open[1].queue.dropped == 3
    assert heard(far) == [0, 1, 2, 3, 4]


@pytest.mark.parametrize("is_datagram", [True, False])
def test_a_channel_decodes_as_its_link_delivers(is_datagram: bool) -> None:
    near, far = memory_pair(is_datagram=is_datagram)
    channels = Channels([MemoryPort(near)], BOAT)
    channels.accept()
    frame = Encoder(QGC).encode(beat(5))
    far.send(frame[:9])
    far.send(frame[9:])
    assert len(list(channels.receive())) == (0 if is_datagram else 1)
