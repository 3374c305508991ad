"""Configuration of the motor driver."""

from typing import Annotated, Literal

from msgspec import Meta

from companion.config.section import NonNegative, Section


class MotorsPart(Section, frozen=True):
    """The motor driver. Pins in BCM numbers."""

    driver: Literal["l298n", "none"] = "none"
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
