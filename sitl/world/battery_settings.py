"""A battery in numbers: what `sitl.world.pack` computes with."""

from typing import Annotated

from msgspec import Meta

from companion.config.section import NonNegative, Positive, Section, Share


class BatterySettings(Section, frozen=True):
    """One pack. charge is the share left at the start; idle_a is what computer and sensors draw.

    brownout_v is the voltage at the terminals below which the computer's regulator gives up: five volts,
    the two that a plain one drops, and some for the leads. fuse_a: rating of the fuse beside the pack, 0
    without one.
    """

    capacity_mah: Positive = 2200.0
    cells: Annotated[int, Meta(ge=1, le=10)] = 3
    resistance_ohm: NonNegative = 0.05
    charge: Share = 1.0
    idle_a: NonNegative = 0.6
    brownout_v: NonNegative = 7.0
    rate_hz: Positive = 10.0
    fuse_a: NonNegative = 0.0
