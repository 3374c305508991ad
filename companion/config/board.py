"""What the computer offers to parts: the pins of a Raspberry Pi's header, what they are besides inputs and
outputs, and I²C buses.

Pins are BCM numbers. Data sheets BCM2835 (table 6-31), BCM2711 and RP1 (alternate functions); README of the
kernel's overlays for UARTs, PWM and 1-wire; Raspberry Pi documentation, "Configure UARTs", for /dev/serial0.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Final

from msgspec import Meta

MODEL: Final = Path("/proc/device-tree/model")

Pin = Annotated[int, Meta(ge=0, le=27)]
OptionalPin = Annotated[int, Meta(ge=-1, le=27)]
"""−1: not wired."""
I2cBus = Annotated[int, Meta(ge=0, le=255)] | Annotated[str, Meta(pattern="^/dev/")]
"""Its number, or its device."""

PULLED_UP: Final = range(9)
"""High from reset until a program sets them."""
ONE_WIRE: Final = 4
"""Of dtoverlay=w1-gpio as it is."""
HEADER_I2C: Final = "/dev/i2c-1"
"""On header pins 3 and 5 of every Pi with 40 pins."""
I2C_PINS: Final[Mapping[str, tuple[int, ...]]] = {"/dev/i2c-0": (0, 1), HEADER_I2C: (2, 3)}
"""SDA and SCL by bus; those of other buses are in config.txt."""

_BEFORE_PI_4: Final = ("Raspberry Pi Zero", "Raspberry Pi Model", "Raspberry Pi 2", "Raspberry Pi 3")
_PWM: Final[Mapping[int, int]] = {12: 0, 18: 0, 13: 1, 19: 1}
_PWM_OF_PI_5: Final[Mapping[int, int]] = {12: 0, 13: 1, 18: 2, 19: 3}
_MAIN_UART: Final[Mapping[str, tuple[int, ...]]] = {  # the only one on the header before the Pi 4
    "/dev/serial0": (14, 15),
    "/dev/ttyS0": (14, 15),
    "/dev/ttyAMA0": (14, 15),
}
_UARTS_OF_PI_4: Final[Mapping[str, tuple[int, ...]]] = {
    **_MAIN_UART,
    "/dev/ttyAMA2": (0, 1),
    "/dev/ttyAMA3": (4, 5),
    "/dev/ttyAMA4": (8, 9),
    "/dev/ttyAMA5": (12, 13),
}
_UARTS_OF_PI_5: Final[Mapping[str, tuple[int, ...]]] = {  # there /dev/serial0 is the debug connector
    "/dev/ttyAMA0": (14, 15),
    "/dev/ttyAMA1": (0, 1),
    "/dev/ttyAMA2": (4, 5),
    "/dev/ttyAMA3": (8, 9),
    "/dev/ttyAMA4": (12, 13),
}


def read_model(path: Path = MODEL) -> str:
    """The name of this machine's model, such as `Raspberry Pi 4 Model B Rev 1.4`; empty if it has none."""
    try:
        return path.read_text(encoding="utf-8", errors="replace").rstrip("\0\n")
    except OSError:
        return ""


def is_pi_5(model: str) -> bool:
    """Whether the pins are those of a Pi 5, also as a Pi 500 or a Compute Module 5."""
    return "Raspberry Pi 5" in model or "Compute Module 5" in model


def pwm_channels(model: str) -> Mapping[int, int]:
    return _PWM_OF_PI_5 if is_pi_5(model) else _PWM


def uart_pins(device: str, model: str) -> tuple[int, ...]:
    """TX and RX of a UART of the header, as its overlay has them. An unknown model stands for a Pi 4."""
    return _uarts(model).get(device, ())


def uart_on(pins: tuple[int, ...], model: str) -> str:
    """The device of the UART on these pins; empty without one."""
    return next((device for device, of in _uarts(model).items() if of == pins), "")


def _uarts(model: str) -> Mapping[str, tuple[int, ...]]:
    if is_pi_5(model):
        return _UARTS_OF_PI_5
    return _MAIN_UART if any(name in model for name in _BEFORE_PI_4) else _UARTS_OF_PI_4


def is_main_uart(device: str) -> bool:
    """Whether a device may be the UART that the system's console uses as delivered."""
    return device in _MAIN_UART


def i2c_device(bus: int | str) -> str:
    return bus if isinstance(bus, str) else f"/dev/i2c-{bus}"
