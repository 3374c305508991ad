"""Hardware PWM over a twin of the kernel's files."""

import errno
from collections.abc import Iterator
from pathlib import Path

import pytest
from twins.pulses import FRESH, PI_4, PI_5, PI_5_NEW_KERNEL, KernelPwm, plug_in_pwm

from companion.config.actuators import PulseOutputSetting
from companion.core.errors import HardwareError
from companion.hal.pulses.sysfs_pwm import (
    SysfsPulses,
    find_channel,
    open_sysfs_pulses,
    replace_sysfs_pulses,
)

SETTING = PulseOutputSetting(pin=12)
CHIP = "pwmchip0"


@pytest.fixture
def output(kernel: KernelPwm) -> Iterator[SysfsPulses]:
    output = open_sysfs_pulses(SETTING)
    yield output
    kernel.fails_with = 0
    output.close()


@pytest.mark.parametrize(
    ("chips", "pin", "expected"),
    [
        (PI_4, 19, ("pwmchip0", 1)),
        (PI_5, 18, ("pwmchip2", 2)),
        (PI_5_NEW_KERNEL, 19, ("pwmchip0", 3)),
        ({"pwmchip0": ("3f20c000.pwm", 2)}, 18, ("pwmchip0", 0)),
    ],
)
def test_the_chip_is_found_by_its_device_whatever_its_number(
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
    chips: dict[str, tuple[str, int]],
    pin: int,
    expected: tuple[str, int],
) -> None:
    plug_in_pwm(monkeypatch, tmp_path, chips)
    chip, channel = find_channel(pin)
    assert (chip.name, channel) == expected


def test_widths_are_nanoseconds_and_limited(kernel: KernelPwm, output: SysfsPulses) -> None:
    for width_us in (1500.0, 1234.5678, 400.0, 2600.0, float("nan")):
        output.write_us(width_us)
    assert [signal.width_us for signal in kernel.history] == [1500.0, 1234.568, 1100.0, 1900.0, 1500.0]


def test_close_ends_the_pulses_and_may_be_called_twice(kernel: KernelPwm) -> None:
    output = open_sysfs_pulses(SETTING)
    output.write_us(1600.0)
    output.close()
    output.close()
    output.off()
    assert kernel.channel(CHIP, 0)["enable"] == kernel.channel(CHIP, 0)["duty_cycle"] == "0"
    with pytest.raises(HardwareError, match="after close"):
        output.write_us(1500.0)
    open_sysfs_pulses(SETTING).close()


@pytest.mark.parametrize("polarity", ["normal", "inversed"])
def test_what_a_killed_program_left_running_is_stopped_at_open(kernel: KernelPwm, polarity: str) -> None:
    left = {"period": "2500000", "duty_cycle": "1900000", "enable": "1", "polarity": polarity}
    kernel.export(kernel.root / CHIP, 0, left)
    open_sysfs_pulses(SETTING).close()
    assert kernel.channel(CHIP, 0) == {**FRESH, "period": "20000000"}


@pytest.mark.parametrize("name", ["export", "duty_cycle", "enable"])
def test_missing_permission_says_what_to_do(kernel: KernelPwm, name: str) -> None:
    kernel.denied.add(name)
    if name == "enable":  # opened only where something has to be stopped
        kernel.export(kernel.root / CHIP, 0, {**FRESH, "period": "20000000"})
    waits: list[float] = []
    with pytest.raises(HardwareError, match=rf"GPIO 12: .*/{name} may not .* group gpio and the udev rule"):
        open_sysfs_pulses(SETTING, waits.append)
    assert 1.5 < sum(waits) < 3.0


@pytest.mark.parametrize(
    ("pin", "message"),
    [(5, "GPIO 5 has no hardware PWM; expected 12, 13, 18 or 19"), (12, "dtoverlay=pwm-2chan")],
)
def test_a_pi_without_the_overlay_is_told_the_line(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, pin: int, message: str
) -> None:
    plug_in_pwm(monkeypatch, tmp_path, {"pwmchip0": ("107d517a80.pwm", 2)})
    with pytest.raises(HardwareError, match=message):
        open_sysfs_pulses(PulseOutputSetting(pin=pin))


def test_a_kernel_that_refuses_is_an_error_and_the_next_write_tries_again(
    kernel: KernelPwm, output: SysfsPulses
) -> None:
    output.write_us(1500.0)
    kernel.fails_with = errno.EIO
    for _ in range(2):
        with pytest.raises(HardwareError, match=r"pwm0: Input/output error"):
            output.write_us(1600.0)
    with pytest.raises(HardwareError, match=r"pwm0: Input/output error"):
        output.off()
    kernel.fails_with = 0
    output.write_us(1600.0)
    assert [signal.width_us for signal in kernel.history] == [1500.0, 1600.0]


def test_running_pulses_are_replaced_and_ended_from_outside(kernel: KernelPwm) -> None:
    replace_sysfs_pulses(12, 1500.0)  # not exported: there are none
    output = open_sysfs_pulses(SETTING)
    replace_sysfs_pulses(12, 1500.0)
    output.write_us(1700.0)
    for width_us in (1500.0, 0.0, 1500.0):
        replace_sysfs_pulses(12, width_us)
    assert [signal.width_us for signal in kernel.history] == [1700.0, 1500.0, 0.0]
    assert kernel.channel(CHIP, 0)["enable"] == kernel.channel(CHIP, 0)["duty_cycle"] == "0"
    output.close()
