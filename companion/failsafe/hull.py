"""The hull and what is in it: water, heat, the sonar, and the computer with its memory."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from companion.failsafe.inputs import FailsafeInputs

_STALE_S = 5.0  # a hull sensor that has said nothing for longer says nothing


def leak(signs: "FailsafeInputs") -> str:
    """Water in the hull."""
    reading = signs.hull
    is_wet = reading is not None and reading.is_wet and signs.now_s - reading.time_s <= _STALE_S
    return "Water in the hull" if is_wet else ""


def too_hot(signs: "FailsafeInputs") -> str:
    """Hull or computer above FS_TEMP_MAX."""
    reading, limit_c = signs.hull, signs.config.failsafe.max_temperature_c
    if reading is None or reading.temperature_c is None or limit_c <= 0.0:
        return ""
    if not reading.temperature_c > limit_c or signs.now_s - reading.time_s > _STALE_S:
        return ""
    return f"Too hot: {reading.temperature_c:.0f} C"


def sonar_lost(signs: "FailsafeInputs") -> str:
    """A sonar that has pinged falls silent."""
    silent_s, limit_s = signs.now_s - signs.sonar_s, signs.config.failsafe.sonar_timeout_s
    return f"Sonar lost for {limit_s:g} s" if silent_s > limit_s else ""


def overrun(signs: "FailsafeInputs") -> str:
    """The control loop takes longer than its tick."""
    return f"Computer overloaded: {100.0 * signs.load:.0f} % of its time" if signs.load > 1.0 else ""


def storage_failed(signs: "FailsafeInputs") -> str:
    """Something that was to survive could not be written."""
    return f"Not written: {signs.storage_fault}" if signs.storage_fault else ""
