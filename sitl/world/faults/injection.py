"""Faults by MAV_CMD_INJECT_FAILURE, while the boat sails.

Such a fault lasts until it is ended by the same command.
"""

from companion.mavlink.dialect import dialect
from sitl.world.faults.catalogue import CATALOGUE, FaultSetting
from sitl.world.faults.schedule import Faults

_UNITS: dict[int, tuple[str, ...]] = {
    dialect.FAILURE_UNIT_SENSOR_GYRO: ("gyro",),
    dialect.FAILURE_UNIT_SENSOR_MAG: ("compass",),
    dialect.FAILURE_UNIT_SENSOR_GPS: ("gnss",),
    dialect.FAILURE_UNIT_SENSOR_DISTANCE_SENSOR: ("sonar",),
    dialect.FAILURE_UNIT_SYSTEM_BATTERY: ("battery",),
    dialect.FAILURE_UNIT_SYSTEM_MOTOR: ("motor_left", "motor_right"),
    dialect.FAILURE_UNIT_SYSTEM_RC_SIGNAL: ("rc",),
    dialect.FAILURE_UNIT_SYSTEM_MAVLINK_SIGNAL: ("link",),
}
_KINDS: dict[int, str] = {
    dialect.FAILURE_TYPE_OFF: "off",
    dialect.FAILURE_TYPE_STUCK: "stuck",
    dialect.FAILURE_TYPE_GARBAGE: "garbage",
    dialect.FAILURE_TYPE_WRONG: "wrong",
    dialect.FAILURE_TYPE_SLOW: "slow",
    dialect.FAILURE_TYPE_DELAYED: "delayed",
    dialect.FAILURE_TYPE_INTERMITTENT: "intermittent",
}
_SILENCE_S = 10.0  # no station could restore a link that it switched off


class Injection:
    """Satisfies `companion.hal.interfaces.FaultInjector`."""

    def __init__(self, faults: Faults) -> None:
        self.is_enabled = True
        self._faults = faults

    def inject(self, unit: int, failure: int, instance: int) -> str | None:
        """Begin a fault, or end it with failure 0. Returns what was done; None if it is not possible."""
        parts, kind = _UNITS.get(unit, ()), _KINDS.get(failure)
        if not (self.is_enabled and parts and self._faults.parts.issuperset(parts)):
            return None
        if not 0 <= instance <= len(parts):
            return None
        if instance:
            parts = (parts[instance - 1],)
        if failure != dialect.FAILURE_TYPE_OK and (kind is None or kind not in CATALOGUE[parts[0]]):
            return None
        for part in parts:
            if kind is None:
                self._faults.end(part)
            else:
                silence_s = _SILENCE_S if (part, kind) == ("link", "off") else None
                self._faults.begin(FaultSetting(what=part, kind=kind, for_s=silence_s))
        return f"{' and '.join(parts)} {kind or 'well again'}"
