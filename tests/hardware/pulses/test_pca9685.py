"""PCA9685 by its registers, through the real smbus2."""

import threading
from pathlib import Path

import pytest
from twins.i2c import I2cDev, plug_in
from twins.lines import eventually
from twins.pins import PinBoard
from twins.pulses import Pca9685Twin

from companion.config.actuators import Pca9685Part, PulseOutputSetting
from companion.core.errors import HardwareError, SilentOutputsError
from companion.hal.pulses.pca9685 import (
    Pca9685Board,
    Pca9685Pulses,
    open_pca9685_pulses,
)
from companion.hal.pulses.pca9685_chip import Pca9685
from companion.hal.raspberry_pi import I2cBus

PART = Pca9685Part()
LEFT = PulseOutputSetting(output="pca9685", channel=0)
RIGHT = PulseOutputSetting(output="pca9685", channel=15)


@pytest.fixture
def chip() -> Pca9685Twin:
    return Pca9685Twin()


@pytest.fixture
def dev(monkeypatch: pytest.MonkeyPatch, tmp_path: Path, chip: Pca9685Twin) -> I2cDev:
    return plug_in(monkeypatch, tmp_path, {0x41: chip})


@pytest.fixture
def board(bus: I2cBus) -> Pca9685Board:
    return Pca9685Board(Pca9685(bus, PART))


def test_it_is_awake_with_every_output_off_and_at_the_frequency(bus: I2cBus, chip: Pca9685Twin) -> None:
    chip.put(0x00, b"\x21")  # another program has left pulses on
    chip.put(0x06, bytes([0, 0, 0x40, 0x01]))
    assert chip.width_us(0)
    Pca9685(bus, PART)
    assert chip.registers[0x00] == 0x20  # awake, no all-call
    assert chip.registers[0x01] == 0x04  # driven both ways, and low while OE is high (table 6)
    assert chip.frequency_hz == pytest.approx(50.0, rel=0.005)
    assert not any(chip.width_us(channel) for channel in range(16))


@pytest.mark.parametrize("frequency_hz", [50, 400])
@pytest.mark.parametrize("oscillator_hz", [23.5e6, 26.5e6])
@pytest.mark.parametrize("width_us", [1000.0, 1900.0])
def test_a_width_is_right_to_a_step_once_the_oscillator_is_known(
    bus: I2cBus, chip: Pca9685Twin, frequency_hz: int, oscillator_hz: float, width_us: float
) -> None:
    chip.oscillator_hz = oscillator_hz
    part = Pca9685Part(frequency_hz=frequency_hz, oscillator_hz=oscillator_hz)
    pca = Pca9685(bus, part)
    pca.write(3, pca.steps(width_us))
    assert bytes(chip.registers[0x12:0x14]) == bytes(2), "every pulse begins with the period"
    assert chip.width_us(3) == pytest.approx(width_us, abs=0.51e6 / (4096 * chip.frequency_hz))


def test_outputs_share_one_chip_and_close_it_with_the_last(dev: I2cDev, chip: Pca9685Twin) -> None:
    left, right = open_pca9685_pulses(LEFT, PART), open_pca9685_pulses(RIGHT, PART)
    left.write_us(1200.0)
    right.write_us(1800.0)
    eventually(lambda: chip.width_us(0) and chip.width_us(15))
    assert chip.width_us(0) == pytest.approx(1200.0, abs=3.0)
    left.close()
    left.close()
    eventually(lambda: not chip.width_us(0))
    assert chip.width_us(15) == pytest.approx(1800.0, abs=3.0)
    right.close()
    assert not chip.width_us(15)
    assert "PCA9685" not in {thread.name for thread in threading.enumerate()}
    with pytest.raises(HardwareError, match="channel 15: written to after close"):
        right.write_us(1500.0)
    again = open_pca9685_pulses(RIGHT, PART)
    again.close()


def test_only_changes_are_written_and_widths_are_limited(board: Pca9685Board, chip: Pca9685Twin) -> None:
    output = Pca9685Pulses(board, LEFT)
    for width_us in (1500.0, 1500.0, 400.0, 9999.0, float("nan")):
        output.write_us(width_us)
        board.step()
    assert [round(signal.width_us, -1) for signal in chip.history] == [1500.0, 1100.0, 1900.0, 1500.0]
    output.off()
    board.step()
    assert chip.width_us(0) == 0.0


def test_channels_side_by_side_are_one_transfer_and_less_than_a_step_is_none(
    board: Pca9685Board, chip: Pca9685Twin, monkeypatch: pytest.MonkeyPatch
) -> None:
    """On a bus of 10 kHz, as a BNO055 needs it, a transfer of one channel takes 5 ms."""
    lengths: list[int] = []
    put = chip.put

    def count(register: int, data: bytes) -> None:
        lengths.append(len(data))
        put(register, data)

    monkeypatch.setattr(chip, "put", count)
    settings = [PulseOutputSetting(output="pca9685", channel=channel) for channel in (*range(10), 15)]
    outputs = [Pca9685Pulses(board, setting) for setting in settings]
    for number, output in enumerate(outputs):
        output.write_us(1500.0 + 10.0 * number)
    board.step()
    assert lengths == [32, 8, 4]
    assert [round(chip.width_us(setting.channel), -1) for setting in settings] == [
        1500.0 + 10.0 * number for number in range(11)
    ]
    lengths.clear()
    outputs[0].write_us(1499.0)
    board.step()
    assert lengths == []
    outputs[1].write_us(1600.0)
    board.step()
    assert lengths == [4]


def test_a_write_that_is_lost_does_not_replace_a_later_one(board: Pca9685Board, chip: Pca9685Twin) -> None:
    output = Pca9685Pulses(board, LEFT)
    output.write_us(1500.0)
    chip.put = lambda register, data: _fail_once(chip, output)  # type: ignore[method-assign]
    board.step()
    board.step()
    assert chip.width_us(0) == pytest.approx(1100.0, abs=3.0)


def test_a_chip_that_runs_at_the_frequency_is_not_put_to_sleep(bus: I2cBus, chip: Pca9685Twin) -> None:
    Pca9685(bus, PART)
    assert chip.sleeps_while_running == 0, "it was asleep"
    chip.put(0x06, bytes([0, 0, 0x40, 0x01]))
    Pca9685(bus, PART)
    assert chip.sleeps_while_running == 0
    assert chip.width_us(0) == 0.0
    Pca9685(bus, Pca9685Part(frequency_hz=200))
    assert chip.frequency_hz == pytest.approx(200.0, rel=0.02)


def test_the_outputs_are_off_while_a_chip_does_not_answer(bus: I2cBus, chip: Pca9685Twin) -> None:
    chip.off()
    board = Pca9685Board(Pca9685(bus, PART), chip)
    output = Pca9685Pulses(board, LEFT)
    output.write_us(1900.0)
    board.step()
    assert chip.width_us(0) == pytest.approx(1900.0, abs=3.0)
    chip.lost = 5
    for _ in range(5):
        board.step()
    assert chip.is_oe_high
    with pytest.raises(SilentOutputsError) as caught:
        output.write_us(1500.0)
    assert caught.value.are_off
    chip.history.clear()
    board.step()
    assert [round(signal.width_us, -1) for signal in chip.history] == [1500.0], "not the old width first"
    board.close()
    assert chip.is_oe_high


def test_a_pin_that_fails_too_is_tried_again_and_its_outputs_are_not_called_off(
    bus: I2cBus, chip: Pca9685Twin, monkeypatch: pytest.MonkeyPatch
) -> None:
    board = Pca9685Board(Pca9685(bus, PART), chip)
    chip.lost = 10**6

    def fail() -> None:
        raise RuntimeError("lgpio.error: GPIO busy")

    with monkeypatch.context() as patched:
        patched.setattr(chip, "off", fail)
        for _ in range(2):
            board.step()
        for _ in range(2):
            with pytest.raises(RuntimeError):
                board.step()
        with pytest.raises(SilentOutputsError) as caught:
            board.check()
        assert not caught.value.are_off
    board.step()
    assert chip.is_oe_high
    with pytest.raises(SilentOutputsError) as caught:
        board.check()
    assert caught.value.are_off


def test_the_outputs_are_off_while_a_chip_is_set_up_again(
    bus: I2cBus, chip: Pca9685Twin, monkeypatch: pytest.MonkeyPatch
) -> None:
    watched = Pca9685Board(Pca9685(bus, PART), chip)
    levels: list[bool] = []
    set_up = Pca9685.set_up

    def look(part: Pca9685) -> None:
        levels.append(chip.is_oe_high)
        set_up(part)

    monkeypatch.setattr(Pca9685, "set_up", look)
    chip.put(0x00, b"\x30")
    chip.put(0xFE, b"\x10")  # another program's frequency
    watched.step()
    assert levels == [True]
    assert not chip.is_oe_high


def test_the_outputs_are_enabled_once_they_are_off_and_disabled_without_a_chip(
    dev: I2cDev, chip: Pca9685Twin, monkeypatch: pytest.MonkeyPatch
) -> None:
    pins, part = PinBoard(), Pca9685Part(output_enable=4)
    monkeypatch.setattr("gpiozero.Device.pin_factory", pins.factory)
    monkeypatch.setattr("companion.hal.pulses.pca9685._enables", {})
    pin = pins.pin(4)
    pin.pull = "up"  # the resistor at OE
    chip.lost = 1
    with pytest.raises(HardwareError, match="no answer"):
        open_pca9685_pulses(LEFT, part)
    assert (pin.function, pin.state) == ("output", True), "a resistor to ground must not let it out"
    output = open_pca9685_pulses(LEFT, part)
    assert (pin.function, pin.state) == ("output", False)
    output.close()
    assert (pin.function, pin.state) == ("output", True)
    assert not any(signal.width_us for signal in chip.history)


def _fail_once(chip: Pca9685Twin, output: Pca9685Pulses) -> None:
    del chip.put
    output.write_us(1100.0)  # the boat, while the thread waits for the bus
    raise OSError(121, "Remote I/O error")


def test_a_chip_that_does_not_answer_is_an_error_of_every_write_until_it_does(
    board: Pca9685Board, chip: Pca9685Twin, caplog: pytest.LogCaptureFixture
) -> None:
    output = Pca9685Pulses(board, LEFT)
    output.write_us(1500.0)
    chip.lost = 9
    for _ in range(9):
        board.step()
    for width_us in (1500.0, 1200.0):
        with pytest.raises(HardwareError, match=r"PCA9685: no answer on the I²C bus: .*121"):
            output.write_us(width_us)
    board.step()
    output.write_us(1200.0)
    assert chip.width_us(0) == pytest.approx(1200.0, abs=3.0)
    assert len([line for line in caplog.messages if "no answer" in line]) == 1


def test_a_dip_of_the_supply_leaves_it_off_until_its_users_were_told(
    board: Pca9685Board, chip: Pca9685Twin, caplog: pytest.LogCaptureFixture
) -> None:
    left, right = Pca9685Pulses(board, LEFT), Pca9685Pulses(board, RIGHT)
    left.write_us(1900.0)
    right.write_us(1900.0)
    board.step()
    chip.power_up()
    board.step()
    assert chip.frequency_hz == pytest.approx(50.0, rel=0.005)
    assert not chip.width_us(0)
    for output in (left, right):
        with pytest.raises(HardwareError, match="its supply dipped"):
            output.write_us(1900.0)
        output.write_us(1500.0)
    board.step()
    assert chip.width_us(0) == chip.width_us(15) == pytest.approx(1500.0, abs=3.0)
    assert "PCA9685: its supply dipped; all its signals are off until they are set again" in caplog.messages
