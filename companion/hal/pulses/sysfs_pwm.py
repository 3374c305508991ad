"""Servo pulses by the Pi's own PWM, through the kernel's files in /sys/class/pwm.

The hardware makes the pulses (kernel: Documentation/driver-api/pwm.rst): they have no jitter, and they go on
when the program is killed until `companion.app.motors_off` ends them. The numbers of the chips differ between
models and kernels, so the chip is found by the name of its device. Pins and channels: data sheets BCM2711 and
RP1, tables of alternate functions; the overlay `pwm-2chan` connects them.
"""

import errno
import fcntl
import os
import time
from collections.abc import Callable
from pathlib import Path

from companion.config.actuators import PulseOutputSetting
from companion.config.board import pwm_channels
from companion.core.errors import HardwareError

ROOT = Path("/sys/class/pwm")
_TWO_CHANNELS = pwm_channels("")
CHANNELS = {  # by the name of the chip's device: channel of each pin
    "1f00098000.pwm": pwm_channels("Raspberry Pi 5"),  # Pi 5
    "fe20c000.pwm": _TWO_CHANNELS,  # Pi 4
    "3f20c000.pwm": _TWO_CHANNELS,  # Pi 2, 3 and Zero 2
    "2020c000.pwm": _TWO_CHANNELS,  # Pi 1 and Zero
}
_OVERLAY = "add dtoverlay=pwm-2chan,pin=12,func=4,pin2=13,func2=4 to /boot/firmware/config.txt"
_UDEV_S = 2.0  # udev hands the files of a channel to the group once it is exported
_LOOK_S = 0.02


class SysfsPulses:
    """Satisfies `companion.hal.interfaces.PulseOutput` on one exported channel."""

    def __init__(self, folder: Path, setting: PulseOutputSetting) -> None:
        """folder: the channel's, such as /sys/class/pwm/pwmchip0/pwm0.
        Raises OSError: a file cannot be written; BlockingIOError: another part has this channel.
        """
        self._folder = folder
        self._setting = setting
        self._width_ns = 0  # 0: no pulses
        self._duty = os.open(folder / "duty_cycle", os.O_RDWR)
        try:
            fcntl.flock(self._duty, fcntl.LOCK_EX | fcntl.LOCK_NB)
            self._set_up()
        except OSError:
            os.close(self._duty)
            raise

    def write_us(self, width_us: float) -> None:
        """Send pulses of this width, limited to the setting's.
        Raises HardwareError: closed, or the kernel refused.
        """
        width_ns = round(1e3 * self._setting.limited_us(width_us))
        if self._duty < 0:
            raise HardwareError(f"{self._folder}: written to after close")
        if width_ns == self._width_ns:
            return
        try:
            os.pwrite(self._duty, b"%d" % width_ns, 0)
            if not self._width_ns:
                _put(self._folder / "enable", 1)
        except OSError as error:
            raise HardwareError(f"{self._folder}: {error.strerror}") from error
        self._width_ns = width_ns

    def off(self) -> None:
        """No more pulses. Raises HardwareError: the kernel refused."""
        if self._duty < 0:
            return
        try:
            os.pwrite(self._duty, b"0", 0)
            _put(self._folder / "enable", 0)
        except OSError as error:
            raise HardwareError(f"{self._folder}: {error.strerror}") from error
        self._width_ns = 0

    def close(self) -> None:
        """No more pulses; the channel stays exported, with the owner that udev gave it."""
        if self._duty < 0:
            return
        try:
            self.off()
        finally:
            os.close(self._duty)
            self._duty = -1

    def _set_up(self) -> None:
        """Disabled, of normal polarity, with the period; whatever a killed program left behind."""
        if (
            _get(self._folder / "period") != "0"
        ):  # the kernel refuses a duty cycle above the period, and any with none
            os.pwrite(self._duty, b"0", 0)
            _put(self._folder / "enable", 0)
        _put(self._folder / "period", round(1e9 / self._setting.frequency_hz))
        if _get(self._folder / "polarity") != "normal":
            _put(self._folder / "polarity", "normal")


def find_channel(pin: int) -> tuple[Path, int]:
    """The chip's folder and the channel of a pin.
    Raises HardwareError: no chip of a Pi has this pin; the message says what to do.
    """
    for chip in sorted(ROOT.glob("pwmchip*")):
        pins = CHANNELS.get((chip / "device").resolve().name, {})
        if pin in pins and pins[pin] < int(_get(chip / "npwm")):
            return chip, pins[pin]
    if pin not in _TWO_CHANNELS:
        raise HardwareError(f"GPIO {pin} has no hardware PWM; expected 12, 13, 18 or 19")
    raise HardwareError(f"GPIO {pin}: no PWM in {ROOT}; {_OVERLAY} and reboot")


def open_sysfs_pulses(setting: PulseOutputSetting, wait: Callable[[float], None] = time.sleep) -> SysfsPulses:
    """Open the channel of the setting's pin, without pulses.
    Raises HardwareError: no such channel, no permission, or it is in use; the message says what to do.
    """
    chip, channel = find_channel(setting.pin)
    folder = chip / f"pwm{channel}"
    waited_s = 0.0
    while True:
        try:
            if not folder.exists():
                _export(chip, channel)
            return SysfsPulses(folder, setting)
        except BlockingIOError:
            raise HardwareError(
                f"GPIO {setting.pin}: its PWM channel {channel} is in use; "
                "before the Pi 5, GPIO 12 and 18 share one, and 13 and 19"
            ) from None
        except (PermissionError, FileNotFoundError) as error:
            if waited_s >= _UDEV_S:
                raise HardwareError(
                    f"GPIO {setting.pin}: {error.filename} may not be written; add the user to the group "
                    "gpio and the udev rule for /sys/class/pwm (`boat-companion install` writes it)"
                ) from None
        except OSError as error:
            raise HardwareError(f"GPIO {setting.pin}: {folder}: {error.strerror}") from error
        wait(_LOOK_S)
        waited_s += _LOOK_S


def _export(chip: Path, channel: int) -> None:
    try:
        _put(chip / "export", channel)
    except OSError as error:
        if error.errno != errno.EBUSY:  # exported by another program in this very moment
            raise


def replace_sysfs_pulses(pin: int, width_us: float) -> None:
    """From outside the program: give pulses another width, if there are any; 0: end them.
    Raises HardwareError, OSError: there is no such channel, or it cannot be written.
    """
    chip, channel = find_channel(pin)
    folder = chip / f"pwm{channel}"
    if not folder.exists() or _get(folder / "enable") == "0":
        return
    _put(folder / "duty_cycle", round(1e3 * width_us))
    if not width_us:
        _put(folder / "enable", 0)


def _get(file: Path) -> str:
    return file.read_text(encoding="ascii").strip()


def _put(file: Path, value: object) -> None:
    descriptor = os.open(file, os.O_WRONLY)
    try:
        os.pwrite(descriptor, str(value).encode(), 0)
    finally:
        os.close(descriptor)
