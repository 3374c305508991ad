"""STATUSTEXT from its chunks."""

from companion.mavlink.dialect import Message, dialect
from mission_tools.station.texts import Text, Texts


def chunk(number: int, text: str, *, of: int = 7) -> Message:
    message: Message = dialect.MAVLink_statustext_message(4, text.encode(), of, number)
    return message


def test_chunks_of_fifty_characters_are_joined_up_to_the_first_shorter_one() -> None:
    texts = Texts(lambda text: True)
    assert texts.ingest(chunk(1, "b" * 49), 1.0, 0.0) == []
    assert texts.ingest(chunk(0, "a" * 50), 1.0, 0.0) == [Text(4, "a" * 50 + "b" * 49)]
    assert texts.ingest(chunk(0, "c" * 49), 1.0, 0.0) == [Text(4, "c" * 49)]
    assert [line.number for line in texts.lines] == [1, 2]


def test_a_text_whose_rest_does_not_come_is_told_after_a_second() -> None:
    texts = Texts(lambda text: True)
    assert texts.ingest(chunk(0, "a" * 50), 1.0, 0.0) == []
    assert texts.poll(1.9, 0.0) == []
    assert texts.poll(2.0, 0.0) == [Text(4, "a" * 50)]
    assert texts.poll(3.0, 0.0) == []
