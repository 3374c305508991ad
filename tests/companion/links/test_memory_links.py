"""The pair of links that never leaves the process."""

from companion.links.memory import MemoryPort, memory_pair


def test_a_full_end_drops_what_comes_next_whole() -> None:
    near, far = memory_pair(queue_frames=2)
    assert [near.send(data) for data in (b"1", b"2", b"3")] == [True, True, False]
    assert far.receive() == [b"1", b"2"]
    assert near.send(b"4")
    near, _ = memory_pair()
    assert [near.send(b"frame") for _ in range(4097)] == [True] * 4096 + [False]


def test_closing_one_end_ends_the_other_after_its_last_words() -> None:
    near, far = memory_pair()
    near.send(b"last words")
    near.close()
    near.close()
    assert near.is_closed
    assert not far.is_closed
    assert not far.send(b"anyone?")
    assert far.receive() == [b"last words"]
    assert far.is_closed


def test_a_port_hands_every_offered_link_out_once_and_closes_them_all() -> None:
    near, far = memory_pair()
    port = MemoryPort(near)
    assert (port.name, port.fileno(), near.fileno()) == ("memory", -1, -1)
    assert port.accept() == [near]
    assert port.accept() == []
    port.offer(far)
    port.close()
    assert near.is_closed
    assert far.is_closed
