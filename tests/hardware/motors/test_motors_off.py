"""What stops the motors of a killed program, for every driver."""

import os
import shlex
from pathlib import Path

import pytest
from twins.i2c import I2cDev, plug_in
from twins.pulses import FRESH, PI_4, PI_5, KernelPwm, Pca9685Twin, plug_in_pwm

from companion.app.motors_off import main

RUNNING = {**FRESH, "period": "20000000", "duty_cycle": "1900000", "enable": "1"}
BRIDGES = {
    "l298n": "12,13",
    "tb6612": "12,13",
    "bts7960": "12,13",
    "drv8833": "17,27,20,21",
}


@pytest.fixture
def pinctrl(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    """A pinctrl that notes how it was called."""
    folder, record = tmp_path / "bin", tmp_path / "calls"
    folder.mkdir()
    program = folder / "pinctrl"
    program.write_text(f'#!/bin/sh\necho "$@" >> {shlex.quote(str(record))}\n', encoding="utf-8")
    program.chmod(0o755)
    monkeypatch.setenv("PATH", f"{folder}{os.pathsep}{os.environ['PATH']}")
    record.touch()
    return record


@pytest.fixture
def waits(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    waits: list[float] = []
    monkeypatch.setattr("companion.app.motors_off.sleep", waits.append)
    return waits


def run(tmp_path: Path, text: str) -> int:
    boat = tmp_path / "boat.toml"
    boat.write_text(text, encoding="utf-8")
    return main([str(boat)])


@pytest.mark.parametrize(("driver", "pins"), BRIDGES.items())
def test_a_bridge_gets_the_pins_low_that_stop_it(
    pinctrl: Path, tmp_path: Path, driver: str, pins: str
) -> None:
    assert (
        run(tmp_path, f'parts.motors = {{driver = "{driver}", left_forward = 17, left_backward = 27}}') == 0
    )
    assert pinctrl.read_text(encoding="utf-8") == f"set {pins} op dl\n"


def test_a_file_that_cannot_be_read_stands_for_the_default_pins(
    pinctrl: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(tmp_path, "parts.motors = 3") == 2
    assert pinctrl.read_text(encoding="utf-8") == "set 12,13 op dl\n"
    assert "taking the default pins" in capsys.readouterr().err


@pytest.mark.parametrize(("driver", "pins"), [("l298n", "12"), ("drv8833", "17,27")])
def test_the_right_pins_of_a_boat_with_one_motor_belong_to_others(
    pinctrl: Path, tmp_path: Path, driver: str, pins: str
) -> None:
    motors = f'parts.motors = {{driver = "{driver}", left_forward = 17, left_backward = 27}}'
    assert run(tmp_path, f'{motors}\ndrive.layout = "rudder"') == 0
    assert pinctrl.read_text(encoding="utf-8") == f"set {pins} op dl\n"


@pytest.mark.parametrize("chips", [PI_4, PI_5])
def test_speed_controllers_on_the_pis_pwm_get_neutral_and_then_no_pulses(
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
    pinctrl: Path,
    waits: list[float],
    chips: dict[str, tuple[str, int]],
) -> None:
    kernel = plug_in_pwm(monkeypatch, tmp_path, chips)
    chip = kernel.root / ("pwmchip0" if chips is PI_4 else "pwmchip2")
    for channel in (0, 1):
        kernel.export(chip, channel, RUNNING)
    assert run(tmp_path, 'parts.motors = {driver = "esc", right = {pin = 13, trim_us = 1480}}') == 0
    left, right = f"{chip.name}/pwm0", f"{chip.name}/pwm1"
    ended = [(signal.output, signal.width_us) for signal in kernel.history]
    assert ended == [(left, 1500.0), (right, 1480.0), (left, 0.0), (right, 0.0)]
    assert waits == [pytest.approx(0.06)]
    assert kernel.channel(chip.name, 1) == {**RUNNING, "duty_cycle": "0", "enable": "0"}
    assert pinctrl.read_text(encoding="utf-8") == "", "the pin would lose its PWM until the next boot"


def test_speed_controllers_on_a_pca9685_get_neutral_and_then_no_pulses(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, waits: list[float]
) -> None:
    chip = Pca9685Twin()
    plug_in(monkeypatch, tmp_path, {0x41: chip})
    chip.put(0x00, b"\x31")
    chip.put(0xFE, bytes([121]))
    chip.put(0x00, b"\x21")
    for channel in (2, 3, 7):
        chip.put(0x06 + 4 * channel, bytes([0, 0, 0x85, 0x01]))
    chip.history.clear()
    left, right = (f'{{output = "pca9685", channel = {channel}}}' for channel in (2, 3))
    assert run(tmp_path, f'parts.motors = {{driver = "esc", left = {left}, right = {right}}}') == 0
    assert [(signal.output, round(signal.width_us, -1)) for signal in chip.history] == [
        ("channel 2", 1500.0),
        ("channel 3", 1500.0),
        ("channel 2", 0.0),
        ("channel 3", 0.0),
        ("channel 7", 0.0),
    ]
    assert waits == [pytest.approx(0.06)]


@pytest.mark.parametrize("answers", [True, False])
def test_oe_of_a_pca9685_is_driven_high_whether_or_not_its_bus_answers(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, pinctrl: Path, waits: list[float], answers: bool
) -> None:
    chip = Pca9685Twin()
    chip.put(0x00, b"\x20")  # the killed program has set it up
    plug_in(monkeypatch, tmp_path, {0x41: chip} if answers else {})
    left, right = (f'{{output = "pca9685", channel = {channel}}}' for channel in (2, 3))
    motors = f'parts.motors = {{driver = "esc", left = {left}, right = {right}}}'
    assert run(tmp_path, f"{motors}\nparts.pca9685.output_enable = 22") == 0
    assert pinctrl.read_text(encoding="utf-8") == "set 22 op dh\n"
    pinctrl.parent.joinpath("bin", "pinctrl").unlink()
    assert run(tmp_path, f"{motors}\nparts.pca9685.output_enable = 22") == 1, "OE may be low"


def test_one_signal_that_cannot_be_ended_does_not_keep_the_other_running(
    kernel: KernelPwm, dev: I2cDev, tmp_path: Path, waits: list[float], capsys: pytest.CaptureFixture[str]
) -> None:
    kernel.export(kernel.root / "pwmchip0", 0, RUNNING)
    text = 'parts.motors = {driver = "esc", left = {output = "pca9685"}, right = {pin = 12}}'
    assert run(tmp_path, text) == 1
    assert kernel.channel("pwmchip0", 0)["enable"] == "0"
    told = capsys.readouterr().err
    assert "motors_off: PCA9685: no answer at I²C address 0x41" in told
    assert told.endswith("motors_off: a motor may still be running: switch the boat off\n")


def test_winches_stop_and_relays_are_switched_off_whatever_the_motors_are(
    kernel: KernelPwm, tmp_path: Path, pinctrl: Path, waits: list[float]
) -> None:
    for channel in (0, 1):
        kernel.export(kernel.root / "pwmchip0", channel, RUNNING)
    payload = """
    payload = [
        {kind = "relay", number = 0, pin = 17},
        {kind = "horn", number = 1, pin = 27, active_low = true},
        {kind = "winch", number = 1, out_pin = 23, in_pin = 26},
        {kind = "winch", number = 2, signal = {pin = 13}},
        {kind = "servo", number = 9, signal = {pin = 12}},
    ]"""
    assert run(tmp_path, payload) == 0
    assert pinctrl.read_text(encoding="utf-8") == "set 17,23,26 op dl\nset 27 op dh\n"
    ended = [(signal.output, signal.width_us) for signal in kernel.history]
    assert ended == [("pwmchip0/pwm1", 1500.0), ("pwmchip0/pwm1", 0.0)]
    assert waits == [pytest.approx(0.06)]
