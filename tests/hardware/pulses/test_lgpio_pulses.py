"""Software pulses over a twin of lgpio."""

import pytest
from twins.pulses import LgpioTwin

from companion.config.actuators import PulseOutputSetting
from companion.core.errors import HardwareError
from companion.hal.pulses.lgpio_pulses import LgpioPulses, open_lgpio_pulses

SETTING = PulseOutputSetting(output="software", pin=22)


def widths(lgpio: LgpioTwin) -> list[float]:
    return [signal.width_us for signal in lgpio.history]


@pytest.mark.parametrize(
    "chips",
    [
        {0: "gpio-brcmstb@107d508500", 1: "gpio-brcmstb@107d517c00", 4: "pinctrl-rp1"},  # Pi 5, older kernel
        {0: "pinctrl-rp1", 10: "gpio-brcmstb@107d508500"},
        {0: "pinctrl-bcm2835"},
    ],
)
def test_the_chip_of_the_header_is_found_by_its_label(lgpio: LgpioTwin, chips: dict[int, str]) -> None:
    lgpio.chips = chips
    output = open_lgpio_pulses(SETTING)
    ((handle, chip),) = lgpio.handles.items()
    assert chips[chip].startswith("pinctrl")
    assert lgpio.claimed == {22: handle}
    output.close()
    assert (lgpio.handles, lgpio.claimed) == ({}, {})


def test_widths_are_whole_microseconds_and_limited(lgpio: LgpioTwin) -> None:
    output = open_lgpio_pulses(SETTING)
    for width_us in (1500.0, 1500.3, 1612.6, 100.0, 9e9, float("inf")):
        output.write_us(width_us)
    assert widths(lgpio) == [1500, 1613, 1100, 1900, 1500]


def test_off_lets_the_last_pulse_end_and_close_waits_for_it(lgpio: LgpioTwin) -> None:
    waits: list[float] = []
    handle = lgpio.gpiochip_open(0)
    output = LgpioPulses(lgpio, handle, SETTING, waits.append)  # type: ignore[arg-type]
    output.write_us(1600.0)
    output.close()
    output.close()
    output.off()
    assert widths(lgpio) == [1600, 0]
    assert waits == [0.02]
    assert lgpio.handles == {}
    with pytest.raises(HardwareError, match="GPIO 22: written to after close"):
        output.write_us(1500.0)


def test_a_pin_in_use_is_told_in_one_line_and_nothing_stays_open(lgpio: LgpioTwin) -> None:
    first = open_lgpio_pulses(SETTING)
    with pytest.raises(HardwareError, match="GPIO 22: the pin cannot be used: GPIO busy"):
        open_lgpio_pulses(SETTING)
    first.close()
    assert lgpio.handles == {}


def test_the_real_lgpio_has_what_the_twin_has() -> None:
    lgpio = pytest.importorskip("lgpio")
    names = [name for name in vars(LgpioTwin) if name[0] != "_" and name != "width_us"]
    assert all(hasattr(lgpio, name) for name in names)
    assert lgpio.TX_PWM == LgpioTwin.TX_PWM
