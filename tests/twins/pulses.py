"""Twins below the servo signals: the kernel's PWM files, the PCA9685's registers, lgpio's pulse thread."""

import errno
import os
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:  # benchmarks use these twins, too
    import pytest

PI_4 = {"pwmchip0": ("fe20c000.pwm", 2), "pwmchip2": ("fe20c800.pwm", 2)}  # the second is the audio jack's
PI_5 = {
    "pwmchip0": ("107d517a80.pwm", 2),
    "pwmchip2": ("1f00098000.pwm", 4),
    "pwmchip6": ("1f0009c000.pwm", 4),
}
PI_5_NEW_KERNEL = {"pwmchip0": ("1f00098000.pwm", 4), "pwmchip1": ("1f0009c000.pwm", 4)}
FRESH = {"period": "0", "duty_cycle": "0", "enable": "0", "polarity": "normal"}


class Signal(NamedTuple):
    """What comes out from a moment on. A width of zero: no pulses."""

    time_s: float
    output: str
    width_us: float


class KernelPwm:
    """A tree as /sys/class/pwm, with the rules of drivers/pwm/core.c and sysfs.c behind its files.

    They refuse a duty cycle above the period and any setting without a period (EINVAL), a channel that the
    chip lacks (ENODEV) or that is exported already (EBUSY), and another polarity while enabled (EBUSY). It
    stands for the driver's module `os`.
    """

    def __init__(
        self, root: Path, chips: dict[str, tuple[str, int]], now: Callable[[], float] = lambda: 0.0
    ) -> None:
        self.root = root / "class" / "pwm"
        self.history: list[Signal] = []
        self.fails_with = 0  # errno of every write
        self.denied: set[str] = set()  # names of files that this user may not open
        self._now = now
        self._paths: dict[int, Path] = {}
        for name, (device, count) in chips.items():
            chip, real = self.root / name, root / "devices" / device
            if chip.exists():  # another program's
                continue
            chip.mkdir(parents=True)
            real.mkdir(parents=True)
            (chip / "device").symlink_to(real)
            (chip / "npwm").write_text(f"{count}\n", encoding="ascii")
            (chip / "export").touch()

    def channel(self, chip: str, number: int) -> dict[str, str]:
        folder = self.root / chip / f"pwm{number}"
        return {name: (folder / name).read_text(encoding="ascii").strip() for name in FRESH}

    def export(self, chip: Path, number: int, files: dict[str, str] = FRESH) -> None:
        folder = chip / f"pwm{number}"
        folder.mkdir()
        for name, value in files.items():
            (folder / name).write_text(f"{value}\n", encoding="ascii")

    O_RDWR, O_WRONLY = os.O_RDWR, os.O_WRONLY

    def open(self, path: Path, flags: int) -> int:
        if path.name in self.denied:
            raise PermissionError(errno.EACCES, "Permission denied", str(path))
        descriptor = os.open(path, flags)
        self._paths[descriptor] = path
        return descriptor

    def close(self, descriptor: int) -> None:
        del self._paths[descriptor]
        os.close(descriptor)

    def pwrite(self, descriptor: int, data: bytes, offset: int) -> int:
        path, text = self._paths[descriptor], data.decode("ascii")
        assert offset == 0
        if self.fails_with:
            raise OSError(self.fails_with, os.strerror(self.fails_with))
        if path.name == "export":
            if not 0 <= int(text) < int((path.parent / "npwm").read_text(encoding="ascii")):
                raise OSError(errno.ENODEV, "No such device")
            if (path.parent / f"pwm{int(text)}").exists():
                raise OSError(errno.EBUSY, "Device or resource busy")
            self.export(path.parent, int(text))
            return len(data)
        state = {name: (path.parent / name).read_text(encoding="ascii").strip() for name in FRESH}
        if path.name == "polarity" and state["enable"] == "1":
            raise OSError(errno.EBUSY, "Device or resource busy")
        state[path.name] = text
        if not 0 <= int(state["duty_cycle"]) <= int(state["period"]) or state["period"] == "0":
            raise OSError(errno.EINVAL, "Invalid argument")
        path.write_text(f"{text}\n", encoding="ascii")
        width_us = int(state["duty_cycle"]) / 1e3 if state["enable"] == "1" else 0.0
        self._record(f"{path.parent.parent.name}/{path.parent.name}", width_us)
        return len(data)

    def _record(self, output: str, width_us: float) -> None:
        latest = next((signal.width_us for signal in reversed(self.history) if signal.output == output), 0.0)
        if width_us != latest:
            self.history.append(Signal(self._now(), output, width_us))


def plug_in_pwm(
    monkeypatch: "pytest.MonkeyPatch",
    tmp_path: Path,
    chips: dict[str, tuple[str, int]],
    now: Callable[[], float] = lambda: 0.0,
) -> KernelPwm:
    """Let the driver find these chips."""
    kernel = KernelPwm(tmp_path, chips, now)
    monkeypatch.setattr("companion.hal.pulses.sysfs_pwm.ROOT", kernel.root)
    monkeypatch.setattr("companion.hal.pulses.sysfs_pwm.os", kernel)
    return kernel


class Pca9685Twin:
    """NXP PCA9685 Rev. 4: registers, sleep, full off, ALL_LED, restart. oscillator_hz: of this specimen."""

    def __init__(self, now: Callable[[], float] = lambda: 0.0, oscillator_hz: float = 25e6) -> None:
        self.oscillator_hz = oscillator_hz
        self.history: list[Signal] = []
        self.lost = 0  # transfers that are not acknowledged
        self.is_oe_high = False
        self.sleeps_while_running = 0
        self._now = now
        self._latest: dict[str, float] = {}
        self.power_up()

    def power_up(self) -> None:
        """As its supply comes on (table 4 ff.): asleep, all calls answered, every output full off, 200 Hz."""
        self.registers = bytearray(256)
        self.registers[0x00:0x06] = b"\x11\x04\xe2\xe4\xe8\xe0"
        for channel in range(16):
            self.registers[0x09 + 4 * channel] = 0x10
        self.registers[0xFE] = 0x1E
        self._record()

    def width_us(self, channel: int) -> float:
        """What an oscilloscope shows on an output; 0 without pulses."""
        on_l, on_h, off_l, off_h = self.registers[0x06 + 4 * channel : 0x0A + 4 * channel]
        if self.is_oe_high or off_h & 0x10 or self.registers[0x00] & 0x10:  # or full off, or no clock
            return 0.0
        assert not on_h & 0x10, "full on is no servo signal"
        steps = ((off_h << 8 | off_l) - (on_h << 8 | on_l)) % 4096
        return 1e6 * steps * (self.registers[0xFE] + 1) / self.oscillator_hz

    @property
    def frequency_hz(self) -> float:
        return self.oscillator_hz / (4096.0 * (self.registers[0xFE] + 1))

    def get(self, register: int, length: int) -> bytes:
        self._acknowledge()
        assert length == 1 or self.registers[0x00] & 0x20, "no auto-increment: the same register again"
        shown = bytearray(self.registers)
        shown[0xFA:0xFE] = bytes(4)  # ALL_LED reads as zero
        return bytes(shown[register : register + length])

    def put(self, register: int, data: bytes) -> None:
        self._acknowledge()
        assert len(data) == 1 or self.registers[0x00] & 0x20, "no auto-increment"
        for offset, value in enumerate(data):
            self._put(register + offset, value)
        self._record()  # outputs change on the stop condition (MODE2, OCH = 0)

    def on(self) -> None:
        """OE is driven low."""
        self.is_oe_high = False
        self._record()

    def off(self) -> None:
        """OE is driven high: the outputs are low (table 6, OUTNE = 00)."""
        self.is_oe_high = True
        self._record()

    def _acknowledge(self) -> None:
        if self.lost:
            self.lost -= 1
            raise OSError(errno.EREMOTEIO, "Remote I/O error")

    def _put(self, register: int, value: int) -> None:
        match register:
            case 0x00:
                self.sleeps_while_running += value & 0x10 and not self.registers[0x00] & 0x10
                self.registers[0x00] = value & 0x7F
            case 0x01:
                self.registers[0x01] = value & 0x1F
            case 0xFE:
                if self.registers[0x00] & 0x10:  # only in sleep
                    self.registers[0xFE] = max(value, 3)
            case _ if 0xFA <= register <= 0xFD:
                for channel in range(16):
                    self.registers[0x06 + 4 * channel + register - 0xFA] = (
                        value & 0x1F if register % 2 else value
                    )
            case _ if 0x06 <= register <= 0x45:
                self.registers[register] = value & 0x1F if register % 2 else value
            case _:
                raise AssertionError(f"register {register:#x} is not for the boat")

    def _record(self) -> None:
        for channel in range(16):
            output, width_us = f"channel {channel}", self.width_us(channel)
            if width_us != self._latest.get(output, 0.0):
                self._latest[output] = width_us
                self.history.append(Signal(self._now(), output, width_us))


class LgpioError(Exception):
    """As lgpio.error."""


class LgpioTwin:
    """lgpio, with the rules of lgGpio.c and lgPthTx.c for servo pulses.

    Pulses with a number of cycles end by themselves with the pin low; others last until the next call. A
    width of zero stops the thread's work on the pin at once and leaves the pin as it is, perhaps high.
    """

    TX_PWM = 0
    error = LgpioError

    def __init__(self, chips: dict[int, str], now: Callable[[], float] = lambda: 0.0) -> None:
        self.chips = chips  # labels by number
        self.history: list[Signal] = []
        self.claimed: dict[int, int] = {}  # handle by pin
        self.handles: dict[int, int] = {}  # chip by handle
        self.is_stuck = False
        self._ends: set[int] = set()  # pins with a last pulse under way
        self._now = now

    def gpiochip_open(self, number: int) -> int:
        if number not in self.chips:
            raise LgpioError("can not open gpiochip")
        handle = max(self.handles, default=-1) + 1
        self.handles[handle] = number
        return handle

    def gpio_get_chip_info(self, handle: int) -> list[object]:
        return [0, 54, f"gpiochip{self.handles[handle]}", self.chips[self.handles[handle]]]

    def gpiochip_close(self, handle: int) -> int:
        for pin in [pin for pin, owner in self.claimed.items() if owner == handle]:
            assert self.width_us(pin) == 0.0, "closed in the middle of a pulse"
            del self.claimed[pin]
        del self.handles[handle]
        return 0

    def gpio_claim_output(self, handle: int, pin: int, level: int) -> int:
        assert level == 0
        if pin in self.claimed:
            raise LgpioError("GPIO busy")
        self.claimed[pin] = handle
        return 0

    def tx_servo(
        self, handle: int, pin: int, width_us: int, frequency_hz: int, offset: int, cycles: int
    ) -> int:
        assert self.claimed[pin] == handle
        if self.is_stuck:
            raise LgpioError("bad handle")
        assert 500 <= width_us <= 2500
        assert 40 <= frequency_hz <= 500
        assert offset == 0
        if width_us != self.width_us(pin):
            self.history.append(Signal(self._now(), f"GPIO {pin}", width_us))
        if cycles:
            self._ends.add(pin)
        return 9

    def tx_busy(self, handle: int, pin: int, kind: int) -> int:
        """One period passes with each question."""
        assert kind == self.TX_PWM
        if pin in self._ends:
            self._ends.remove(pin)
            self.history.append(Signal(self._now(), f"GPIO {pin}", 0.0))
            return 1
        return int(self.width_us(pin) > 0.0)

    def width_us(self, pin: int) -> float:
        output = f"GPIO {pin}"
        return next((signal.width_us for signal in reversed(self.history) if signal.output == output), 0.0)
