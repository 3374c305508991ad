"""A log as a voyage: where the boat sailed, how fast, its battery, and what happened when."""

import math
import re
from collections.abc import Callable
from functools import partial
from typing import Any, Final

from companion.core.modes import Mode
from companion.core.units import GPS_EPOCH_UNIX_S, GPS_WEEK_S
from mission_tools.files.dataflash import Log, Record, Value
from mission_tools.shore.voyage.samples import Sample, Samples
from mission_tools.station.words import LocalizedText, say

MOST_EVENTS: Final = 500
_LONGEST_S: Final = 30 * 86400.0
_FRESH_S: Final = 2.0  # an older speed or distance is not shown beside a position
_POWER_FRESH_S: Final = 15.0
_STEP_M: Final = 1.0  # of the estimate, which is smooth
_GPS_STEP_M: Final = 3.0  # of a receiver's own positions
_WANTED: Final[dict[str, tuple[str, ...]]] = {
    "POS": ("TimeUS", "Lat", "Lng"),
    "GPS": ("TimeUS", "Lat", "Lng", "Spd", "GWk", "GMS", "I", "Status"),
    "XKF1": ("TimeUS", "VN", "VE", "C"),
    "THR": ("TimeUS", "DesSpeed"),
    "NTUN": ("TimeUS", "XTrack"),
    "BAT": ("TimeUS", "Volt", "RemPct", "Inst"),
    "AVD": ("TimeUS", "dR0"),
    "MODE": ("TimeUS", "ModeNum", "Mode"),
    "ARM": ("TimeUS", "ArmState"),
    "EV": ("TimeUS", "Id"),
    "ERR": ("TimeUS", "Subsys", "ECode"),
    "MSG": ("TimeUS", "Message"),
    "VER": ("TimeUS", "FWS"),
}
_SUBSYSTEMS: Final = {  # after ArduPilot's LogErrorSubsystem
    1: "Main", 2: "Radio", 3: "Compass", 5: "Remote control", 6: "Battery", 7: "GNSS", 8: "Operator",
    9: "Fence", 10: "Mode", 11: "Position", 12: "Crash check", 15: "Parachute", 16: "Estimator",
    17: "Estimator", 18: "Barometer", 19: "Processor", 21: "Terrain", 22: "Navigation", 24: "Estimator",
}  # fmt: skip
_ARMED_EVENTS: Final = {10: 1, 11: 0}
_OTHER_VEHICLES: Final = re.compile(r"Ardu(Copter|Plane|Sub)|AntennaTracker|Blimp")


class NoVoyageError(Exception):
    """A log that cannot be shown. text: for people."""

    def __init__(self, text: LocalizedText) -> None:
        super().__init__(text)
        self.text = text


class Voyage:
    """Records in, a voyage out. Times are those of the log, in seconds since the boat's start."""

    def __init__(self) -> None:
        self._positions = Samples(_STEP_M)
        self._receiver = Samples(_GPS_STEP_M)
        self._latest: dict[str, tuple[float, float | None]] = {}
        self._events: list[tuple[float, str, str]] = []
        self._event_count = 0
        self._armed: list[tuple[float, str, str]] = []
        self._has_arm = False
        self._begun_s: float | None = None  # Unix time of the boat's start
        self._first_s: float | None = None
        self._last_s = 0.0
        self._fastest_m_s: float | None = None
        self._cross_track_m: float | None = None
        self._program = ""
        self._is_rover = True
        self._mode: float | None = None
        self._handlers: dict[str, Callable[..., None]] = {
            "POS": partial(self._add, self._positions), "GPS": self._on_fix, "XKF1": self._on_velocity,
            "THR": self._on_throttle, "NTUN": self._on_navigation, "BAT": self._on_battery,
            "AVD": self._on_obstacle, "MODE": self._on_mode, "ARM": self._on_arm, "EV": self._on_event,
            "ERR": self._on_error, "MSG": self._on_text, "VER": self._on_version,
        }  # fmt: skip

    def ingest(self, record: Record) -> None:
        """The next record. One without a time, or with an absurd one, is left out."""
        time_us = record.values[0]
        if not isinstance(time_us, int | float) or not 0.0 <= time_us * 1e-6 <= _LONGEST_S:
            return
        at_s = time_us * 1e-6
        self._first_s = at_s if self._first_s is None else min(self._first_s, at_s)
        self._last_s = max(self._last_s, at_s)
        self._handlers[record.name](at_s, *record.values[1:])

    def result(self, *, is_cut: bool) -> dict[str, Any]:
        """As JSON, see docs/shore.md; NoVoyageError without a position."""
        samples = self._positions if self._positions.kept else self._receiver
        kept = samples.finish()
        if not kept:
            raise NoVoyageError(say("voyage.no_position"))
        first_s = self._first_s or 0.0
        events = sorted(self._events + self._armed)
        return {
            "begun_s": None if self._begun_s is None else round(self._begun_s + first_s, 1),
            "duration_s": round(self._last_s - first_s, 1),
            "distance_m": round(samples.distance_m, 1),
            "largest_speed_m_s": _rounded(self._fastest_m_s, 2),
            "largest_cross_track_m": _rounded(self._cross_track_m, 2),
            "program": self._program,
            "is_cut": is_cut,
            "track": [[round(one.lon, 7), round(one.lat, 7)] for one in kept],
            "times_s": [round(one.at_s - first_s, 2) for one in kept],
            "speeds_m_s": [_rounded(one.speed_m_s, 2) for one in kept],
            "wanted_m_s": [_rounded(one.wanted_m_s, 2) for one in kept],
            "voltages_v": [_rounded(one.voltage_v, 2) for one in kept],
            "percents": [_rounded(one.percent, 0) for one in kept],
            "obstacles_m": [_rounded(one.obstacle_m, 1) for one in kept],
            "events": [
                {"at_s": round(at_s - first_s, 2), "kind": kind, "text": text} for at_s, kind, text in events
            ],
            "events_left_out": self._event_count - len(self._events),
        }

    def _on_fix(
        self,
        at_s: float,
        lat: Value,
        lon: Value,
        speed: Value,
        week: Value,
        ms: Value,
        which: Value,
        status: Value,
    ) -> None:
        if which not in (None, 0) or not isinstance(status, int | float) or status < 2:  # 2D at least
            return
        if (
            isinstance(week, int | float)
            and isinstance(ms, int | float)
            and week > 0
            and self._begun_s is None
        ):
            self._begun_s = GPS_EPOCH_UNIX_S + week * GPS_WEEK_S + ms * 1e-3 - at_s
        if "XKF1" not in self._latest:
            self._note_speed("GPS", at_s, speed)
        self._add(self._receiver, at_s, lat, lon)

    def _on_velocity(self, at_s: float, north: Value, east: Value, core: Value) -> None:
        if core in (None, 0) and isinstance(north, int | float) and isinstance(east, int | float):
            self._note_speed("XKF1", at_s, math.hypot(north, east))

    def _note_speed(self, source: str, at_s: float, speed: Value) -> None:
        if isinstance(speed, int | float) and 0.0 <= speed < 100.0:
            self._latest[source] = at_s, speed
            self._fastest_m_s = max(self._fastest_m_s or 0.0, speed)

    def _on_throttle(self, at_s: float, wanted: Value) -> None:
        self._latest["THR"] = at_s, _number(wanted)

    def _on_navigation(self, at_s: float, cross_track: Value) -> None:  # noqa: ARG002
        if (error := _number(cross_track)) is not None:
            self._cross_track_m = max(self._cross_track_m or 0.0, abs(error))

    def _on_battery(self, at_s: float, voltage: Value, percent: Value, which: Value) -> None:
        if which in (None, 0):
            self._latest["Volt"], self._latest["RemPct"] = (at_s, _number(voltage)), (at_s, _number(percent))

    def _on_obstacle(self, at_s: float, distance: Value) -> None:
        self._latest["AVD"] = at_s, _number(distance)

    def _on_mode(self, at_s: float, number: Value, mode: Value) -> None:
        value = _number(number if number is not None else mode)
        if value is None or value == self._mode:
            return
        self._mode = value
        names = [one.name for one in Mode if one == value] if self._is_rover else []
        self._note(at_s, "mode", names[0] if names else f"mode {value:.0f}")

    def _on_arm(self, at_s: float, state: Value) -> None:
        if not self._has_arm:
            self._has_arm = True
            self._armed.clear()
        self._note_armed(at_s, state)

    def _on_event(self, at_s: float, ident: Value) -> None:
        """Older programs have no ARM."""
        if not self._has_arm and isinstance(ident, int | float) and ident in _ARMED_EVENTS:
            self._note_armed(at_s, _ARMED_EVENTS[int(ident)])

    def _note_armed(self, at_s: float, state: Value) -> None:
        text = "armed" if state else "disarmed"
        if len(self._armed) < MOST_EVENTS and not (self._armed and self._armed[-1][1] == text):
            self._armed.append((at_s, text, ""))

    def _on_error(self, at_s: float, subsystem: Value, code: Value) -> None:
        if isinstance(subsystem, int | float) and isinstance(code, int | float):
            name = _SUBSYSTEMS.get(int(subsystem), f"Subsystem {subsystem:.0f}")
            self._note(at_s, "error", f"{name}: error {code:.0f}" if code else f"{name}: over")

    def _on_text(self, at_s: float, text: Value) -> None:
        if isinstance(text, str) and text:
            self._is_rover = self._is_rover and not _OTHER_VEHICLES.search(text)
            self._note(at_s, "message", text)

    def _on_version(self, at_s: float, program: Value) -> None:  # noqa: ARG002
        if isinstance(program, str):
            self._program = self._program or program
            self._is_rover = self._is_rover and not _OTHER_VEHICLES.search(program)

    def _note(self, at_s: float, kind: str, text: str) -> None:
        self._event_count += 1
        if len(self._events) < MOST_EVENTS:
            self._events.append((at_s, kind, text))

    def _add(self, samples: Samples, at_s: float, lat: Value, lon: Value) -> None:
        if not isinstance(lat, int | float) or not isinstance(lon, int | float):
            return
        if not (-90.0 <= lat <= 90.0 and -180.0 <= lon <= 180.0) or (lat == 0.0 and lon == 0.0):
            return

        def latest(name: str, fresh_s: float = _FRESH_S) -> float | None:
            noted_s, value = self._latest.get(name, (-math.inf, None))
            return value if at_s - noted_s <= fresh_s else None

        speed = latest("XKF1") if "XKF1" in self._latest else latest("GPS")
        volt, percent = latest("Volt", _POWER_FRESH_S), latest("RemPct", _POWER_FRESH_S)
        samples.add(Sample(at_s, lon, lat, speed, latest("THR"), volt, percent, latest("AVD")))


def read_voyage(data: "bytes | memoryview") -> dict[str, Any]:
    """A whole log; NoVoyageError if it is no DataFlash log, or has no position."""
    if not len(data):
        raise NoVoyageError(say("voyage.empty"))
    log, voyage = Log(data, _WANTED), Voyage()
    for record in log.records():
        voyage.ingest(record)
    if not log.count:
        raise NoVoyageError(say("voyage.foreign"))
    return voyage.result(is_cut=log.is_cut)


def _number(value: Value) -> float | None:
    return value if isinstance(value, int | float) else None


def _rounded(value: float | None, digits: int) -> float | None:
    return None if value is None else round(value, digits)
