"""Outputs of the payload over mock pins that record every change, and over the kernel's PWM files."""

from collections.abc import Iterator

import gpiozero
import pytest
from twins.lines import known, opened
from twins.pins import PinBoard
from twins.pulses import KernelPwm

from companion.app.hardware import begin_payload
from companion.config.actuators import Pca9685Part, PulseOutputSetting
from companion.config.boat_config import BoatConfig, decode_config
from companion.config.payload import RelayPayload, ServoPayload, WinchPayload
from companion.core.errors import HardwareError
from companion.hal.payload.outputs import open_counter, open_output

CHIP = Pca9685Part()
OUT, IN = 17, 27


@pytest.fixture
def pins(monkeypatch: pytest.MonkeyPatch) -> Iterator[PinBoard]:
    board = PinBoard()
    monkeypatch.setattr(gpiozero.Device, "pin_factory", board.factory)
    yield board
    board.factory.reset()


def test_a_relay_follows_and_is_off_and_an_input_after_the_end(pins: PinBoard) -> None:
    relay = open_output(RelayPayload(number=0, pin=17), CHIP)
    relay.write(1.0)
    relay.write(0.0)
    relay.write(1.0)
    assert pins.drain() == [(17, 1), (17, 0), (17, 1)]
    relay.close()
    relay.close()
    assert pins.drain()[0] == (17, 0)
    assert pins.pin(17).function == "input"


def test_an_active_low_relay_is_high_from_the_start(pins: PinBoard) -> None:
    relay = open_output(RelayPayload(number=0, pin=17, active_low=True), CHIP)
    assert pins.pin(17).state == 1
    relay.write(1.0)
    assert pins.pin(17).state == 0
    relay.close()
    assert (17, 1) in pins.drain()


def test_a_winch_counts_the_pulses_of_its_switch(pins: PinBoard) -> None:
    setting = WinchPayload(out_pin=OUT, in_pin=IN, count_pin=22, pulse_m=0.25, line_m=5.0)
    counter = known(open_counter(setting))
    switch = pins.pin(22)
    switch.drive_low()
    switch.drive_high()
    switch.drive_low()
    assert counter.count == 2
    counter.close()


def test_a_servo_gets_pulses_only_after_its_first_command(
    kernel: KernelPwm, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("companion.hal.payload.outputs._TRAVEL_S", 0.0)
    setting = ServoPayload(number=9, signal=PulseOutputSetting(pin=12), at_end=1200)
    servo = open_output(setting, CHIP)
    assert not [signal for signal in kernel.history if signal.width_us]
    servo.write(0.0)
    assert not [signal for signal in kernel.history if signal.width_us]
    servo.write(1700.0)
    assert kernel.history[-1].width_us == pytest.approx(1700.0)
    servo.close()
    widths = [signal.width_us for signal in kernel.history]
    assert 1200.0 in [pytest.approx(width) for width in widths]
    assert not widths[-1]


def test_a_continuous_servo_is_at_rest_when_the_winch_stops(kernel: KernelPwm) -> None:
    winch = open_output(WinchPayload(signal=PulseOutputSetting(pin=13, reversed=True)), CHIP)
    winch.write(1.0)
    assert kernel.history[-1].width_us == pytest.approx(1100.0)
    winch.write(0.0)
    assert kernel.history[-1].width_us == pytest.approx(1500.0)
    winch.close()
    assert not kernel.history[-1].width_us


def config(*payload: dict[str, object]) -> BoatConfig:
    return decode_config({"payload": list(payload)}, "test")


def test_parts_are_opened_by_their_table_whichever_fails(pins: PinBoard) -> None:
    parts = begin_payload(
        config(
            {"kind": "relay", "number": 0, "pin": 17},
            {"kind": "command", "number": 1, "run": ["/bin/true"]},
            {"kind": "winch", "out_pin": 23, "in_pin": 26, "count_pin": 13},
            {"kind": "servo", "number": 9, "signal": {"output": "hardware", "pin": 4}},
        ),
        opened,
    )
    assert (sorted(parts.outputs), sorted(parts.programs), sorted(parts.counters)) == ([0, 2, 3], [1], [2])
    parts.outputs[0].write(1.0)
    parts.outputs[2].write(1.0)
    assert pins.drain()[-2:] == [(17, 1), (23, 1)]
    with pytest.raises(HardwareError, match="servo 9: GPIO 4"):
        parts.outputs[3].write(1500.0)
    parts.close()
    parts.close()
    assert pins.pin(17).function == pins.pin(23).function == "input"


def test_a_winch_without_its_counter_does_not_run(pins: PinBoard) -> None:
    taken = gpiozero.DigitalInputDevice(13)
    winch = {"kind": "winch", "out_pin": 23, "in_pin": 26, "count_pin": 13}
    parts = begin_payload(config(winch), opened)
    with pytest.raises(HardwareError, match="winch 1"):
        parts.outputs[0].write(1.0)
    assert pins.pin(23).function == "input"
    taken.close()
