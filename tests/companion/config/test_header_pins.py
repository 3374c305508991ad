"""The pins of the models are those of the page of the first day, and of the kernel's overlays."""

import re
from pathlib import Path

import pytest

from companion.config.board import is_main_uart, pwm_channels, uart_pins

PAGE = (Path(__file__).parents[3] / "docs" / "first-day.md").read_text(encoding="utf-8")
MODELS = (
    "Raspberry Pi Zero 2 W Rev 1.0",
    "Raspberry Pi 3 Model B",
    "Raspberry Pi 4 Model B",
    "Raspberry Pi 5",
)


def row(title: str) -> list[tuple[str, str]]:
    """Models and their cells."""
    (found,) = re.findall(rf"^\| {re.escape(title)} \| (.*) \|$", PAGE, re.MULTILINE)
    return list(zip(MODELS, (cell.strip(" `") for cell in str(found).split("|")), strict=True))


@pytest.mark.parametrize(("model", "gnss"), row("GNSS on GPIO 15: `parts.gnss.port`"))
def test_the_receiver_of_the_page_is_on_gpio_14_and_15(model: str, gnss: str) -> None:
    assert uart_pins(gnss, model) == (14, 15)
    assert is_main_uart(gnss)


@pytest.mark.parametrize(("model", "rc"), row("RC receiver: `rc.port`"))
def test_the_transmitters_receiver_of_the_page_is_on_gpio_9(model: str, rc: str) -> None:
    assert uart_pins(rc, model) == ((8, 9) if rc.startswith("/dev/ttyAMA") else ())


@pytest.mark.parametrize(("model", "pins"), row("PWM pins with a channel each"))
def test_the_pwm_pins_of_the_page_have_a_channel_each(model: str, pins: str) -> None:
    numbers = [int(pin) for pin in pins.split(",")]
    channels = pwm_channels(model)
    assert len({channels[pin] for pin in numbers}) == len(numbers) == len(set(channels.values()))
