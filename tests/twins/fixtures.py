"""The clock, a serial line, the I2C bus, lgpio and the kernel's PWM below the drivers."""

import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from companion.hal.raspberry_pi import I2cBus, open_i2c
from twins.i2c import I2cDev, plug_in
from twins.lines import HandClock, MemoryLine, PtyLine
from twins.pulses import PI_4, KernelPwm, LgpioTwin, plug_in_pwm


@pytest.fixture
def clock() -> HandClock:
    return HandClock()


@pytest.fixture
def wire() -> MemoryLine:
    return MemoryLine()


@pytest.fixture
def line(tmp_path: Path) -> Iterator[PtyLine]:
    line = PtyLine(tmp_path / "uart")
    yield line
    line.unplug()


@pytest.fixture
def lgpio(monkeypatch: pytest.MonkeyPatch) -> LgpioTwin:
    twin = LgpioTwin({0: "pinctrl-bcm2711", 1: "raspberrypi-exp-gpio"})
    monkeypatch.setitem(sys.modules, "lgpio", twin)
    return twin


@pytest.fixture
def dev(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> I2cDev:
    return plug_in(monkeypatch, tmp_path, {})


@pytest.fixture
def bus(dev: I2cDev) -> Iterator[I2cBus]:
    bus = open_i2c("test")
    yield bus
    bus.close()


@pytest.fixture
def kernel(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> KernelPwm:
    return plug_in_pwm(monkeypatch, tmp_path, PI_4)
