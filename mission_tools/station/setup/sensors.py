"""The sensors of a boat with their values and a verdict each, as a table.

The verdicts are in `sensors.toml`, by the part and what is so. A pre-arm reason or a failsafe of the boat
that concerns a part comes before a verdict of ours that is no worse.
"""

import math
import tomllib
from collections.abc import Callable
from functools import cache
from importlib.resources import files
from typing import Final, NamedTuple

from companion.mavlink.dialect import dialect
from mission_tools.station.messages import Sensor
from mission_tools.station.setup import sensor_checks as checks
from mission_tools.station.setup.latest_messages import RANGER, SOUNDER
from mission_tools.station.setup.sensor_checks import Found, SensorSnapshot, Values
from mission_tools.station.words import texts

_SLOW_STALE_S: Final = 10.0  # what may come every 5 s, over a radio that loses some
_MOST_TEXT: Final = 60


@cache
def verdicts() -> dict[str, dict[str, str]]:
    """By part and what is so."""
    return tomllib.loads(files(__package__).joinpath("sensors.toml").read_text("utf-8"))


class _Row(NamedTuple):
    """key: of the message whose age is told. begins: of the boat's reasons that concern this sensor."""

    name: str
    examine: Callable[[SensorSnapshot], Found]
    key: int | str
    begins: tuple[str, ...] = ()


_SIDES: Final = ("Left motor", "Right motor", "Left propeller", "Right propeller")
_PROPULSION: Final = (*_SIDES, "Weed", "Steering lost")
_HULL: Final = ("Computer", "Too hot", "Storage", "Water in the hull")
ROWS: Final = (
    _Row("gnss", checks.examine_gnss, dialect.MAVLINK_MSG_ID_GPS_RAW_INT, ("GPS", "Position lost")),
    _Row("compass", checks.examine_compass, dialect.MAVLINK_MSG_ID_SCALED_IMU, ("Compass", "Heading lost")),
    _Row("gyro", checks.examine_gyro, dialect.MAVLINK_MSG_ID_SCALED_IMU),
    _Row("sonar", checks.examine_sonar, RANGER, ("Sonar",)),
    _Row("depth", checks.examine_depth, SOUNDER),
    _Row(
        "battery",
        checks.examine_battery,
        dialect.MAVLINK_MSG_ID_SYS_STATUS,
        ("Battery", "Point of no return"),
    ),
    _Row("rc", checks.examine_rc, dialect.MAVLINK_MSG_ID_RC_CHANNELS, ("RC",)),
    _Row("motors", checks.examine_motors, dialect.MAVLINK_MSG_ID_SERVO_OUTPUT_RAW, _PROPULSION),
    _Row("clock", checks.examine_clock, dialect.MAVLINK_MSG_ID_SYSTEM_TIME),
    _Row("computer", checks.examine_computer, dialect.MAVLINK_MSG_ID_SYS_STATUS, _HULL),
)


def sensors(seen: SensorSnapshot) -> list[Sensor]:
    """The sensors, then the probes."""
    found = [_sensor(seen, row.name, row.name, *row.examine(seen), row.key, row.begins) for row in ROWS]
    return [*found, *(_probe(seen, name) for name in seen.messages.probes)]


def _probe(seen: SensorSnapshot, name: str) -> Sensor:
    key = f"probe {name}"
    message = seen.messages.latest(key)
    is_number = message is not None and math.isfinite(message.value)
    values: Values = {"value": float(f"{message.value:.6g}")} if message is not None and is_number else {}
    state = "good" if values and not seen.is_older(key, _SLOW_STALE_S) else "silent"
    return _sensor(seen, key[:_MOST_TEXT], "probe", state, values, key, ())


def _sensor(
    seen: SensorSnapshot,
    name: str,
    part: str,
    state: str,
    values: Values,
    key: int | str,
    begins: tuple[str, ...],
) -> Sensor:
    if not seen.is_heard:
        part, state = "boat", "silent"
    verdict, words = verdicts()[part][state], f"sensor.{part}.{state}"
    text_key, cure_key = f"{words}.text", f"{words}.cure"
    text, cure = texts()[text_key], texts().get(cure_key, "")
    reason = next((one for one in seen.reasons if begins and one.text.startswith(begins)), None)
    if seen.is_heard and reason is not None and verdict in ("fine", "warning"):
        verdict, text, cure = "warning", reason.why or reason.text, reason.next
        text_key, cure_key = f"reason.{reason.key}.why", f"reason.{reason.key}.next"
    age_s = seen.messages.age_s(key, seen.now_s)
    age_s = None if age_s is None else round(age_s, 1)
    return Sensor(
        name=name, verdict=verdict, text=text, cure=cure, text_key=text_key, cure_key=cure_key, age_s=age_s,
        values=values,
    )  # fmt: skip
