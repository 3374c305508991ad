"""The clock, the I2C bus and the kernel's PWM below the drivers."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from companion.hal.raspberry_pi import I2cBus, open_i2c
from twins.i2c import I2cDev, plug_in
from twins.lines import HandClock
from twins.pulses import PI_4, KernelPwm, plug_in_pwm


@pytest.fixture
def clock() -> HandClock:
    return HandClock()


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
