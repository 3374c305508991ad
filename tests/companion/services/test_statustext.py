import logging

import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.core.status_text import Severity, StatusText
from companion.mavlink.dialect import Message
from companion.services.outbox import Outbox
from companion.services.statustext import StatusTextService


def told(*texts: str) -> list[Message]:
    outbox = Outbox()
    StatusTextService(outbox).send([StatusText(Severity.WARNING, text) for text in texts])
    taken = outbox.drain()
    assert all(one.channel is None for one in taken)
    return [one.message for one in taken]


@given(st.text(alphabet=st.characters(min_codepoint=32, max_codepoint=126), min_size=51, max_size=400))
def test_a_long_line_is_whole_again_when_its_chunks_are_joined(text: str) -> None:
    chunks = told(text)
    assert "".join(chunk.text for chunk in chunks) == text
    assert [chunk.chunk_seq for chunk in chunks] == list(range(len(chunks)))
    assert len({chunk.id for chunk in chunks}) == 1
    assert chunks[0].id != 0
    assert len(chunks[-1].text) < 50  # only a zero byte tells a station that the line is over


def test_what_is_not_ascii_is_replaced_not_raised() -> None:
    (message,) = told("Kurs 90° → Süd")
    assert message.text == "Kurs 90? ? S?d"


@pytest.mark.parametrize("severity", [Severity.WARNING, Severity.ERROR])
def test_a_flood_of_lines_is_held_back_and_leaves_room_for_what_is_severe(severity: int) -> None:
    outbox = Outbox()
    texts = StatusTextService(outbox)
    texts.send([StatusText(severity, "refused")] * 1000)
    assert len(outbox.drain()) == 20
    texts.send([StatusText(Severity.CRITICAL, "Failsafe: battery low")])
    assert len(outbox.drain()) == 1
    assert texts.dropped == 980
    for _ in range(50):
        texts.tick(0.02)
        texts.send([StatusText(severity, "refused")] * 10)
    assert len(outbox.drain()) == pytest.approx(9, abs=1)  # of those, one makes up for the severe one


@pytest.mark.parametrize(
    ("severity", "level"),
    [
        (Severity.CRITICAL, logging.ERROR),
        (Severity.ERROR, logging.ERROR),
        (Severity.WARNING, logging.WARNING),
        (Severity.NOTICE, logging.INFO),
        (Severity.INFO, logging.INFO),
    ],
)
def test_a_journal_has_what_is_told_with_its_severity(
    caplog: pytest.LogCaptureFixture, severity: int, level: int
) -> None:
    caplog.set_level(logging.INFO)
    texts = StatusTextService(Outbox())
    texts.send([StatusText(severity, "not yet")])
    texts.logs_texts = True
    texts.send([StatusText(severity, "Failsafe: a\nlong\x1b[2J line" + "x" * 60)])
    texts.send_to(3, StatusText(severity, "Helm: 255/190 has it"))
    assert [(record.levelno, record.getMessage()) for record in caplog.records] == [
        (level, "Failsafe: a long [2J line" + "x" * 60),
        (level, "Helm: 255/190 has it"),
    ]
