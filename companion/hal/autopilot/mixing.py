"""From shares of drive to the pulses of Rover's two sticks: the inverse of what MANUAL makes of them.

MANUAL passes the sticks on. A skid-steered Rover drives left = throttle + steering and right = throttle −
steering (AP_MotorsUGV, output_skid_steering); pairs of shares never saturate there. A stick's share is
counted from the edge of its dead zone (RC_Channel, pwm_to_angle_dz_trim).
"""

from collections.abc import Mapping
from typing import Final

from msgspec import Struct

from companion.core.units import clamp
from companion.hal.autopilot.parameters import CHANNEL_KEYS, STEERING, THROTTLE

_MARK_US: Final = 7.0  # well within the dead zone of 30


class Stick(Struct, frozen=True):
    """A channel, counted from 1, with its calibration in µs."""

    channel: int
    min_us: float
    trim_us: float
    max_us: float
    dead_zone_us: float
    is_reversed: bool

    def pulse_us(self, share: float) -> int:
        """The pulse for a share, −1..1. That of 0 is marked: no transmitter's stick rests just there."""
        share = clamp(-share if self.is_reversed else share, -1.0, 1.0)
        if share > 0.0:
            edge_us = self.trim_us + self.dead_zone_us
            return round(edge_us + share * (self.max_us - edge_us))
        edge_us = self.trim_us - self.dead_zone_us
        if share < 0.0:
            return round(edge_us + share * (edge_us - self.min_us))
        return round(self.trim_us + min(_MARK_US, self.dead_zone_us))


def sticks(values: Mapping[str, float]) -> tuple[Stick, Stick]:
    """Steering and throttle, from Rover's parameters. KeyError: one is missing."""
    steering, throttle = (_stick(int(values[key]), values) for key in (STEERING, THROTTLE))
    return steering, throttle


def _stick(channel: int, values: Mapping[str, float]) -> Stick:
    least_us, trim_us, most_us, zone_us = (values[f"RC{channel}_{key}"] for key in CHANNEL_KEYS)
    return Stick(channel, least_us, trim_us, most_us, zone_us, bool(values[f"RC{channel}_REVERSED"]))


def pair_shares(left: float, right: float) -> tuple[float, float]:
    """Steering and throttle for two motors."""
    return 0.5 * (left - right), 0.5 * (left + right)
