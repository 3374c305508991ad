"""Telemetry of the RC channels."""

from companion.mavlink.dialect import Message, dialect
from companion.services.telemetry.snapshot import Snapshot

_MOST_CHANNELS = 18
_CENTRE_US, _SPAN_US = 1500.0, 500.0
_UNUSED = 0xFFFF
_BEST_SIGNAL, _UNKNOWN_SIGNAL = 254.0, 0xFF


def rc_channels(now: Snapshot) -> Message:
    """The receiver's channels (none while RC is lost), and the link quality as the signal.

    Manual input from a station replaces the transmitter's sticks. Without a receiver it is all there is,
    centred when released.
    """
    sticks, config = now.vehicle.manual_input, now.config
    radio, rc, reading = sticks.rc, config.rc, sticks.rc.latest
    pulses, signal = [], _UNKNOWN_SIGNAL
    if reading is not None and radio.is_fresh(rc, now.now_s):
        pulses = list(reading.channels_us[:_MOST_CHANNELS])
        if reading.quality is not None:
            signal = round(_BEST_SIGNAL * reading.quality)
    elif radio.is_fitted:
        signal = 0
    if sticks.has_station(config, now.now_s) or not radio.is_fitted:
        throttle, steering = sticks.throttle_and_steering(config, now.now_s)
        pulses += [round(_CENTRE_US)] * (4 - len(pulses))
        pulses[rc.steering_channel - 1] = round(_CENTRE_US + _SPAN_US * steering)
        pulses[rc.throttle_channel - 1] = round(_CENTRE_US + _SPAN_US * throttle)
    unused = [_UNUSED] * (_MOST_CHANNELS - len(pulses))
    return dialect.MAVLink_rc_channels_message(now.boot_ms, len(pulses), *pulses, *unused, signal)
