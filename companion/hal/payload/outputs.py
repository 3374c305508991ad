"""Outputs of the payload: servo signals, pins, and the two inputs of a winch's bridge."""

import time
from collections.abc import Iterator
from contextlib import ExitStack, closing, contextmanager
from typing import Any

from companion.config.actuators import Pca9685Part, PulseOutputSetting
from companion.config.payload import (
    CommandPayload,
    GripperPayload,
    PayloadSetting,
    RelayPayload,
    ServoPayload,
    WinchPayload,
)
from companion.core.errors import HardwareError
from companion.hal.interfaces import PayloadOutput, PulseOutput
from companion.hal.pulses.opening import open_pulse_output
from companion.hal.raspberry_pi import opening_pins

_TRAVEL_S = 0.5  # a servo's way to its last position, 60° in 0.2 s at most
_DEBOUNCE_S = 0.002  # of a reed switch


@contextmanager
def _reporting(part: str) -> Iterator[None]:
    """Any error of a library becomes a HardwareError with the part's name."""
    try:
        yield
    except HardwareError:
        raise
    except Exception as error:
        raise HardwareError(f"{part}: {' '.join(str(error).split())}") from error


class ServoOutput:
    """Pulse widths in µs, 0 without pulses. end_us: the last position, 0 for none."""

    def __init__(self, pulses: PulseOutput, end_us: float = 0.0) -> None:
        self._pulses = pulses
        self._end_us = end_us
        self._is_closed = False

    def write(self, value: float) -> None:
        if value:
            self._pulses.write_us(value)
        else:
            self._pulses.off()

    def close(self) -> None:
        """Go to the last position, then release the output. May be called twice."""
        if self._is_closed:
            return
        self._is_closed = True
        with closing(self._pulses):
            if self._end_us:
                self._pulses.write_us(self._end_us)
                time.sleep(_TRAVEL_S)


class ShareOutput:
    """A continuous servo: shares of full speed."""

    def __init__(self, pulses: PulseOutput, signal: PulseOutputSetting) -> None:
        self._pulses = pulses
        self._signal = signal

    def write(self, value: float) -> None:
        self._pulses.write_us(self._signal.width_us(value))

    def close(self) -> None:
        self._pulses.close()


class PayloadPin:
    """A pin: 1 is on. device: gpiozero's output."""

    def __init__(self, device: Any, title: str) -> None:  # noqa: ANN401  untyped library
        self._device = device
        self._title = title

    def write(self, value: float) -> None:
        with _reporting(self._title):
            self._device.value = int(value > 0.5)

    def close(self) -> None:
        """Off, then an input. May be called twice."""
        if not self._device.closed:
            with closing(self._device):
                self._device.off()


class BridgeOutput:
    """The two inputs of a bridge: the sign of a share is the direction. The opposite input is off first."""

    def __init__(self, outward: Any, inward: Any, title: str) -> None:  # noqa: ANN401  untyped library
        self._outward = outward
        self._inward = inward
        self._title = title

    def write(self, value: float) -> None:
        with _reporting(self._title):
            if value <= 0.0:
                self._outward.off()
            if value >= 0.0:
                self._inward.off()
            if value > 0.0:
                self._outward.on()
            elif value < 0.0:
                self._inward.on()

    def close(self) -> None:
        with ExitStack() as rest:
            for device in (self._outward, self._inward):
                rest.callback(device.close)
                if not device.closed:
                    rest.callback(device.off)


class PinCounter:
    """Counts the closings of a switch to ground, in the thread of gpiozero."""

    def __init__(self, device: Any) -> None:  # noqa: ANN401  untyped library
        self.count = 0
        self._device = device
        device.when_activated = self._count

    def _count(self) -> None:
        self.count += 1

    def close(self) -> None:
        self._device.close()


def open_output(setting: PayloadSetting, chip: Pca9685Part) -> PayloadOutput:
    """Open the output of a payload, in its safe state.
    Raises HardwareError: it cannot be opened; the message says what to do.
    """
    match setting:
        case RelayPayload():
            return _open_pin(setting, setting.pin, is_on=setting.start == "on")
        case GripperPayload() if setting.pin is not None:
            return _open_pin(setting, setting.pin, is_on=setting.start == "closed")
        case WinchPayload() if setting.out_pin is not None:
            with opening_pins(setting.title) as gpiozero, ExitStack() as undo:
                outward = undo.enter_context(closing(gpiozero.OutputDevice(setting.out_pin)))
                inward = undo.enter_context(closing(gpiozero.OutputDevice(setting.in_pin)))
                undo.pop_all()
            return BridgeOutput(outward, inward, setting.title)
        case WinchPayload():
            return ShareOutput(open_pulse_output(setting.signal, chip), setting.signal)
        case ServoPayload():
            end_us = 0.0 if setting.at_end == "off" else float(setting.at_end)
            return ServoOutput(open_pulse_output(setting.signal, chip), end_us)
        case GripperPayload():
            return ServoOutput(open_pulse_output(setting.signal, chip))
        case CommandPayload():
            raise AssertionError("a command has no output")


def _open_pin(setting: RelayPayload | GripperPayload, pin: int, *, is_on: bool) -> PayloadPin:
    with opening_pins(setting.title) as gpiozero:
        device = gpiozero.OutputDevice(pin, active_high=not setting.active_low, initial_value=is_on)
        return PayloadPin(device, setting.title)


def open_counter(setting: WinchPayload) -> PinCounter | None:
    """Open the switch that measures a winch's line; None without one.
    Raises HardwareError: the pin cannot be opened.
    """
    if setting.count_pin is None:
        return None
    with opening_pins(setting.title) as gpiozero:
        return PinCounter(
            gpiozero.DigitalInputDevice(setting.count_pin, pull_up=True, bounce_time=_DEBOUNCE_S)
        )
