"""The L298N over mock pins: which pin changes when, and pins that fail."""

import contextlib
from collections.abc import Iterator

import pytest
from twins.lines import HandClock
from twins.pins import L298N, PinBoard

from companion.config.actuators import MotorsPart
from companion.core.errors import HardwareError
from companion.hal.motors.bridges import BridgeMotors, HalfBridgePair

PINS = L298N


@pytest.fixture
def clock() -> HandClock:
    return HandClock()


@pytest.fixture
def board() -> Iterator[PinBoard]:
    board = PinBoard()
    yield board
    board.factory.reset()


def test_forward_turns_the_leg_on_before_the_enable(board: PinBoard) -> None:
    bridge = board.open()
    bridge.write(0.5, 0.0)
    assert board.drain() == [(PINS.left_forward, 1.0), (PINS.left_enable, 0.5)]


def test_each_side_and_direction_has_its_own_pins(board: PinBoard) -> None:
    bridge = board.open()
    bridge.write(-0.25, 1.0)
    assert board.drain() == [
        (PINS.left_backward, 1.0),
        (PINS.left_enable, 0.25),
        (PINS.right_forward, 1.0),
        (PINS.right_enable, 1.0),
    ]


def test_a_reversed_motor_swaps_its_legs_only(board: PinBoard) -> None:
    bridge = board.open(MotorsPart(driver="l298n", left_reversed=True))
    bridge.write(0.5, 0.5)
    assert board.drain() == [
        (PINS.left_backward, 1.0),
        (PINS.left_enable, 0.5),
        (PINS.right_forward, 1.0),
        (PINS.right_enable, 0.5),
    ]


def test_reversal_drops_the_old_leg_at_once_and_drives_the_new_one_after_the_dead_time(
    board: PinBoard,
) -> None:
    bridge = board.open()
    bridge.write(1.0, 0.0)
    board.drain()
    bridge.write(-1.0, 0.0)
    assert board.drain() == [(PINS.left_enable, 0.0), (PINS.left_forward, 0.0)]
    board.clock.advance(PINS.dead_time_s / 2.0)
    bridge.write(-1.0, 0.0)
    assert board.drain() == []
    board.clock.advance(PINS.dead_time_s)
    bridge.write(-1.0, 0.0)
    assert board.drain() == [(PINS.left_backward, 1.0), (PINS.left_enable, 1.0)]


def test_a_stop_between_does_not_shorten_the_dead_time(board: PinBoard) -> None:
    bridge = board.open()
    bridge.write(1.0, 0.0)
    bridge.write(0.0, 0.0)
    board.drain()
    bridge.write(-1.0, 0.0)
    assert board.drain() == []


def test_close_stops_first_gives_the_pins_back_and_may_be_called_twice(board: PinBoard) -> None:
    bridge = board.open()
    bridge.write(1.0, -1.0)
    board.drain()
    bridge.close()
    bridge.close()
    assert board.drain()[:2] == [(PINS.left_enable, 0.0), (PINS.left_forward, 0.0)]
    assert set(board.levels().values()) == {0.0}
    assert {board.pin(pin).function for pin in board.levels()} == {"input"}
    bridge.stop()
    with pytest.raises(HardwareError, match="after close"):
        bridge.write(1.0, 1.0)


class FakeLeg:
    """A pin that can fail, once or for good, when it is switched."""

    def __init__(self, name: str, level: dict[str, float], broken: set[str]) -> None:
        self._name, self._level, self._broken = name, level, broken
        level[name] = 0.0

    @property
    def value(self) -> float:
        return self._level[self._name]

    @value.setter
    def value(self, value: float) -> None:
        if self._name in self._broken:
            raise OSError(f"{self._name} is stuck")
        self._level[self._name] = value

    def on(self) -> None:
        self.value = 1.0

    def off(self) -> None:
        self.value = 0.0

    def close(self) -> None:
        self.value = 0.0


def fake_bridge(clock: HandClock) -> tuple[BridgeMotors, dict[str, float], set[str]]:
    level: dict[str, float] = {}
    broken: set[str] = set()

    def pair(side: str) -> HalfBridgePair:
        forward, backward, enable = (
            FakeLeg(f"{side} {pin}", level, broken) for pin in ("forward", "backward", "enable")
        )
        return HalfBridgePair(forward, backward, enable, 0.02, clock)

    return BridgeMotors("L298N", pair("left"), pair("right")), level, broken


PIN_NAMES = [f"{side} {pin}" for side in ("left", "right") for pin in ("forward", "backward", "enable")]


@pytest.mark.parametrize("stuck", PIN_NAMES)
def test_one_pin_that_fails_keeps_no_other_pin_on(clock: HandClock, stuck: str) -> None:
    for way_out in ("write", "stop", "close"):
        bridge, level, broken = fake_bridge(clock)
        bridge.write(1.0, -1.0)
        broken.add(stuck)
        with pytest.raises(HardwareError, match="is stuck"):
            getattr(bridge, way_out)(*((-0.5, 0.5) if way_out == "write" else ()))
        assert {name for name, value in level.items() if value} <= {stuck}


@pytest.mark.parametrize("way", ["stop", "zero", "other way", "on"])
@pytest.mark.parametrize("stuck", ["left enable", "left forward"])
def test_a_bridge_that_could_not_be_opened_is_opened_again_by_whatever_comes_next(
    clock: HandClock, stuck: str, way: str
) -> None:
    bridge, level, broken = fake_bridge(clock)
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
    clock: HandClock, monkeypatch: pytest.MonkeyPatch, stuck: str | None
) -> None:
    bridge, level, broken = fake_bridge(clock)
    bridge.write(1.0, -1.0)
    broken.update({stuck} if stuck else ())
    still_on: list[set[str]] = []
    monkeypatch.setattr(FakeLeg, "close", lambda _: still_on.append({name for name in level if level[name]}))
    with contextlib.suppress(HardwareError):
        bridge.close()
    assert len(still_on) == len(PIN_NAMES)
    assert all(names <= {stuck} for names in still_on)
