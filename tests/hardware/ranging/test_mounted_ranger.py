"""The sonar over a trigger pin that answers with an echo of a set length."""

import itertools
import math
import threading
from collections.abc import Callable, Iterator
from typing import Any

import pytest
from gpiozero import GPIODevice, InputDevice
from gpiozero.pins.mock import MockFactory, MockPWMPin
from hypothesis import given
from hypothesis import strategies as st
from twins.lines import HandClock, eventually
from twins.pulses import LgpioTwin

from companion.config.sensors import RangerPart
from companion.core.errors import HardwareError
from companion.core.readings import SonarReading
from companion.hal.ranging.echo_pins import JSNSR04T, EchoPinRanger, speed_of_sound_m_s
from companion.hal.ranging.mounted_ranger import MountedRanger, open_ranger, sweep_bearings_rad

PART = RangerPart(driver="hcsr04")
SOUND_M_S = speed_of_sound_m_s(15.0)


class EchoPin(MockPWMPin):  # type: ignore[misc]
    """The echo line: its edges bear the time stamps that the twin gives them."""

    def edge(self, ticks_s: float, level: bool) -> None:
        self._last_change = ticks_s
        self._state = level
        if self._when_changed is not None:
            self._call_when_changed()


class SonarTwin(MockPWMPin):  # type: ignore[misc]
    """The trigger line: a whole pulse on it makes the part answer at once, on a time scale of its own."""

    echo: EchoPin
    echo_s: float | None = 0.01
    hangs = False
    pulses = 0
    clock_s = 0.0
    on_pulse: Callable[[], None] = staticmethod(lambda: None)

    def _change_state(self, value: float) -> bool:
        has_fallen = bool(self._state) and not value
        has_changed: bool = super()._change_state(value)
        if has_fallen:
            self.pulses += 1
            self.on_pulse()
            if self.echo_s is not None:
                self.clock_s += 1.0
                self.echo.edge(self.clock_s, True)
                if not self.hangs:
                    self.echo.edge(self.clock_s + self.echo_s, False)
        return has_changed


class Bench:
    """A Pi with the twin on it."""

    def __init__(self) -> None:
        self.factory = MockFactory(pin_class=MockPWMPin)
        self.factory.ticks_diff = lambda later, earlier: later - earlier
        self.echo: Any = self.factory.pin(PART.echo, pin_class=EchoPin)
        self.twin: Any = self.factory.pin(PART.trigger, pin_class=SonarTwin)
        self.twin.echo = self.echo

    def ranger(self, max_range_m: float = 4.0) -> EchoPinRanger:
        trigger = GPIODevice(PART.trigger, pin_factory=self.factory)
        echo = InputDevice(PART.echo, pin_factory=self.factory)
        return EchoPinRanger(trigger, echo, self.factory.ticks_diff, max_range_m, 15.0)


@pytest.fixture
def bench() -> Iterator[Bench]:
    bench = Bench()
    yield bench
    bench.factory.reset()


def test_range_is_half_the_way_of_the_sound(bench: Bench) -> None:
    ranger = bench.ranger()
    bench.twin.echo_s = 2.0 * 1.5 / SOUND_M_S
    assert ranger.ping_m() == pytest.approx(1.5)
    bench.twin.echo_s = 2.0 * 0.02 / SOUND_M_S
    assert ranger.ping_m() == pytest.approx(0.02)
    assert bench.twin.pulses == 2
    assert [state.state for state in bench.twin.states] == [0.0, 1.0, 0.0, 1.0, 0.0]


def test_a_single_jump_is_dropped_in_one_direction_only(bench: Bench) -> None:
    ranger, ranges_m = bench.ranger(), list[float | None]()
    for range_m in (2.0, 2.02, 0.3, 2.04, 2.06, 1.0, 1.02):
        bench.twin.echo_s = 2.0 * range_m / SOUND_M_S
        ranges_m.append(ranger.ping_m())
    assert ranges_m[2:] == pytest.approx([2.0, 2.02, 2.04, 2.04, 1.02], abs=1e-6)
    ranger.forget()  # it has been turned
    bench.twin.echo_s = 2.0 * 0.5 / SOUND_M_S
    assert ranger.ping_m() == pytest.approx(0.5)


def test_a_part_that_does_not_answer_is_a_fault_and_not_free_water(bench: Bench) -> None:
    ranger = bench.ranger(max_range_m=0.1)
    bench.twin.echo_s = None
    with pytest.raises(HardwareError, match="no answer to the trigger"):
        ranger.ping_m()


def test_an_echo_pin_that_hangs_is_no_echo_and_then_a_fault_until_it_lets_go(bench: Bench) -> None:
    ranger = bench.ranger(max_range_m=0.1)
    bench.twin.hangs = True
    assert ranger.ping_m() is None
    with pytest.raises(HardwareError, match="stuck high"):
        ranger.ping_m()
    bench.twin.hangs = False
    bench.echo.edge(50.0, False)
    bench.twin.echo_s = 2.0 * 0.05 / SOUND_M_S
    assert ranger.ping_m() == pytest.approx(0.05)


@pytest.mark.realtime
def test_the_late_end_of_a_ping_that_was_given_up_does_not_end_the_next_one(bench: Bench) -> None:
    ranger = bench.ranger()
    bench.twin.echo_s = None

    def late_then_whole() -> None:
        bench.echo.edge(10.0, False)
        threading.Timer(0.005, lambda: (bench.echo.edge(11.0, True), bench.echo.edge(11.01, False))).start()

    bench.twin.on_pulse = late_then_whole
    assert ranger.ping_m() == pytest.approx(0.5 * SOUND_M_S * 0.01)


def test_a_jsn_sr04t_without_an_echo_holds_its_pin_for_60_ms_and_pings_more_slowly(bench: Bench) -> None:
    trigger = GPIODevice(PART.trigger, pin_factory=bench.factory)
    echo = InputDevice(PART.echo, pin_factory=bench.factory)
    ranger = EchoPinRanger(trigger, echo, bench.factory.ticks_diff, 4.5, 15.0, JSNSR04T)
    bench.twin.echo_s = 0.060
    assert ranger.ping_m() is None
    bench.twin.echo_s = 2.0 * 4.4 / SOUND_M_S
    assert ranger.ping_m() == pytest.approx(4.4)
    assert MountedRanger(FakeRanger(1.0), HandClock()).step() == 0.05
    ranger.forget()
    assert MountedRanger(ranger, HandClock(), range_m=(0.25, 4.5)).step() == 0.1


class FakeRanger:
    """Hands out the ranges that it is given."""

    period_s = 0.05

    def __init__(self, *ranges_m: float | None) -> None:
        self._ranges_m = iter(ranges_m)
        self.closes = 0
        self.done = list[str]()

    def ping_m(self) -> float | None:
        self.done.append("ping")
        return next(self._ranges_m)

    def forget(self) -> None:
        self.done.append("forget")

    def close(self) -> None:
        self.closes += 1


def test_every_ping_is_handed_over_once_with_its_time_and_bearing() -> None:
    clock, turned = HandClock(), list[float]()
    ranger = FakeRanger(1.0, None, 3.0, 1.5)
    sonar = MountedRanger(ranger, clock, (-0.5, 0.0, 0.5), turned.append, (0.25, 4.5))
    assert sonar.read() == []
    for _ in range(4):
        assert sonar.step() == 0.06
        clock.advance(0.06)
    readings = sonar.read()
    assert [reading.bearing_rad for reading in readings] == [-0.5, 0.0, 0.5, 0.0]
    assert [reading.range_m for reading in readings] == [1.0, None, 3.0, 1.5]
    assert [reading.time_s for reading in readings] == pytest.approx([100.0, 100.06, 100.12, 100.18])
    assert {(reading.min_range_m, reading.max_range_m) for reading in readings} == {(0.25, 4.5)}
    assert turned == [-0.5, 0.0, 0.5, 0.0, -0.5]
    assert ranger.done == 4 * ["forget", "ping"], "no range of before the turn"
    assert sonar.read() == []
    sonar.close()
    sonar.close()
    assert ranger.closes == 1


@given(st.floats(0.1, math.pi), st.floats(0.01, 2.0))
def test_a_sweep_swings_evenly_from_end_to_end_and_back(sweep_rad: float, step_rad: float) -> None:
    bearings = sweep_bearings_rad(sweep_rad, step_rad)
    assert min(bearings) == pytest.approx(-sweep_rad / 2.0)
    assert max(bearings) == pytest.approx(sweep_rad / 2.0)
    swing = [*bearings, bearings[0]]
    steps = [abs(b - a) for a, b in itertools.pairwise(swing)]
    assert steps == pytest.approx([steps[0]] * len(steps))
    assert steps[0] <= step_rad + 1e-9


@pytest.mark.realtime
def test_the_thread_pings_along_the_sweep_and_the_servo_turns_with_it(bench: Bench, lgpio: LgpioTwin) -> None:
    part = RangerPart(driver="hcsr04", servo=18, sweep_rad=math.pi, step_rad=math.pi)
    bench.twin.echo_s = 2.0 * 2.0 / SOUND_M_S
    sonar = open_ranger(part, HandClock(), bench.factory)
    readings: list[SonarReading] = []

    def has_pinged() -> bool:
        readings.extend(sonar.read())
        return len(readings) >= 3

    eventually(has_pinged)
    sonar.close()
    assert [reading.bearing_rad for reading in readings[:3]] == pytest.approx(
        [-math.pi / 2, math.pi / 2, -math.pi / 2]
    )
    assert {round(reading.range_m or 0.0, 6) for reading in readings} == {2.0}
    assert [signal.width_us for signal in lgpio.history[:2]] == [2500, 500]  # port is the longest pulse
    assert {bench.twin.function, bench.echo.function} == {"input"}
    assert lgpio.handles == {}


def test_a_servo_that_cannot_be_had_leaves_the_rangers_pins_to_others(bench: Bench, lgpio: LgpioTwin) -> None:
    lgpio.chips = {}
    with pytest.raises(HardwareError, match="can not open gpiochip"):
        open_ranger(RangerPart(driver="hcsr04", servo=18), HandClock(), bench.factory)
    lgpio.chips = {0: "pinctrl-bcm2711"}
    open_ranger(RangerPart(driver="hcsr04", servo=18), HandClock(), bench.factory).close()
