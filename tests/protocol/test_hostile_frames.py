"""100,000 random and mutated frames change nothing but counters."""

import json
import random
from collections.abc import Iterator
from pathlib import Path

import pytest

from companion.mavlink.address import Address
from companion.mavlink.codec import Counters, Decoder, Encoder
from companion.mavlink.dialect import Message, dialect
from companion.mavlink.framing import LONGEST_FRAME
from companion.mavlink.items import MissionType
from companion.mavlink.receiver import Receiver
from companion.mavlink.sender import Sender

TABLE = json.loads((Path(__file__).parents[1] / "vectors" / "frames.json").read_text(encoding="utf-8"))
SEEDS = [bytes.fromhex(row["hex"]) for row in TABLE]
FRAMES = 100_000


def mutated(rng: random.Random, count: int) -> Iterator[bytes]:
    """Frames of the table with bits flipped, bytes put in, cut out or cut off, joined, or noise instead."""
    for _ in range(count):
        frame = bytearray(rng.choice(SEEDS))
        for _ in range(rng.randint(1, 4)):
            at = rng.randrange(len(frame))
            match rng.randrange(8):
                case 0 | 1 | 2:
                    frame[at] ^= 1 << rng.randrange(8)
                case 3:
                    frame[at] = rng.choice((0x00, 0xFD, 0xFE, 0xFF))
                case 4:
                    frame[at:at] = rng.randbytes(rng.randint(1, 4))
                case 5 if len(frame) > 1:
                    del frame[at]
                case 6 if at:
                    del frame[at:]
                case _:
                    frame += rng.choice(SEEDS)
        yield rng.randbytes(rng.randint(1, 300)) if rng.random() < 0.1 else bytes(frame)


def vouched_for(frame: bytes) -> Message:
    """pymavlink's own opinion of a frame; it raises where the CRC does not fit."""
    message: Message = dialect.MAVLink(None).decode(bytearray(frame))
    return message


@pytest.mark.parametrize("seed", [1, 2])
@pytest.mark.parametrize("datagram", [True, False], ids=["datagrams", "stream"])
def test_hostile_frames_change_nothing_but_counters(datagram: bool, seed: int) -> None:
    rng = random.Random(seed)
    counters = Counters()
    decoder = Decoder(datagram, counters)
    machines = [
        machine
        for mission_type in MissionType
        for machine in (
            Receiver(Address(1, 1), mission_type),
            Sender(Address(1, 1), mission_type, source=lambda: ()),
        )
    ]
    fed = believed = 0
    for n, frame in enumerate(mutated(rng, FRAMES // 2)):
        fed += len(frame)
        for message, sender, data in decoder.feed(frame):
            believed += 1
            if believed % 16 == 0:
                assert repr(vouched_for(data).to_dict()) == repr(message.to_dict())
            for machine in machines:
                machine.handle(message, sender, n * 0.02)
                machine.tick(n * 0.02)
                machine.take_outbox()
                machine.take_events()
    assert counters.bytes_in == fed
    assert counters.frames_in == believed
    assert counters.bad_crc > 1000
    assert counters.unknown > 100
    assert counters.bad_frames > counters.bad_crc

    decoder.feed(bytes(LONGEST_FRAME))  # ends whatever seemed to have begun
    encoder = Encoder(Address(9, 9))
    heartbeats = [encoder.encode(dialect.MAVLink_heartbeat_message(11, 3, 0, n, 4, 3)) for n in range(40)]
    received = [r.message.custom_mode for frame in heartbeats for r in decoder.feed(frame)]
    assert received == list(range(40))


def test_a_stream_of_begun_frames_never_fills_the_memory() -> None:
    decoder = Decoder(datagram=False)
    header = bytes.fromhex("fdff0000000101000000")  # a HEARTBEAT that claims 255 bytes
    for _ in range(2000):
        decoder.feed(header)
        assert len(decoder._finder._rest) < LONGEST_FRAME
    assert decoder.counters.bad_crc > 0
