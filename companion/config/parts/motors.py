"""Configuration of the motor driver."""

from typing import Annotated, Literal

from msgspec import Meta, structs

from companion.config.parts.pulses import PulseOutputSetting
from companion.config.section import NonNegative, Section

# GPIO 0 to 8 are high from reset until a program sets them (BCM2835 data sheet, table 6-31)
PULLED_UP = range(9)


class MotorsPart(Section, frozen=True):
    """The motor driver. Pins in BCM numbers.

    Bridges have pins: forward, backward and enable ("l298n", "bts7960"), PWM as enable ("tb6612"), or forward
    and backward only ("drv8833"). Speed controllers ("esc") have signals instead: left and right.
    """

    driver: Literal["l298n", "tb6612", "bts7960", "drv8833", "esc", "none"] = "none"
    left_forward: int = 5
    left_backward: int = 6
    left_enable: int = 12
    right_forward: int = 20
    right_backward: int = 21
    right_enable: int = 13
    pwm_hz: Annotated[int, Meta(ge=50, le=10000)] = 1000  # the maximum of lgpio
    dead_time_s: NonNegative = 0.02
    left_reversed: bool = False
    right_reversed: bool = False
    left: PulseOutputSetting = PulseOutputSetting(pin=12)
    right: PulseOutputSetting = PulseOutputSetting(pin=13)
    arming_s: NonNegative = 3.0  # neutral pulses before the first command; ESCs arm on them

    @property
    def signals(self) -> tuple[PulseOutputSetting, PulseOutputSetting]:
        """The speed controllers' signals, left and right, with left_reversed and right_reversed in them."""
        left = structs.replace(self.left, reversed=self.left.reversed != self.left_reversed)
        return left, structs.replace(self.right, reversed=self.right.reversed != self.right_reversed)

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.driver == "esc":
            for name, signal in zip(("left", "right"), self.signals, strict=True):
                if signal.reversed and signal.trim_us == signal.min_us:
                    raise ValueError(
                        f"{name}: without reverse it cannot be reversed; swap two of the motor's wires"
                    )
        if self.driver == "drv8833":
            for name in ("left_forward", "left_backward", "right_forward", "right_backward"):
                if getattr(self, name) in PULLED_UP:
                    raise ValueError(
                        f"{name} = {getattr(self, name)}: GPIO 0 to 8 are high at reset and would run the "
                        "motor; expected another"
                    )
