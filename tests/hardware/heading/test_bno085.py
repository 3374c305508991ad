"""A BNO085 on its UART: SHTP frames, set-up, resets, bytes that are lost."""

import math
import random

import pytest
from twins.bno085 import Bno085Twin, Quaternion
from twins.lines import HandClock, known

from companion.config.sensors import CompassPart, Mounting
from companion.core.readings import HeadingReading
from companion.hal.heading.bno085 import BYTE_S, Bno085Compass
from companion.links.memory import MemoryPort, memory_pair
from companion.sensors.sh2 import Packet, Sh2Session, ShtpReader, encode

HALF = math.sqrt(0.5)


class Bench:
    """A compass and its part on a line without threads."""

    def __init__(self, part: CompassPart | None = None, turned: Quaternion = (0.0, 0.0, 0.0, 1.0)) -> None:
        self.clock = HandClock()
        self.twin = Bno085Twin(turned)
        self.pauses: list[float] = []
        near, self.far = memory_pair("uart", is_datagram=False)
        part = part or CompassPart(driver="bno085")
        self.compass = Bno085Compass(MemoryPort(near), part, self.clock, self.pauses.append)

    def run(self, seconds: float, loss: float = 0.0) -> None:
        """loss: share of the part's bytes that do not arrive."""
        dice = random.Random(7)
        for _ in range(round(seconds / 0.02)):
            self.clock.advance(0.02)
            for chunk in self.far.receive():
                assert len(chunk) == 1
                self.twin.hear(chunk)
            said = bytes(byte for byte in self.twin.speak(0.02) if dice.random() >= loss)
            if said:
                self.far.send(said)
            self.compass.step()

    @property
    def reading(self) -> HeadingReading:
        return known(self.compass.read())

    @property
    def angles_deg(self) -> tuple[float, float, float]:
        reading = self.reading
        assert reading.roll_rad is not None
        assert reading.pitch_rad is not None
        return (
            math.degrees(reading.heading_rad) % 360.0,
            math.degrees(reading.roll_rad),
            math.degrees(reading.pitch_rad),
        )


def texts(bench: Bench) -> list[str]:
    return [one.text for one in bench.compass.take_texts()]


@pytest.mark.parametrize(
    ("heading_deg", "roll_deg", "pitch_deg"),
    [(0.0, 0.0, 0.0), (90.0, 10.0, 0.0), (250.0, -5.0, 8.0), (359.0, 0.0, -20.0)],
)
def test_heading_roll_and_pitch_are_those_of_the_boat(
    heading_deg: float, roll_deg: float, pitch_deg: float
) -> None:
    bench = Bench()
    bench.twin.heading_deg, bench.twin.roll_deg, bench.twin.pitch_deg = heading_deg, roll_deg, pitch_deg
    bench.run(1.0)
    assert bench.angles_deg == pytest.approx((heading_deg, roll_deg, pitch_deg), abs=0.1)
    assert bench.reading.is_magnetic
    assert bench.reading.time_s == bench.clock()


@pytest.mark.parametrize(
    ("mounting", "turned"),
    [
        (Mounting(yaw_deg=90), (0.0, 0.0, -HALF, HALF)),  # its arrow to starboard
        (Mounting(roll_deg=180), (1.0, 0.0, 0.0, 0.0)),
    ],
)
def test_a_board_is_mounted_in_any_direction(mounting: Mounting, turned: Quaternion) -> None:
    bench = Bench(CompassPart(driver="bno085", mounting=mounting), turned)
    bench.twin.heading_deg, bench.twin.roll_deg = 120.0, 7.0
    bench.run(1.0)
    assert bench.angles_deg == pytest.approx((120.0, 7.0, 0.0), abs=0.1)


def test_the_features_are_requested_once_and_each_byte_has_its_pause() -> None:
    bench = Bench()
    bench.run(3.0)
    assert bench.twin.requests.count(0x05) <= 2  # at the start, and after the reset that it reports
    assert set(bench.twin.features) == {0x05, 0x02}
    assert bench.twin.features[0x05] == pytest.approx(0.02)
    assert min(bench.pauses) >= 100e-6 == pytest.approx(BYTE_S / 2)
    calibrations = [one for one in bench.twin.commands if one[2] == 0x07]
    assert calibrations[0][3:6] == bytes((1, 1, 1))


def test_room_is_counted_as_the_bytes_are_sent() -> None:
    """A byte 0x7e or 0x7d takes two (data sheet 1000-3927, 1.2.3.1)."""
    payload = bytes((0x7E, 0x7D)) * 8
    session = Sh2Session(0.0)
    session._waiting.clear()
    session._waiting.append((2, payload))
    session.feed(bytes((0x7E, 0x00, 30, 0, 0x7E)), 0.0)
    assert session.take_outbox() == []
    session.feed(bytes((0x7E, 0x00, 39, 0, 0x7E)), 0.0)
    (frame,) = session.take_outbox()
    assert len(frame) == 39


def test_the_calibration_is_saved_once_it_is_good() -> None:
    bench = Bench()
    bench.twin.status = 1
    bench.run(2.0)
    assert bench.twin.saves == 0
    bench.twin.status = 3
    bench.run(3.0)
    assert bench.twin.saves == 1


def test_a_part_whose_supply_dipped_is_set_up_and_must_find_north_again() -> None:
    bench = Bench()
    bench.run(2.0)
    before = bench.reading
    bench.twin.power_up()
    bench.twin.status, bench.twin.heading_deg = 0, 77.0
    bench.run(1.0)
    assert bench.twin.features
    assert bench.reading.time_s - before.time_s < 0.1
    assert texts(bench) == ["Compass: BNO085 was reset: it must find north again"]
    bench.twin.status = 2
    bench.run(0.2)
    assert bench.angles_deg[0] == pytest.approx(77.0, abs=0.1)


def test_a_part_that_hangs_is_reset() -> None:
    bench = Bench()
    bench.run(1.0)
    bench.twin.features.clear()
    bench.twin.is_hung = True
    bench.run(3.5)
    assert bench.clock() - bench.reading.time_s > 3.0
    assert texts(bench) == ["Compass: BNO085 is silent"]
    bench.run(4.0)
    assert not bench.twin.is_hung
    assert bench.reading.time_s == bench.clock()


def test_lost_bytes_cost_samples_and_never_give_a_wrong_one() -> None:
    bench = Bench()
    bench.twin.heading_deg = 200.0
    for _ in range(50):
        bench.run(0.2, loss=0.01)
        if bench.compass.read() is not None:
            assert bench.angles_deg == pytest.approx((200.0, 0.0, 0.0), abs=0.1)
    assert bench.compass._session._reader.dropped > 0
    assert bench.clock() - bench.reading.time_s < 0.5


def test_frames_escape_the_flag_and_two_flags_in_a_row_are_one() -> None:
    payload = bytes(range(0x70, 0x80))
    frame = encode(2, 0x7E, payload)
    assert frame.count(0x7E) == 2
    assert ShtpReader().feed(b"\x7e" + frame + frame[1:]) == [Packet(2, payload)] * 2
    cut_off = frame[:3] + b"\x7d"
    assert ShtpReader().feed(cut_off + frame) == [Packet(2, payload)]
