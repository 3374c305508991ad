"""Converts a channel's pulse to a stick deflection or a switch position."""

from typing import Final

from companion.config.tuning import RcChannel

SHORTEST_US: Final = 800  # shorter or longer is no valid pulse: ArduPilot's limits for a receiver
LONGEST_US: Final = 2200
# The range of servo signals: an override beyond it is a fault of its sender, not a full deflection
_LEAST_OVERRIDE_US: Final = 900
_MOST_OVERRIDE_US: Final = 2100
LOW, MIDDLE, HIGH = 0, 1, 2
_LOW_US, _HIGH_US = 1200, 1800
_MODE_US: Final = (1231, 1361, 1491, 1621, 1750)  # lower bounds of the second to sixth position


def is_pulse(pulse_us: int) -> bool:
    """Whether the pulse is valid."""
    return SHORTEST_US <= pulse_us <= LONGEST_US


def is_override(pulse_us: int) -> bool:
    """Whether a station's override of a channel is a pulse."""
    return _LEAST_OVERRIDE_US <= pulse_us <= _MOST_OVERRIDE_US


def deflection(pulse_us: int, channel: RcChannel, dead_us: int) -> float:
    """A stick's deflection from its trim, −1..1, with a dead zone of dead_us on either side.

    A throttle without reverse has its trim at its minimum.
    """
    off_us = pulse_us - channel.trim_us
    span_us = (channel.max_us - channel.trim_us if off_us > 0 else channel.trim_us - channel.min_us) - dead_us
    beyond_us = abs(off_us) - dead_us
    if beyond_us <= 0 or span_us <= 0:
        return 0.0
    share = min(beyond_us / span_us, 1.0)
    return share if (off_us > 0) is not channel.is_reversed else -share


def pulse_of(share: float, channel: RcChannel) -> int:
    """The pulse of a deflection −1..1 in µs: the inverse of `deflection` without a dead zone."""
    off = -share if channel.is_reversed else share
    span_us = channel.max_us - channel.trim_us if off > 0.0 else channel.trim_us - channel.min_us
    return round(channel.trim_us + off * max(span_us, 0))


def switch_position(pulse_us: int) -> int:
    """LOW, MIDDLE or HIGH, as ArduPilot reads a switch."""
    return LOW if pulse_us < _LOW_US else HIGH if pulse_us > _HIGH_US else MIDDLE


def mode_position(pulse_us: int) -> int:
    """The position of a mode switch, 0 to 5, by ArduPilot's bands."""
    position = 0
    for begins_us in _MODE_US:
        position += pulse_us >= begins_us
    return position
