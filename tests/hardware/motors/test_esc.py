"""Speed controllers over outputs that record their pulses."""

import itertools
import math
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import pytest
from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, rule
from twins.lines import HandClock
from twins.pulses import KernelPwm, Signal

from companion.app.parts import open_motors
from companion.config.actuators import PulseOutputSetting
from companion.config.boat_config import decode_config
from companion.core.errors import HardwareError
from companion.hal.motors.esc import Esc, EscMotors

LEFT, RIGHT = PulseOutputSetting(pin=12), PulseOutputSetting(pin=13)
ARMING_S, DEAD_TIME_S, FRAME_S = 3.0, 0.02, 0.02


class RecordingOutput:
    """A pulse output that records, and can fail."""

    def __init__(self, name: str, history: list[Signal], now: Callable[[], float]) -> None:
        self.name = name
        self.is_broken = False
        self.closes = 0
        self._history = history
        self._now = now

    @property
    def width_us(self) -> float:
        return next(
            (signal.width_us for signal in reversed(self._history) if signal.output == self.name), 0.0
        )

    def write_us(self, width_us: float) -> None:
        if self.is_broken:
            raise HardwareError(f"{self.name} is stuck")
        assert not self.closes
        if width_us != self.width_us:
            self._history.append(Signal(self._now(), self.name, width_us))

    def off(self) -> None:
        self.write_us(0.0)

    def close(self) -> None:
        if not self.closes:
            self.is_broken = False
            self.off()
        self.closes += 1


class Boat:
    """Two ESCs."""

    def __init__(self, setting: PulseOutputSetting = LEFT, sides: int = 2) -> None:
        self.clock = HandClock()
        self.history: list[Signal] = []
        self.waits: list[float] = []
        self.setting = setting
        self.outputs = [RecordingOutput(name, self.history, self.clock) for name in ("left", "right")[:sides]]
        escs = tuple(Esc(output, setting, DEAD_TIME_S, self.clock) for output in self.outputs)
        self.motors = EscMotors(escs, ARMING_S, self.clock, self.wait)

    def wait(self, seconds: float) -> None:
        self.waits.append(seconds)
        self.clock.advance(seconds)

    def arm(self) -> "Boat":
        self.clock.advance(ARMING_S)
        return self

    @property
    def widths(self) -> list[float]:
        return [output.width_us for output in self.outputs]


def test_a_reversal_passes_neutral_for_the_dead_time() -> None:
    boat = Boat().arm()
    boat.motors.write(1.0, 0.5)
    boat.motors.write(-1.0, 0.6)
    assert boat.widths == [1500.0, pytest.approx(1740.0)]
    boat.clock.advance(0.9 * DEAD_TIME_S)
    boat.motors.write(-1.0, 0.6)
    assert boat.widths[0] == 1500.0
    boat.clock.advance(0.2 * DEAD_TIME_S)
    boat.motors.write(-1.0, 0.6)
    assert boat.widths[0] == 1100.0


def test_stop_is_neutral_and_close_sends_it_before_the_pulses_end() -> None:
    boat = Boat().arm()
    boat.motors.write(1.0, -1.0)
    boat.motors.stop()
    assert boat.widths == [1500.0, 1500.0]
    boat.motors.write(1.0, -1.0)
    boat.motors.close()
    boat.motors.close()
    boat.motors.stop()
    assert boat.widths == [0.0, 0.0]
    assert [signal.width_us for signal in boat.history if signal.output == "left"][-2:] == [1500.0, 0.0]
    assert boat.waits == [pytest.approx(3 * FRAME_S)]
    with pytest.raises(HardwareError, match="ESC: written to after close"):
        boat.motors.write(0.0, 0.0)


@pytest.mark.parametrize("way", ["write", "stop", "close"])
@pytest.mark.parametrize("stuck", [0, 1])
def test_a_signal_that_fails_leaves_the_other_neutral_and_both_arm_anew(way: str, stuck: int) -> None:
    boat = Boat().arm()
    boat.motors.write(1.0, 1.0)
    boat.outputs[stuck].is_broken = True
    with pytest.raises(HardwareError, match="is stuck"):
        getattr(boat.motors, way)(*((0.5, 0.5) if way == "write" else ()))
    assert boat.widths[1 - stuck] == (0.0 if way == "close" else 1500.0)
    if way == "close":
        assert [output.closes for output in boat.outputs] == [1, 1]
        return
    boat.outputs[stuck].is_broken = False
    boat.clock.advance(ARMING_S - FRAME_S)
    boat.motors.write(0.5, 0.5)
    assert boat.widths == [1500.0, 1500.0]
    boat.clock.advance(2 * FRAME_S)
    boat.motors.write(0.5, 0.5)
    assert boat.widths == [1700.0, 1700.0]


def test_close_waits_for_the_slower_signal_and_tells_of_one_that_does_not_end(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    boat = Boat()

    def fail() -> None:
        raise HardwareError("its pulses could not be ended")

    monkeypatch.setattr(boat.outputs[0], "close", fail)
    settings = (PulseOutputSetting(frequency_hz=400), PulseOutputSetting(frequency_hz=50))
    escs = [Esc(*pair, DEAD_TIME_S, boat.clock) for pair in zip(boat.outputs, settings, strict=True)]
    motors = EscMotors(tuple(escs), ARMING_S, boat.clock, boat.wait)
    with pytest.raises(HardwareError, match="could not be ended"):
        motors.close()
    assert boat.waits == [pytest.approx(3 * FRAME_S)]
    assert boat.outputs[1].closes == 1


@pytest.mark.parametrize("way", ["write", "stop", "close"])
def test_an_interrupt_leaves_both_neutral_or_ended(way: str, monkeypatch: pytest.MonkeyPatch) -> None:
    for struck in (0, 1):
        boat = Boat().arm()
        boat.motors.write(1.0, 1.0)
        failures = iter([True])

        def interrupted(
            width_us: float, output: RecordingOutput, failures: Iterator[bool] = failures
        ) -> None:
            if next(failures, False):
                raise KeyboardInterrupt
            RecordingOutput.write_us(output, width_us)

        monkeypatch.setattr(
            boat.outputs[struck], "write_us", partial(interrupted, output=boat.outputs[struck])
        )
        with pytest.raises(KeyboardInterrupt):
            getattr(boat.motors, way)(*((0.9, 0.9) if way == "write" else ()))
        assert boat.widths[1 - struck] == (0.0 if way == "close" else 1500.0)
        assert [output.closes for output in boat.outputs] == [way == "close"] * 2


def test_an_interrupt_of_the_last_pulses_ends_them() -> None:
    boat = Boat().arm()

    def interrupted(seconds: float) -> None:
        raise KeyboardInterrupt

    motors = EscMotors(
        tuple(Esc(output, LEFT, DEAD_TIME_S, boat.clock) for output in boat.outputs),
        ARMING_S,
        boat.clock,
        interrupted,
    )
    with pytest.raises(KeyboardInterrupt):
        motors.close()
    assert boat.widths == [0.0, 0.0]


@pytest.mark.parametrize("lines", [{"left": {"pin": 12, "reversed": True}}, {"left_reversed": True}])
def test_a_reversed_motor_gets_the_mirrored_pulse(kernel: KernelPwm, lines: dict[str, Any]) -> None:
    config = decode_config({"parts": {"motors": {"driver": "esc", "arming_s": 0.0, **lines}}}, "test")
    motors = open_motors(config, HandClock())
    motors.write(1.0, 1.0)
    motors.close()
    pulses = [(signal.output[-1], signal.width_us) for signal in kernel.history]
    assert pulses[2:4] == [("0", 1100.0), ("1", 1900.0)]


class Commands(RuleBasedStateMachine):
    """Any sequence of write, stop, close and time, with faults."""

    def __init__(self) -> None:
        super().__init__()
        self.boat = Boat()
        self.began_s = self.boat.clock()
        self.fault_s = self.began_s
        self.is_open = True

    def is_armed(self) -> bool:
        return self.boat.clock() - max(self.began_s, self.fault_s) >= ARMING_S

    @rule(left=st.floats(), right=st.floats(-1.5, 1.5))
    def write(self, left: float, right: float) -> None:
        if not self.is_open:
            with pytest.raises(HardwareError, match="after close"):
                self.boat.motors.write(left, right)
        elif any(output.is_broken for output in self.boat.outputs):
            with pytest.raises(HardwareError, match="is stuck"):
                self.boat.motors.write(left, right)
            self.fault_s = self.boat.clock()
        else:
            was_armed = self.is_armed()
            self.boat.motors.write(left, right)
            if not was_armed or not math.isfinite(left):
                assert self.boat.widths == [1500.0, 1500.0]

    @rule()
    def stop(self) -> None:
        if self.is_open and any(output.is_broken for output in self.boat.outputs):
            with pytest.raises(HardwareError, match="is stuck"):
                self.boat.motors.stop()
            self.fault_s = self.boat.clock()
        else:
            self.boat.motors.stop()
            assert self.boat.widths == ([1500.0, 1500.0] if self.is_open else [0.0, 0.0])

    @rule(side=st.integers(0, 1))
    def break_or_mend(self, side: int) -> None:
        if self.is_open:
            self.boat.outputs[side].is_broken = not self.boat.outputs[side].is_broken

    @rule()
    def close(self) -> None:
        for output in self.boat.outputs:
            output.is_broken = False
        self.boat.motors.close()
        self.is_open = False

    @rule(seconds=st.sampled_from([0.0, 0.01, 0.02, 1.0, 3.0]))
    def wait(self, seconds: float) -> None:
        self.boat.clock.advance(seconds)

    @invariant()
    def pulses_are_safe(self) -> None:
        for output in self.boat.outputs:
            signals = [signal for signal in self.boat.history if signal.output == output.name]
            assert all(1100.0 <= signal.width_us <= 1900.0 or signal.width_us == 0.0 for signal in signals)
            for before, after in itertools.pairwise(signals):
                if after.width_us == 0.0:
                    assert before.width_us == 1500.0, "no neutral before the pulses ended"
                    assert after.time_s - before.time_s >= 2 * FRAME_S, "neutral was too short"
                if (before.width_us - 1500.0) * (after.width_us - 1500.0) < 0.0:
                    raise AssertionError("reversed without neutral")
            early = [signal for signal in signals if signal.time_s - self.began_s < ARMING_S]
            assert {signal.width_us for signal in early} <= {0.0, 1500.0}, "a pulse before it was armed"


TestCommands = Commands.TestCase
TestCommands.settings = settings(max_examples=40)
