"""Every driver of motors in the whole boat: off within a tick at every way out, and never a forbidden pin.

The boat sails in simulated water, with the real driver over a twin. `tests/e2e/boat` has the signals.
"""

import contextlib
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, Protocol

import pytest
from boat_rig import DENIED, FAILED, OK, Rig
from twins.escs import VescTwin
from twins.i2c import plug_in
from twins.lines import HandClock, MemoryLine
from twins.pins import BRIDGES, PinBoard, assert_is_safe, motors_of
from twins.pulses import PI_4, LgpioTwin, Pca9685Twin, Signal, plug_in_pwm

from companion.boat import TICK_S
from companion.config.actuators import MotorsPart, Pca9685Part, PulseOutputSetting
from companion.core.errors import HardwareError
from companion.hal.interfaces import Motors
from companion.hal.motors.esc import open_escs
from companion.hal.motors.esc_line import EscLine
from companion.hal.motors.vesc import Vesc, VescMotors
from companion.hal.motors.watched_motors import WatchedMotors
from companion.hal.pulses.lgpio_pulses import LgpioPulses
from companion.hal.pulses.pca9685 import Pca9685Board, Pca9685Pulses
from companion.hal.pulses.pca9685_chip import Pca9685
from companion.hal.pulses.sysfs_pwm import open_sysfs_pulses
from companion.hal.raspberry_pi import open_i2c
from companion.mavlink.dialect import dialect

DRIVERS = [*(part.driver for part in BRIDGES), "esc hardware", "esc software", "esc pca9685", "vesc"]
ARMING_S, DEAD_TIME_S, TIMEOUT_S = 3.0, 0.02, 0.5
NEUTRAL_US, PERIOD_S = 1500.0, 0.02
CHIP = Pca9685Part()


class MotorTwin(Protocol):
    """What is below the driver."""

    def open(self, now: Callable[[], float]) -> Motors: ...
    def step(self) -> None: ...  # what a thread would do
    @property
    def is_driving(self) -> bool: ...
    def check(self) -> None: ...  # the whole record is safe


class FollowingClock(HandClock):
    """The clock of a simulation."""

    def __init__(self, now: Callable[[], float]) -> None:
        self._now = now

    def __call__(self) -> float:
        return self._now()


class BridgeTwin:
    """Mock pins."""

    def __init__(self, part: MotorsPart, now: Callable[[], float]) -> None:
        self._board = PinBoard(part, FollowingClock(now))

    def open(self, now: Callable[[], float]) -> Motors:
        return self._board.open()

    def step(self) -> None:
        pass

    @property
    def is_driving(self) -> bool:
        return any(self._board.drive(motor) for motor in motors_of(self._board.part))

    def check(self) -> None:
        assert_is_safe(self._board.history, self._board.part, DEAD_TIME_S - 1e-9)


class EscTwin:
    """A source of pulses, and speed controllers that drive at any width but neutral."""

    def __init__(
        self,
        history: list[Signal],
        outputs: Callable[[PulseOutputSetting], Any],
        step: Callable[[], None] = lambda: None,
    ) -> None:
        self._history = history
        self._outputs = outputs
        self.step = step
        self.chip: Pca9685Twin | None = None
        self._began_s = 0.0

    def open(self, now: Callable[[], float]) -> Motors:
        self._began_s = now()
        settings = (PulseOutputSetting(pin=12, channel=0), PulseOutputSetting(pin=13, channel=1))
        return open_escs(settings, DEAD_TIME_S, ARMING_S, now, self._outputs, lambda _: self.step())

    @property
    def is_driving(self) -> bool:
        latest = {signal.output: signal.width_us for signal in self._history}
        return any(width_us and not _is_neutral(width_us) for width_us in latest.values())

    def check(self) -> None:
        for output in {signal.output for signal in self._history}:
            signals = [signal for signal in self._history if signal.output == output]
            early = [signal for signal in signals if signal.time_s - self._began_s < ARMING_S - PERIOD_S]
            assert all(_is_neutral(signal.width_us) for signal in early), "a pulse before it was armed"
            ends = [number for number, signal in enumerate(signals) if not signal.width_us]
            assert all(_is_neutral(signals[number - 1].width_us) for number in ends), "ended without neutral"


class VescPair:
    """Two VESCs on one line, the right one over CAN."""

    def __init__(self, now: Callable[[], float]) -> None:
        self.wire, clock = MemoryLine(), FollowingClock(now)
        self._right = VescTwin(clock, 11)
        self._left = VescTwin(clock, 10, self._right)
        self._line = EscLine(self.wire.port, clock, MotorsPart(driver="vesc", can_id=11), 0)
        self._line.step()

    def open(self, now: Callable[[], float]) -> Motors:
        return VescMotors((Vesc(self._line, -1, 1, now), Vesc(self._line, 11, 1, now)), now)

    def step(self) -> None:
        self._line.step()
        self.wire.far.send(self._left.hear(self.wire.heard()))
        self._left.tick()

    @property
    def is_driving(self) -> bool:
        self._left.hear(self.wire.heard())
        return bool(self._left.duty or self._right.duty)

    def check(self) -> None:
        assert not self._left.refused


def _is_neutral(width_us: float) -> bool:
    return abs(width_us - NEUTRAL_US) < 3.0  # half a step of the PCA9685


def motor_twin(
    driver: str, now: Callable[[], float], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> MotorTwin:
    """The twin below a driver."""
    match driver:
        case "esc hardware":
            kernel = plug_in_pwm(monkeypatch, tmp_path, PI_4, now)
            return EscTwin(kernel.history, open_sysfs_pulses)
        case "esc software":
            lgpio = LgpioTwin({0: "pinctrl-bcm2711"}, now)
            monkeypatch.setitem(sys.modules, "lgpio", lgpio)

            def open_pin(setting: PulseOutputSetting) -> LgpioPulses:
                return LgpioPulses(lgpio, lgpio.gpiochip_open(0), setting, lambda _: None)  # type: ignore[arg-type]

            return EscTwin(lgpio.history, open_pin)
        case "esc pca9685" | "esc pca9685 without OE":
            chip = Pca9685Twin(now)
            plug_in(monkeypatch, tmp_path, {CHIP.address: chip})
            board = Pca9685Board(Pca9685(open_i2c("test"), CHIP), chip if driver == "esc pca9685" else None)
            twin = EscTwin(chip.history, lambda setting: Pca9685Pulses(board, setting), board.step)
            twin.chip = chip
            return twin
        case "vesc":
            return VescPair(now)
        case _:
            (part,) = (part for part in BRIDGES if part.driver == driver)
            return BridgeTwin(part, now)


class BothMotors:
    """Passes commands to a driver, and to the emulated motors once there are some."""

    def __init__(self, driver: Motors) -> None:
        self.all = [driver]

    def write(self, left: float, right: float) -> None:
        for motors in self.all:
            motors.write(left, right)

    def stop(self) -> None:
        for motors in self.all:
            motors.stop()

    def close(self) -> None:
        self.all[0].close()


class DrivenBoat:
    """A boat with a station and its motors' watch."""

    def __init__(self, driver: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
        self._now: Callable[[], float] = lambda: 0.0
        self.twin = motor_twin(driver, self.now, monkeypatch, tmp_path)
        motors = BothMotors(self.twin.open(self.now))
        self.watched = WatchedMotors(motors, self.now, TIMEOUT_S)
        self.rig = Rig(motors=self.watched, cutoff=self.watched)
        self._now = lambda: self.rig.now_s
        motors.all.append(self.rig.world.hardware.motors)
        self._look_s = 0.0

    def now(self) -> float:
        return self._now()

    def step(self, *, hangs: bool = False) -> None:
        """One tick of the boat, unless its loop hangs; of the water; and of the threads."""
        if not hangs:
            self.rig.boat.step(self.rig.now_s)
        self.twin.step()
        self.rig.world.step(TICK_S)
        if self.rig.now_s >= self._look_s:
            self._look_s = self.rig.now_s + TIMEOUT_S / 4.0
            with contextlib.suppress(HardwareError):  # its thread tries again
                self.watched.watch()

    def run(self, seconds: float) -> None:
        for _ in range(round(seconds / TICK_S)):
            self.step()

    def drive(self, forward: int = 500) -> None:
        """Armed in MANUAL, and the stick ahead or astern."""
        self.rig.ready()
        self.run(ARMING_S)
        assert self.rig.set_mode(0) == OK
        assert not self.twin.is_driving, "driving before it was armed"
        assert self.rig.arm() == OK
        self.push(forward)

    def push(self, forward: int) -> None:
        self.rig.peer.send(dialect.MAVLink_manual_control_message(1, 0, 0, forward, 0, 0))
        self.run(0.5)
        assert self.twin.is_driving


WITHIN_S = 0.02


@pytest.fixture(params=DRIVERS)
def boat(
    request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> Iterator[DrivenBoat]:
    boat = DrivenBoat(request.param, monkeypatch, tmp_path)
    boat.drive()
    yield boat
    boat.watched.close()
    boat.twin.step()
    assert not boat.twin.is_driving
    boat.twin.check()


def off_after_s(boat: DrivenBoat, limit_s: float, *, hangs: bool = False) -> float:
    """How long the motors still get current; fails if they start again."""
    began_s = boat.now()
    while boat.twin.is_driving:
        boat.step(hangs=hangs)
        assert boat.now() - began_s <= limit_s + 1e-9
    took_s = boat.now() - began_s
    for _ in range(round(0.6 / TICK_S)):
        boat.step(hangs=hangs)
        assert not boat.twin.is_driving, "they have started again"
    return took_s


def test_a_disarmed_boat_is_off_within_a_tick(boat: DrivenBoat) -> None:
    boat.rig.ask(400, 0.0)
    off_after_s(boat, WITHIN_S)


def test_a_fault_in_the_tick_is_off_within_it(boat: DrivenBoat, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail() -> None:
        raise ZeroDivisionError

    monkeypatch.setattr(boat.rig.boat.vehicle, "decide", fail)
    off_after_s(boat, WITHIN_S)


def test_a_loop_that_hangs_is_off_after_the_timeout_and_a_look(boat: DrivenBoat) -> None:
    took_s = off_after_s(boat, 1.25 * TIMEOUT_S + TICK_S, hangs=True)
    assert took_s > 0.5 * TIMEOUT_S
    assert boat.watched.trips == 1


# The bus of a PCA9685 fails under way

LOST = 10**9  # transfers


def under_way(driver: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> tuple[DrivenBoat, Pca9685Twin]:
    boat = DrivenBoat(driver, monkeypatch, tmp_path)
    boat.drive()
    assert isinstance(boat.twin, EscTwin)
    assert boat.twin.chip is not None
    return boat, boat.twin.chip


def test_the_outputs_are_off_at_once_and_the_boat_keeps_its_links(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    boat, chip = under_way("esc pca9685", monkeypatch, tmp_path)
    chip.lost = LOST
    boat.run(0.1)
    assert not boat.twin.is_driving
    boat.rig.peer.forget()
    boat.run(10.0)
    assert not boat.rig.boat.vehicle.armed
    assert len(boat.rig.peer.said("HEARTBEAT")) >= 9
    assert not [text for text in boat.rig.peer.texts if "switch the boat off" in text]
    assert boat.rig.arm() in (DENIED, FAILED)
    assert any("Motors: PCA9685: no answer on the I" in text for text in boat.rig.peer.texts)


def test_a_boat_that_cannot_stop_its_motors_says_so_again_and_again(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    boat, chip = under_way("esc pca9685 without OE", monkeypatch, tmp_path)
    chip.lost = LOST
    boat.run(11.0)  # every 5 s
    assert chip.width_us(0) > 1600.0
    told = [
        one for one in boat.rig.peer.said("STATUSTEXT") if one.text.startswith("Motors do not stop: switch")
    ]
    assert len(told) == 3
    assert {one.severity for one in told} == {dialect.MAV_SEVERITY_CRITICAL}
    assert len(boat.rig.peer.said("HEARTBEAT")) >= 10
    chip.lost = 0
    boat.run(0.1)
    assert chip.width_us(0) == pytest.approx(1500.0, abs=3.0)
    boat.rig.peer.forget()
    boat.run(6.0)
    assert not [text for text in boat.rig.peer.texts if "switch the boat off" in text]


def test_unplugged_vescs_are_off_after_their_own_timeout_and_drive_again_once_they_are_back(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    boat = DrivenBoat("vesc", monkeypatch, tmp_path)
    boat.drive()
    assert isinstance(boat.twin, VescPair)
    boat.twin.wire.far.close()
    boat.run(1.1)
    assert not boat.twin.is_driving
    boat.run(5.0)
    assert not boat.rig.boat.vehicle.armed
    assert boat.rig.arm() in (DENIED, FAILED)
    assert any("VESC: the line is unplugged" in text for text in boat.rig.peer.texts)
    boat.twin.wire.plug_in()
    boat.run(3.0)
    assert boat.rig.set_mode(0) == OK
    assert boat.rig.arm() == OK
    boat.push(500)
