"""The whole boat in simulated water, with the real driver of each kind of motors over a twin."""

import contextlib
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any, Protocol

import pytest
from boat_rig import OK, Rig
from twins.i2c import plug_in
from twins.lines import HandClock
from twins.pins import BRIDGES, PinBoard, assert_is_safe, motors_of
from twins.pulses import PI_4, LgpioTwin, Pca9685Twin, Signal, plug_in_pwm

from companion.boat import TICK_S
from companion.config.actuators import MotorsPart, Pca9685Part, PulseOutputSetting
from companion.core.errors import HardwareError
from companion.hal.interfaces import Motors
from companion.hal.motors.esc import open_escs
from companion.hal.motors.watched_motors import WatchedMotors
from companion.hal.pulses.lgpio_pulses import LgpioPulses
from companion.hal.pulses.pca9685 import Pca9685Board, Pca9685Pulses
from companion.hal.pulses.pca9685_chip import Pca9685
from companion.hal.pulses.sysfs_pwm import open_sysfs_pulses
from companion.hal.raspberry_pi import open_i2c
from companion.mavlink.dialect import dialect

DRIVERS = [*(part.driver for part in BRIDGES), "esc hardware", "esc software", "esc pca9685"]
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
        case _:
            (part,) = (part for part in BRIDGES if part.driver == driver)
            return BridgeTwin(part, now)


class BrokenOnce:
    """Passes commands to a driver and to the emulated motors; can be made to fail above the driver."""

    def __init__(self, driver: Motors) -> None:
        self.driver = driver
        self.turning: Motors | None = None
        self.breaks: set[str] = set()

    def write(self, left: float, right: float) -> None:
        if "write" in self.breaks:
            raise OSError("write: the wire has come off")
        self.driver.write(left, right)
        if self.turning is not None:
            self.turning.write(left, right)

    def stop(self) -> None:
        self.driver.stop()
        if self.turning is not None:
            self.turning.stop()

    def close(self) -> None:
        self.driver.close()


class DrivenBoat:
    """A boat with a station and its motors' watch."""

    def __init__(self, driver: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
        self._now: Callable[[], float] = lambda: 0.0
        self.twin = motor_twin(driver, self.now, monkeypatch, tmp_path)
        self.motors = BrokenOnce(self.twin.open(self.now))
        self.watched = WatchedMotors(self.motors, self.now, TIMEOUT_S)
        self.rig = Rig(motors=self.watched, cutoff=self.watched)
        self._now = lambda: self.rig.now_s
        self.motors.turning = self.rig.world.hardware.motors
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
