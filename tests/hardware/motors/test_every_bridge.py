"""What holds for each H-bridge, whatever its pins: never both legs, dead time, off at every way out."""

import contextlib
import math
from collections.abc import Iterator

import msgspec
import pytest
from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import RuleBasedStateMachine, invariant, precondition, rule
from twins.pins import BRIDGES, PinBoard, assert_is_safe, motors_of

from companion.config.actuators import MotorsPart
from companion.core.errors import HardwareError

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


def test_each_side_is_driven_as_far_and_in_the_direction_of_its_command(board: PinBoard) -> None:
    bridge = board.open()
    for left, right in ((0.5, -0.25), (0.75, -1.0), (0.0, -0.0)):
        bridge.write(left, right)
        assert drives(board) == [left, right]
    assert board.is_off


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


class Commands(RuleBasedStateMachine):
    """Any sequence of write, stop, close, open and time, on one bridge."""

    part = BRIDGES[0]

    def __init__(self) -> None:
        super().__init__()
        self.board = PinBoard(self.part)
        self.bridge = self.board.open()
        self.is_open = True
        self.command = (0.0, 0.0)
        self.command_s = self.board.clock()

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


class CommandsTb6612(Commands):
    part = BRIDGES[1]


class CommandsBts7960(Commands):
    part = BRIDGES[2]


class CommandsDrv8833(Commands):
    part = BRIDGES[3]


for machine in (CommandsTb6612, CommandsBts7960, CommandsDrv8833):
    machine.TestCase.settings = settings(max_examples=20)
TestCommandsL298N = Commands.TestCase
TestCommandsTb6612 = CommandsTb6612.TestCase
TestCommandsBts7960 = CommandsBts7960.TestCase
TestCommandsDrv8833 = CommandsDrv8833.TestCase
