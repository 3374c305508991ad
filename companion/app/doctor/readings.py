"""A part's reading in words, by the type of the reading."""

import math
from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType
from typing import Any

from companion.app.doctor.findings import Verdict
from companion.config.boat_config import BoatConfig
from companion.core.readings import (
    BatteryReading,
    DepthReading,
    GnssFix,
    HeadingReading,
    HullReading,
    ProbeReading,
    RcReading,
    SonarReading,
)
from companion.core.units import wrap_two_pi
from companion.sensors.charge import cells_fault

Words = tuple[Verdict, str]
_FIX_NAMES = ("no receiver", "no fix", "2-D fix", "3-D fix", "DGNSS fix", "RTK float", "RTK fixed")


def _degrees(angle_rad: float) -> str:
    return f"{math.degrees(angle_rad):.0f}°"


def fix_in_words(fix: GnssFix, config: BoatConfig) -> Words:
    """Kind of fix, satellites, place."""
    name = _FIX_NAMES[min(fix.fix_type, len(_FIX_NAMES) - 1)]
    text = f"{name}, {fix.satellites} satellites"
    if fix.fix_type >= 2:
        text += f", HDOP {fix.hdop:.1f}, {fix.position.lat_deg:.6f} {fix.position.lon_deg:.6f}"
        if fix.horizontal_accuracy_m is not None:
            text += f" ±{fix.horizontal_accuracy_m:.2g} m"
    good = fix.fix_type >= config.arming.min_fix_type and fix.hdop <= config.arming.max_hdop
    return (Verdict.FINE, text) if good else (Verdict.WARNING, f"{text}; not enough to arm")


def heading_in_words(reading: HeadingReading, config: BoatConfig) -> Words:  # noqa: ARG001 — one signature
    """Heading, rate and tilt, if measured."""
    north = "magnetic" if reading.is_magnetic else "true"
    text = f"heading {_degrees(wrap_two_pi(reading.heading_rad))} {north}"
    if reading.yaw_rate_rad_s is not None:
        text += f", turning {math.degrees(reading.yaw_rate_rad_s):+.1f}°/s"
    if reading.roll_rad is not None and reading.pitch_rad is not None:
        text += f", roll {_degrees(reading.roll_rad)}, pitch {_degrees(reading.pitch_rad)}"
    if reading.field_mg is not None:
        text += f", field {math.hypot(*reading.field_mg):.0f} mG"
    return Verdict.FINE, text


def battery_in_words(reading: BatteryReading, config: BoatConfig) -> Words:
    """Voltage, current, and whether it is enough to arm."""
    text = f"{reading.voltage_v:.2f} V"
    text += ", current not measured" if reading.current_a is None else f", {reading.current_a:.2f} A"
    if reading.voltage_v < config.arming.battery_min_v:
        return Verdict.WARNING, f"{text}; below arming.battery_min_v = {config.arming.battery_min_v:g} V"
    if fault := cells_fault(reading.voltage_v, config.battery.cells):
        return Verdict.WARNING, f"{text}; {fault}"
    return Verdict.FINE, text


def hull_in_words(reading: HullReading, config: BoatConfig) -> Words:  # noqa: ARG001
    """Whether there is water, and the temperature."""
    wet = {None: "no leak switch", False: "dry", True: "WATER"}[reading.is_wet]
    text = wet if reading.temperature_c is None else f"{wet}, {reading.temperature_c:.0f} °C"
    return Verdict.FAILED if reading.is_wet else Verdict.FINE, text


def depth_in_words(reading: DepthReading, config: BoatConfig) -> Words:  # noqa: ARG001
    """Depth below the transducer and of the water."""
    if reading.depth_m is None or reading.water_m is None:
        return Verdict.WARNING, "the sounder answers, no bottom found"
    text = f"{reading.depth_m:.2f} m below the transducer, water {reading.water_m:.2f} m"
    return Verdict.FINE, text if reading.temperature_c is None else f"{text}, {reading.temperature_c:.1f} °C"


def probe_in_words(reading: ProbeReading, config: BoatConfig) -> Words:  # noqa: ARG001
    """The value with its unit."""
    return Verdict.FINE, f"{reading.value:.6g} {reading.unit}".rstrip()


def rc_in_words(reading: RcReading, config: BoatConfig) -> Words:  # noqa: ARG001
    """Channels and the strength of the signal."""
    if reading.is_failsafe:
        return Verdict.WARNING, "receiver answers, transmitter off"
    text = f"channels {' '.join(str(width) for width in reading.channels_us[:8])} µs"
    return Verdict.FINE, text if reading.rssi_dbm is None else f"{text}, {reading.rssi_dbm:.0f} dBm"


def pings_in_words(pings: Sequence[SonarReading], config: BoatConfig) -> Words:  # noqa: ARG001
    """The nearest echo and its bearing."""
    echoes = [(ping.range_m, ping.bearing_rad) for ping in pings if ping.range_m is not None]
    if not echoes:
        return (
            Verdict.FINE,
            f"{len(pings)} pings, no echo within {max(ping.max_range_m for ping in pings):.1f} m",
        )
    range_m, bearing_rad = min(echoes)
    side = "to starboard" if bearing_rad > 0.0 else "to port"
    where = "ahead" if abs(bearing_rad) < math.radians(1.0) else f"{_degrees(abs(bearing_rad))} {side}"
    return Verdict.FINE, f"nearest echo {range_m:.2f} m {where}"


WORDS: Mapping[type, Callable[[Any, BoatConfig], Words]] = MappingProxyType(
    {
        GnssFix: fix_in_words,
        HeadingReading: heading_in_words,
        BatteryReading: battery_in_words,
        HullReading: hull_in_words,
        DepthReading: depth_in_words,
        ProbeReading: probe_in_words,
        RcReading: rc_in_words,
        list: pings_in_words,
    }
)


def in_words(reading: object, config: BoatConfig) -> Words:
    """Any reading; one without a row as it prints itself."""
    words = WORDS.get(type(reading))
    return words(reading, config) if words is not None else (Verdict.FINE, str(reading))
