"""From a receiver's bytes down to the bridge: CRSF frames in, recorded mock pins out, in lockstep."""

import dataclasses
from collections.abc import Iterator

import pytest
from fastcrc.crc8 import dvb_s2 as crc8
from hypothesis import given, settings
from hypothesis import strategies as st
from mock_pi import PINS, MockPi

from companion.boat import TICK_S, Boat
from companion.config.boat_config import BoatConfig, Parts
from companion.config.tuning import Rc
from companion.core.storage import MemoryStorage
from companion.hal.port_sensor import ParsedSensor
from companion.links.memory import MemoryPort, memory_pair
from companion.rc.parsers import CrsfParser

CONFIG = BoatConfig(parts=Parts(motors=PINS), rc=Rc(driver="crsf", arm_channel=5, mode_channel=6))
REST, AHEAD, DOWN, UP, MANUAL, HOLD = 1500, 2000, 1000, 2000, 1000, 1300
# Until frames that no longer come do not count, guidance has turned, and the gate has ramped the motors down
SILENCE_TICKS = round((CONFIG.rc.timeout_s + 0.1 + 1.0 / CONFIG.motors.slew_per_s) / TICK_S) + 2


def frame(*pulses_us: int) -> bytes:
    """A CRSF channels frame."""
    ticks = [round((pulse_us - 1500) * 1.6) + 992 for pulse_us in pulses_us] + [992] * (16 - len(pulses_us))
    bits = sum(tick << 11 * number for number, tick in enumerate(ticks))
    body = b"\x16" + bits.to_bytes(22, "little")
    return bytes([0xC8, len(body) + 1]) + body + bytes([crc8(body)])


class RadioBoat:
    """A boat on mock pins that nobody but its transmitter talks to."""

    def __init__(self) -> None:
        self.now_s = 10.0
        self.pi = MockPi()
        near, self.far = memory_pair("uart", is_datagram=False)
        self.receiver = ParsedSensor(MemoryPort(near), lambda: self.now_s, CrsfParser())
        hardware = dataclasses.replace(self.pi.hardware(CONFIG, lambda: self.now_s), rc=self.receiver)
        self.boat = Boat(CONFIG, hardware, [], MemoryStorage())

    def step(self, ticks: int, data: bytes = b"") -> None:
        """Let the receiver say this once a tick."""
        for _ in range(ticks):
            self.now_s += TICK_S
            if data:
                self.far.send(data)
            self.receiver.step()
            self.boat.step(self.now_s)
            assert self.boat.vehicle.armed or self.pi.is_off, "not armed, and yet a pin is on"

    def sail(self) -> None:
        """Arm by the switch and go full ahead."""
        self.step(20, frame(REST, REST, REST, REST, DOWN, MANUAL))
        self.step(20, frame(REST, REST, REST, REST, UP, MANUAL))
        assert self.boat.vehicle.armed
        self.step(30, frame(REST, REST, AHEAD, REST, UP, MANUAL))
        assert self.pi.is_driving

    def close(self) -> None:
        self.boat.close()
        self.pi.factory.reset()


@pytest.fixture
def radio() -> Iterator[RadioBoat]:
    boat = RadioBoat()
    yield boat
    boat.close()


def test_the_motors_are_off_when_the_receiver_falls_silent(radio: RadioBoat) -> None:
    radio.sail()
    radio.step(SILENCE_TICKS)
    assert not radio.pi.is_driving


def test_the_motors_are_off_when_the_receiver_says_that_its_link_is_gone(radio: RadioBoat) -> None:
    radio.sail()
    statistics = b"\x14" + bytes([100, 0, 0, 0, 0, 2, 3, 0, 0, 0])
    gone = bytes([0xC8, len(statistics) + 1]) + statistics + bytes([crc8(statistics)])
    radio.step(SILENCE_TICKS, gone + frame(REST, REST, AHEAD, REST, UP, MANUAL))
    assert not radio.pi.is_driving


def test_the_motors_are_off_a_quarter_of_a_second_after_the_switch_went_down(radio: RadioBoat) -> None:
    radio.sail()
    radio.step(12, frame(REST, REST, AHEAD, REST, DOWN, MANUAL))
    assert radio.pi.is_off


def test_noise_on_the_line_is_silence(radio: RadioBoat) -> None:
    radio.sail()
    radio.step(SILENCE_TICKS, bytes(range(256)))
    assert not radio.pi.is_driving


PULSES = st.sampled_from([900, 1000, 1200, 1470, 1500, 1530, 1800, 2000])
FRAMES = st.builds(frame, PULSES, PULSES, PULSES, PULSES, st.sampled_from([DOWN, REST, UP]), PULSES)


@settings(max_examples=40)
@given(said=st.lists(st.tuples(FRAMES | st.binary(max_size=40), st.integers(1, 15)), max_size=25))
def test_never_are_both_legs_of_a_motor_on_whatever_the_receiver_says(said: list[tuple[bytes, int]]) -> None:
    radio = RadioBoat()
    radio.sail()
    for data, ticks in said:
        radio.step(ticks, data)
    radio.close()
    assert radio.pi.is_off
    assert not radio.pi.both_legs_were_on()
