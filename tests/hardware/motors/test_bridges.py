"""H-bridges over mock pins: never both legs, dead time, off at every way out, and pins that fail."""

import contextlib
import math
from collections.abc import Iterator
from typing import Any

import msgspec
import pytest
from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, precondition, rule
from twins.lines import HandClock
from twins.pins import BRIDGES, L298N, PinBoard, assert_is_safe, motors_of

from companion.config.actuators import MotorsPart
from companion.core.errors import HardwareError
from companion.hal.motors.bridges import BridgeMotors, HalfBridgePair

SHARES = st.one_of(
    st.floats(-1.5, 1.5), st.sampled_from([0.0, -0.0, 1.0, -1.0, math.nan, math.inf, -math.inf, 1e-300])
)
DEAD_TIME_S = 0.02


@pytest.fixture(params=BRIDGES, ids=lambda part: part.driver)
def board(request: pytest.FixtureRequest) -> Iterator[PinBoard]:
    board = PinBoard(request.param)
    yield board
    board.factory.reset()


def drives(board: PinBoard) -> list[float]:
    return [board.drive(motor) for motor in motors_of(board.part)]


def test_a_reversed_motor_turns_the_other_way(board: PinBoard) -> None:
    bridge = board.open(msgspec.structs.replace(board.part, right_reversed=True))
    bridge.write(0.5, 0.5)
    assert drives(board) == [0.5, -0.5]


def test_a_slow_pulse_train_ends_before_the_other_leg_begins() -> None:
    """lgpio changes a pulse train at the end of its period: at 50 Hz that is up to 20 ms later."""
    board = PinBoard(MotorsPart(driver="bts7960", pwm_hz=50, dead_time_s=0.0))
    bridge = board.open()
    bridge.write(1.0, 1.0)
    bridge.write(-1.0, -1.0)
    board.clock.advance(0.039)
    bridge.write(-1.0, -1.0)
    assert board.is_off
    board.clock.advance(0.002)
    bridge.write(-1.0, -1.0)
    assert drives(board) == [-1.0, -1.0]


def test_a_boat_with_one_motor_opens_only_the_left_pins(board: PinBoard) -> None:
    bridge = board.open(has_right=False)
    left, right = motors_of(board.part)
    bridge.write(0.5, -1.0)
    assert drives(board) == [0.5, 0.0]
    assert {change.pin for change in board.history} <= set(left) - set(right)
    bridge.close()
    assert board.is_off


@pytest.fixture
def l298n() -> Iterator[PinBoard]:
    board = PinBoard()
    yield board
    board.factory.reset()


def test_close_stops_first_gives_the_pins_back_and_may_be_called_twice(l298n: PinBoard) -> None:
    bridge = l298n.open()
    bridge.write(1.0, -1.0)
    l298n.drain()
    bridge.close()
    bridge.close()
    assert l298n.drain()[:2] == [(L298N.left_enable, 0.0), (L298N.left_forward, 0.0)]
    assert set(l298n.levels().values()) == {0.0}
    assert {l298n.pin(pin).function for pin in l298n.levels()} == {"input"}
    bridge.stop()
    with pytest.raises(HardwareError, match="after close"):
        bridge.write(1.0, 1.0)


class FakeLeg:
    """A pin that can fail, once or for good, when it is switched."""

    def __init__(
        self, name: str, level: dict[str, float], broken: set[str], error: type[BaseException]
    ) -> None:
        self._name, self._level, self._broken, self._error = name, level, broken, error
        level[name] = 0.0

    @property
    def value(self) -> float:
        return self._level[self._name]

    @value.setter
    def value(self, value: float) -> None:
        if self._name in self._broken:
            raise self._error(f"{self._name} is stuck")
        self._level[self._name] = value

    def on(self) -> None:
        self.value = 1.0

    def off(self) -> None:
        self.value = 0.0

    def close(self) -> None:
        self.value = 0.0


def fake_bridge(error: type[BaseException] = OSError) -> tuple[BridgeMotors, dict[str, float], set[str]]:
    level: dict[str, float] = {}
    broken: set[str] = set()

    def pair(side: str) -> HalfBridgePair:
        forward, backward, enable = (
            FakeLeg(f"{side} {pin}", level, broken, error) for pin in ("forward", "backward", "enable")
        )
        return HalfBridgePair(forward, backward, enable, 0.02, HandClock())

    return BridgeMotors("L298N", pair("left"), pair("right")), level, broken


PIN_NAMES = [f"{side} {pin}" for side in ("left", "right") for pin in ("forward", "backward", "enable")]


@pytest.mark.parametrize(
    ("error", "told"), [(OSError, HardwareError), (KeyboardInterrupt, KeyboardInterrupt)]
)
@pytest.mark.parametrize("stuck", PIN_NAMES)
def test_one_pin_that_fails_keeps_no_other_pin_on(
    stuck: str, error: type[BaseException], told: type[BaseException]
) -> None:
    for way_out in ("write", "stop", "close"):
        bridge, level, broken = fake_bridge(error)
        bridge.write(1.0, -1.0)
        broken.add(stuck)
        with pytest.raises(told, match="is stuck"):
            getattr(bridge, way_out)(*((-0.5, 0.5) if way_out == "write" else ()))
        assert {name for name, value in level.items() if value} <= {stuck}


@pytest.mark.parametrize("way", ["stop", "zero", "other way", "on"])
@pytest.mark.parametrize("stuck", ["left enable", "left forward"])
def test_a_bridge_that_could_not_be_opened_is_opened_again_by_whatever_comes_next(
    stuck: str, way: str
) -> None:
    bridge, level, broken = fake_bridge()
    bridge.write(0.5, 0.0)
    broken.add(stuck)
    with pytest.raises(HardwareError):
        bridge.stop()
    assert level[stuck]
    with pytest.raises(HardwareError):  # and says so for as long as it cannot
        bridge.write(0.0, 0.0)
    broken.clear()
    if way == "stop":
        bridge.stop()
    else:
        bridge.write({"zero": 0.0, "other way": -0.5, "on": 0.3}[way], 0.0)
    if way == "on":
        assert (level["left forward"], level["left enable"]) == (1.0, 0.3)
    else:
        assert not any(level.values())


@pytest.mark.parametrize("stuck", [None, *PIN_NAMES])
def test_every_pin_is_switched_off_before_the_first_is_given_back(
    monkeypatch: pytest.MonkeyPatch, stuck: str | None
) -> None:
    bridge, level, broken = fake_bridge()
    bridge.write(1.0, -1.0)
    broken.update({stuck} if stuck else ())
    still_on: list[set[str]] = []
    monkeypatch.setattr(FakeLeg, "close", lambda _: still_on.append({name for name in level if level[name]}))
    with contextlib.suppress(HardwareError):
        bridge.close()
    assert len(still_on) == len(PIN_NAMES)
    assert all(names <= {stuck} for names in still_on)


class Commands(RuleBasedStateMachine):
    """Any sequence of write, stop, close, open and time, on one bridge."""

    part = BRIDGES[0]

    def __init__(self) -> None:
        super().__init__()
        self.board = PinBoard(self.part)
        self.bridge = self.board.open()
        self.is_open = True
        self.command = (0.0, 0.0)

    def teardown(self) -> None:
        self.bridge.close()
        assert self.board.is_off
        self.board.factory.reset()

    @rule(left=SHARES, right=SHARES)
    def write(self, left: float, right: float) -> None:
        if not self.is_open:
            with pytest.raises(HardwareError, match="after close"):
                self.bridge.write(left, right)
            return
        self.bridge.write(left, right)
        if not (math.isfinite(left) and math.isfinite(right)):
            left = right = 0.0
        wanted = (max(-1.0, min(1.0, left)), max(-1.0, min(1.0, right)))
        for share, drive in zip(wanted, drives(self.board), strict=True):
            assert drive in (share, 0.0)  # 0 in the dead time
        self.command = wanted

    @precondition(lambda self: self.is_open)
    @rule()
    def hold(self) -> None:
        """A command that is held is reached after the dead time."""
        self.bridge.write(*self.command)
        self.board.clock.advance(DEAD_TIME_S + 1e-6)
        self.bridge.write(*self.command)
        assert drives(self.board) == list(self.command)

    @rule(seconds=st.sampled_from([0.0, 0.005, 0.02, 0.1]))
    def wait(self, seconds: float) -> None:
        self.board.clock.advance(seconds)

    @rule()
    def stop(self) -> None:
        self.bridge.stop()
        self.command = (0.0, 0.0)
        assert self.board.is_off

    @rule()
    def close(self) -> None:
        self.bridge.close()
        self.is_open = False
        self.command = (0.0, 0.0)

    @precondition(lambda self: not self.is_open)
    @rule()
    def reopen(self) -> None:
        self.board.clock.advance(1.0)  # a program takes longer to start
        with contextlib.suppress(IndexError):
            self.bridge = self.board.open()
        self.is_open = True

    @invariant()
    def is_safe(self) -> None:
        assert_is_safe(self.board.history, self.part, DEAD_TIME_S - 1e-9)
        assert self.is_open or self.board.is_off


MACHINES: list[Any] = [type(f"Commands_{part.driver}", (Commands,), {"part": part}) for part in BRIDGES]
for machine in MACHINES:
    machine.TestCase.settings = settings(max_examples=10)
TestL298n, TestTb6612, TestBts7960, TestDrv8833 = (machine.TestCase for machine in MACHINES)
