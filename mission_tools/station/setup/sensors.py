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
from mission_tools.station.messages import Reason, Sensor
from mission_tools.station.setup import sensor_checks
from mission_tools.station.setup.latest_messages import RANGER, SOUNDER
from mission_tools.station.setup.sensor_checks import Found, SensorSnapshot, Values
from mission_tools.station.words import texts

_SLOW_STALE_S: Final = 10.0  # what may come every 5 s, over a radio that loses some
_MOST_TEXT: Final = 60


@cache
def verdicts() -> dict[str, dict[str, str]]:
    """By part and what is so."""
    return tomllib.loads(files(__package__).joinpath("sensors.toml").read_text("utf-8"))


class _Told(NamedTuple):
    """A verdict with the keys of its words, and the words themselves."""

    verdict: str
    text: str
    cure: str
    text_key: str
    cure_key: str


def _entry(part: str, state: str) -> _Told:
    key = f"sensor.{part}.{state}"
    return _Told(
        verdicts()[part][state],
        texts()[f"{key}.text"],
        texts().get(f"{key}.cure", ""),
        f"{key}.text",
        f"{key}.cure",
    )


def _of(reason: Reason) -> _Told:
    key = f"reason.{reason.key}"
    return _Told("warning", reason.why or reason.text, reason.next, f"{key}.why", f"{key}.next")


class _Row(NamedTuple):
    """key: of the message whose age is told. begins: of the boat's reasons that concern this sensor."""

    name: str
    examine: Callable[[SensorSnapshot], Found]
    key: int | str
    begins: tuple[str, ...] = ()


_IMU: Final = dialect.MAVLINK_MSG_ID_SCALED_IMU
ROWS: Final = (
    _Row("gnss", sensor_checks.examine_gnss, dialect.MAVLINK_MSG_ID_GPS_RAW_INT, ("GPS", "Position lost")),
    _Row(
        "compass",
        sensor_checks.examine_compass,
        dialect.MAVLINK_MSG_ID_SCALED_IMU,
        ("Compass", "Heading lost"),
    ),
    _Row("gyro", sensor_checks.examine_gyro, _IMU),
    _Row("sonar", sensor_checks.examine_sonar, RANGER, ("Sonar",)),
    _Row("depth", sensor_checks.examine_depth, SOUNDER),
    _Row(
        "battery",
        sensor_checks.examine_battery,
        dialect.MAVLINK_MSG_ID_SYS_STATUS,
        ("Battery", "Point of no return"),
    ),
    _Row("rc", sensor_checks.examine_rc, dialect.MAVLINK_MSG_ID_RC_CHANNELS, ("RC",)),
    _Row(
        "motors",
        sensor_checks.examine_motors,
        dialect.MAVLINK_MSG_ID_SERVO_OUTPUT_RAW,
        ("Left motor", "Right motor", "Weed", "Steering lost"),
    ),
    _Row("clock", sensor_checks.examine_clock, dialect.MAVLINK_MSG_ID_SYSTEM_TIME),
    _Row(
        "computer",
        sensor_checks.examine_computer,
        dialect.MAVLINK_MSG_ID_SYS_STATUS,
        ("Computer", "Too hot", "Storage", "Water in the hull"),
    ),
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
    kind: str,
    state: str,
    values: Values,
    key: int | str,
    begins: tuple[str, ...],
) -> Sensor:
    entry = _entry(kind, state)
    reason = next((one for one in seen.reasons if begins and one.text.startswith(begins)), None)
    if not seen.is_heard:
        entry = _entry("boat", "silent")
    elif reason is not None and entry.verdict in ("fine", "warning"):
        entry = _of(reason)
    age_s = seen.messages.age_s(key, seen.now_s)
    return Sensor(
        name=name,
        **entry._asdict(),
        age_s=None if age_s is None else round(age_s, 1),
        values=values,
    )
