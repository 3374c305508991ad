"""What a real ground station sent, as recorded, decodes without a flaw."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from data_files import RECORDINGS

from companion.mavlink.codec import Decoder
from companion.mavlink.framing import claimed_length

STATION = 255


def frames_of(log: bytes) -> Iterator[bytes]:
    """The frames of a telemetry log: eight bytes of time, then a frame, and so on."""
    at = 0
    while at + 8 < len(log):
        at += 8
        length = claimed_length(log, at)
        yield log[at : at + length]
        at += length


def names_in_text(recording: Path) -> list[str]:
    """The messages of the station, as the recording's text tells them."""
    lines = recording.with_suffix(".txt").read_text(encoding="utf-8").splitlines()
    return [line.split()[4] for line in lines if line.split()[1] == "Q->V"]


@pytest.mark.parametrize("recording", RECORDINGS, ids=lambda path: path.stem)
@pytest.mark.parametrize("datagram", [True, False], ids=["datagrams", "stream"])
def test_all_that_the_station_sent_is_understood(recording: Path, datagram: bool) -> None:
    decoder = Decoder(datagram)
    sent = [
        frame for frame in frames_of(recording.read_bytes()) if frame[5 if frame[0] == 0xFD else 3] == STATION
    ]
    received = [r for frame in sent for r in decoder.feed(frame)]
    assert [r.frame for r in received] == sent
    assert [r.message.get_type() for r in received] == names_in_text(recording)
    counters = decoder.counters
    assert (counters.bad_frames, counters.bad_crc, counters.unknown) == (0, 0, 0)
