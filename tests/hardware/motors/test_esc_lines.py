"""Speed controllers that report: KISS's frames and VESCs, over lines in memory, with their faults."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from twins.escs import VescTwin, kiss_frame, vesc_frame
from twins.lines import HandClock, MemoryLine, known

from companion.config.actuators import MotorsPart
from companion.core.errors import HardwareError, SilentOutputsError
from companion.core.readings import BatteryReading, EscReading
from companion.hal.motors.esc_line import EscBattery, EscLine
from companion.hal.motors.vesc import Vesc, VescMotors
from companion.hal.motors.watched_motors import WatchedMotors
from companion.sensors.esc_frames import KissParser, VescParser

KISS = MotorsPart(driver="esc", telemetry="kiss", pole_pairs=7)
VESC = MotorsPart(driver="vesc", pole_pairs=5)
BY_CAN = MotorsPart(driver="vesc", pole_pairs=5, can_id=11)
FRAME = kiss_frame(31, 1542, 873, 210, 143)


@pytest.fixture
def clock() -> HandClock:
    return HandClock()


@pytest.fixture
def wire() -> MemoryLine:
    return MemoryLine()


def heard(line: EscLine, wire: MemoryLine, *chunks: bytes) -> tuple[EscReading, ...] | None:
    for chunk in chunks:
        wire.say(chunk)
    line.step()
    return line.read()


def asked(line: EscLine, wire: MemoryLine, vesc: VescTwin) -> tuple[EscReading, ...]:
    """A question, and the reading of its answer."""
    line.step()
    wire.say(vesc.hear(wire.heard()))
    line.step()
    return known(line.read())


# KISS


def test_a_frame_of_am32_is_read_in_its_units(wire: MemoryLine, clock: HandClock) -> None:
    (reading,) = known(heard(EscLine(wire.port, clock, KISS, 1), wire, FRAME))
    assert (reading.side, reading.time_s, reading.count) == (1, clock(), 1)
    assert reading.voltage_v == pytest.approx(15.42)
    assert reading.current_a == pytest.approx(8.73)
    assert (reading.temperature_c, reading.consumed_mah) == (31, 210)
    assert reading.shaft_rad_s == pytest.approx(14300.0 / 7.0 / 60.0 * math.tau)


def test_a_cold_controller_is_below_zero(wire: MemoryLine, clock: HandClock) -> None:
    (reading,) = known(heard(EscLine(wire.port, clock, KISS, 0), wire, kiss_frame(-7, 1542, 0, 0, 0)))
    assert reading.temperature_c == -7


def test_zeros_of_a_broken_line_are_no_frame(wire: MemoryLine, clock: HandClock) -> None:
    assert heard(EscLine(wire.port, clock, KISS, 0), wire, bytes(100)) is None


def test_a_pause_ends_a_broken_frame(wire: MemoryLine, clock: HandClock) -> None:
    line = EscLine(wire.port, clock, KISS, 0)
    heard(line, wire, FRAME[:4])
    clock.advance(0.03)
    (reading,) = known(heard(line, wire, FRAME))
    assert isinstance(line.parser, KissParser)
    assert (reading.count, line.parser.skipped) == (1, 0)


@given(noise=st.binary(max_size=60), cut=st.integers(1, 9))
def test_kiss_resynchronises_after_anything(noise: bytes, cut: int) -> None:
    reader = KissParser(0, 7)
    for chunk in (noise[:cut], noise[cut:], FRAME[:cut], FRAME[cut:]):
        reader.split(chunk)
    # A right CRC among the noise by chance (1 in 256) may swallow the beginning of the first frame, no more
    assert FRAME in [frame for _ in range(2) for frame in reader.split(FRAME)]


@given(bit=st.integers(0, 79))
def test_no_single_wrong_bit_passes(bit: int) -> None:
    wrong = bytearray(FRAME)
    wrong[bit // 8] ^= 1 << bit % 8
    assert KissParser(0, 7).split(bytes(wrong)) == []


def test_a_controller_that_is_plugged_in_again_is_read(wire: MemoryLine, clock: HandClock) -> None:
    line = EscLine(wire.port, clock, KISS, 0)
    heard(line, wire, FRAME, FRAME[:5])
    wire.far.close()
    line.step()
    wire.plug_in()
    (reading,) = known(heard(line, wire, FRAME))
    assert reading.count == 2


# VESC


def test_an_answer_of_a_vesc_is_read_in_its_units(wire: MemoryLine, clock: HandClock) -> None:
    (reading,) = asked(EscLine(wire.port, clock, VESC, 0), wire, VescTwin(clock))
    assert (reading.side, reading.fault) == (0, "")
    assert reading.voltage_v == pytest.approx(15.2)
    assert reading.current_a == pytest.approx(3.21)
    assert reading.temperature_c == pytest.approx(41.5)
    assert reading.motor_c == pytest.approx(38.2)
    assert reading.consumed_mah == pytest.approx(456.7)
    assert reading.shaft_rad_s == pytest.approx(12340.0 / 5.0 / 60.0 * math.tau)


def test_two_vescs_on_one_line_are_told_apart_by_their_number(wire: MemoryLine, clock: HandClock) -> None:
    twin = VescTwin(clock, 10, VescTwin(clock, 11))
    assert twin.behind is not None
    twin.behind.erpm, twin.behind.fault = -999, 4
    readings = {one.side: one for one in asked(EscLine(wire.port, clock, BY_CAN, 0), wire, twin)}
    assert readings[0].shaft_rad_s > 0.0 > readings[1].shaft_rad_s
    assert (readings[0].fault, readings[1].fault) == ("", "overcurrent")


def test_faults_without_a_name_and_motors_without_a_thermistor(wire: MemoryLine, clock: HandClock) -> None:
    twin = VescTwin(clock)
    twin.fault, twin.motor_c = 17, -65.0
    (reading,) = asked(EscLine(wire.port, clock, VESC, 0), wire, twin)
    assert (reading.fault, reading.motor_c) == ("fault 17", None)


@given(noise=st.binary(max_size=300), cut=st.integers(1, 70))
def test_vesc_resynchronises_after_anything(noise: bytes, cut: int) -> None:
    parser, frame = VescParser(0, 5), vesc_frame(VescTwin(HandClock()).values())
    # A length of up to 255 in the noise may wait for so many bytes
    found = [parser.feed(chunk, 0.0) for chunk in (noise, frame[:cut], frame[cut:], *[frame] * 5)]
    assert known(found[-1])[0].voltage_v == pytest.approx(15.2)


@pytest.mark.parametrize("payload", [b"\x04", b"\x04" + bytes(57), b"\x00\x06\x02", bytes(300)])
def test_other_and_short_answers_are_no_readings(wire: MemoryLine, clock: HandClock, payload: bytes) -> None:
    assert heard(EscLine(wire.port, clock, VESC, 0), wire, vesc_frame(payload)) is None


# Driving VESCs


class Pair:
    """Two VESCs behind one line, driven."""

    def __init__(self, part: MotorsPart = BY_CAN) -> None:
        self.clock, self.wire = HandClock(), MemoryLine()
        self.right = VescTwin(self.clock, 11)
        self.left = VescTwin(self.clock, 10, self.right)
        self.line = EscLine(self.wire.port, self.clock, part, 0)
        self.line.step()
        signs = [-1 if turned else 1 for turned in (part.left_reversed, part.right_reversed)]
        ids = -1, part.can_id
        left, right = (Vesc(self.line, *one, self.clock) for one in zip(ids, signs, strict=True))
        self.motors = VescMotors((left, right), self.clock)

    def duties(self) -> tuple[float, float]:
        self.left.hear(self.wire.heard())
        self.left.tick()
        return self.left.duty, self.right.duty

    def pass_by(self, seconds: float) -> tuple[float, float]:
        """The boat asks for values and commands nothing."""
        for _ in range(round(seconds / 0.05)):
            self.clock.advance(0.05)
            self.line.step()
            self.duties()
        return self.duties()


def test_commands_reach_both_sides() -> None:
    pair = Pair()
    pair.motors.write(0.5, -0.25)
    assert pair.duties() == (0.5, -0.25)
    pair.motors.write(7.0, -7.0)
    assert pair.duties() == (1.0, -1.0)
    assert pair.left.refused == 0


def test_a_reversed_side_turns_the_other_way() -> None:
    pair = Pair(MotorsPart(driver="vesc", can_id=11, right_reversed=True))
    pair.motors.write(0.5, 0.5)
    assert pair.duties() == (0.5, -0.5)


@pytest.mark.parametrize("value", [math.nan, math.inf])
def test_values_that_are_not_finite_stop_both(value: float) -> None:
    pair = Pair()
    pair.motors.write(0.5, 0.5)
    pair.motors.write(0.5, value)
    assert pair.duties() == (0.0, 0.0)


def test_stop_and_close_let_both_coast() -> None:
    for end in ("stop", "close"):
        pair = Pair()
        pair.motors.write(0.5, 0.5)
        getattr(pair.motors, end)()
        pair.left.hear(pair.wire.heard())
        assert (pair.left.duty, pair.right.duty) == (0.0, 0.0), end
    pair.motors.close()
    with pytest.raises(HardwareError, match="after close"):
        pair.motors.write(0.5, 0.5)


def test_questions_keep_no_motor_running() -> None:
    """A killed loop whose thread still asks: the VESC stops by itself."""
    pair = Pair()
    pair.motors.write(0.5, 0.5)
    assert pair.pass_by(0.9) == (0.5, 0.5)
    assert pair.pass_by(0.2) == (0.0, 0.0)


def test_the_watch_stops_them_before_that() -> None:
    pair = Pair()
    watched = WatchedMotors(pair.motors, pair.clock, 0.5)
    watched.write(0.5, 0.5)
    assert pair.pass_by(0.6) == (0.5, 0.5)
    watched.watch()
    assert pair.duties() == (0.0, 0.0)
    assert watched.trips == 1


def test_an_unplugged_line_is_told_and_its_motors_are_off_a_second_later() -> None:
    pair = Pair()
    pair.clock.advance(5.0)
    pair.motors.write(0.5, 0.5)
    pair.wire.far.close()
    pair.line.step()
    with pytest.raises(SilentOutputsError) as at_first:
        pair.motors.write(0.5, 0.5)
    pair.clock.advance(1.01)
    with pytest.raises(SilentOutputsError) as later:
        pair.motors.stop()
    assert (at_first.value.are_off, later.value.are_off) == (False, True)
    pair.wire.plug_in()
    pair.line.step()
    pair.motors.write(0.3, 0.3)
    assert pair.duties() == (0.3, 0.3)


def test_the_other_line_stops_when_one_is_unplugged() -> None:
    clock, wires = HandClock(), (MemoryLine(), MemoryLine())
    lines = [EscLine(wire.port, clock, VESC, side) for side, wire in enumerate(wires)]
    for line in lines:
        line.step()
    motors = VescMotors((Vesc(lines[0], -1, 1, clock), Vesc(lines[1], -1, 1, clock)), clock)
    left = VescTwin(clock)
    motors.write(0.5, 0.5)
    wires[1].far.close()
    lines[1].step()
    with pytest.raises(SilentOutputsError):
        motors.write(0.5, 0.5)
    left.hear(wires[0].heard())
    assert left.duty == 0.0
    motors.close()  # raises nothing: the boat closes its other parts next
    assert not lines[0].send(b"")


# As a battery monitor


def test_the_pack_is_as_old_as_the_older_report(clock: HandClock) -> None:
    wires = MemoryLine(), MemoryLine()
    lines = [EscLine(wire.port, clock, KISS, side) for side, wire in enumerate(wires)]
    battery = EscBattery(lines, 2)
    heard(lines[0], wires[0], kiss_frame(30, 1500, 400, 0, 0))
    assert battery.read() is None
    clock.advance(1.0)
    heard(lines[1], wires[1], kiss_frame(30, 1480, 300, 0, 0))
    reading = known(battery.read())
    assert reading.time_s == clock() - 1.0
    assert reading.voltage_v == pytest.approx(14.9)
    assert reading.current_a == pytest.approx(7.0)
    heard(lines[1], wires[1], kiss_frame(30, 1480, 300, 0, 0))
    assert battery.read() is reading
    assert isinstance(reading, BatteryReading)
    battery.close()
