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
from companion.shore.messages import Reason, Sensor
from companion.shore.station.setup import examined
from companion.shore.station.setup.examined import Found, Look, Values
from companion.shore.station.setup.heard import RANGER, SOUNDER
from companion.shore.words import texts

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
    examine: Callable[[Look], Found]
    key: int | str
    begins: tuple[str, ...] = ()


ROWS: Final = (
    _Row("gnss", examined.examine_gnss, dialect.MAVLINK_MSG_ID_GPS_RAW_INT, ("GPS", "Position lost")),
    _Row("compass", examined.examine_compass, dialect.MAVLINK_MSG_ID_SCALED_IMU, ("Compass", "Heading lost")),
    _Row("gyro", examined.examine_gyro, dialect.MAVLINK_MSG_ID_SCALED_IMU),
    _Row("sonar", examined.examine_sonar, RANGER, ("Sonar",)),
    _Row("depth", examined.examine_depth, SOUNDER),
    _Row(
        "battery",
        examined.examine_battery,
        dialect.MAVLINK_MSG_ID_SYS_STATUS,
        ("Battery", "Point of no return"),
    ),
    _Row("rc", examined.examine_rc, dialect.MAVLINK_MSG_ID_RC_CHANNELS, ("RC",)),
    _Row(
        "motors",
        examined.examine_motors,
        dialect.MAVLINK_MSG_ID_SERVO_OUTPUT_RAW,
        ("Left motor", "Right motor", "Weed", "Steering lost"),
    ),
    _Row("clock", examined.examine_clock, dialect.MAVLINK_MSG_ID_SYSTEM_TIME),
    _Row(
        "computer",
        examined.examine_computer,
        dialect.MAVLINK_MSG_ID_SYS_STATUS,
        ("Computer", "Too hot", "Storage", "Water in the hull"),
    ),
)


def sensors(look: Look) -> list[Sensor]:
    """The sensors, then the probes."""
    found = [_sensor(look, row.name, row.name, *row.examine(look), row.key, row.begins) for row in ROWS]
    return [*found, *(_probe(look, name) for name in look.heard.probes)]


def _probe(look: Look, name: str) -> Sensor:
    key = f"probe {name}"
    message = look.heard.latest(key)
    is_number = message is not None and math.isfinite(message.value)
    values: Values = {"value": float(f"{message.value:.6g}")} if message is not None and is_number else {}
    state = "good" if values and not look.is_older(key, _SLOW_STALE_S) else "silent"
    return _sensor(look, key[:_MOST_TEXT], "probe", state, values, key, ())


def _sensor(
    look: Look, name: str, kind: str, state: str, values: Values, key: int | str, begins: tuple[str, ...]
) -> Sensor:
    entry = _entry(kind, state)
    reason = next((one for one in look.reasons if begins and one.text.startswith(begins)), None)
    if not look.is_heard:
        entry = _entry("boat", "silent")
    elif reason is not None and entry.verdict in ("fine", "warning"):
        entry = _of(reason)
    age_s = look.heard.age_s(key, look.now_s)
    return Sensor(
        name=name,
        **entry._asdict(),
        age_s=None if age_s is None else round(age_s, 1),
        values=values,
    )
