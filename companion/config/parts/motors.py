"""Configuration of the motor driver."""

from typing import Annotated, Literal

from msgspec import Meta, structs

from companion.config.board import PULLED_UP, Pin
from companion.config.parts.pulses import PulseOutputSetting
from companion.config.section import NonNegative, Section


class MotorsPart(Section, frozen=True):
    """The motor driver. Pins in BCM numbers.

    Bridges have pins: forward, backward and enable ("l298n", "bts7960"), PWM as enable ("tb6612"), or forward
    and backward only ("drv8833"). Speed controllers ("esc") have signals instead: left and right.
    """

    driver: Literal["l298n", "tb6612", "bts7960", "drv8833", "esc", "none"] = "none"
    left_forward: Pin = 5
    left_backward: Pin = 6
    left_enable: Pin = 12
    right_forward: Pin = 20
    right_backward: Pin = 21
    right_enable: Pin = 13
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

    def pins(self, *, has_right: bool) -> dict[str, int]:
        """The pins of a bridge, by key."""
        if self.driver in ("none", "esc"):
            return {}
        names = ("forward", "backward") if self.driver == "drv8833" else ("forward", "backward", "enable")
        sides = ("left", "right") if has_right else ("left",)
        return {f"{side}_{name}": getattr(self, f"{side}_{name}") for side in sides for name in names}

    def stop_pins(self, *, has_right: bool) -> list[int]:
        """Those that stop a bridge when they are low: its enables, or all where it has none."""
        pins = self.pins(has_right=has_right)
        return [pin for key, pin in pins.items() if key.endswith("enable")] or list(pins.values())

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
