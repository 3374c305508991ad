"""What the boat's estimator is given in a run, with the truth: for replaying estimators on the same data."""

from array import array
from dataclasses import dataclass
from typing import Any, TypeVar

import msgspec
import numpy as np
from numpy.typing import NDArray

from companion.core.readings import GnssFix, HeadingReading
from companion.core.state import MotorCommand
from sitl.world.scenario import Scenario
from sitl.world.truth import Truth

TICK_COLUMNS = ("now_s", "fix", "heading", "left", "right", "rudder")
TRUTH_EVERY = 5  # ticks

Numbers = NDArray[np.float64]
R = TypeVar("R", GnssFix, HeadingReading)


@dataclass(frozen=True, slots=True)
class SensorRecording:
    """ticks: a row per tick, TICK_COLUMNS; fix and heading are indices into the readings, −1 for none.

    fixes, headings: the readings, by field. truth: every tenth of a second, fields of Truth, by the boat's
    clock. frame: origin of the truth, latitude and longitude in degrees. settings: the boat's (speed,
    estimation, drive) and the scenario's (faults and so on).
    """

    settings: dict[str, Any]
    ticks: Numbers
    fixes: list[dict[str, Any]]
    headings: list[dict[str, Any]]
    truth: Numbers
    frame: tuple[float, float]


class SensorRecorder:
    """Keeps what the estimator is given, tick by tick."""

    def __init__(self) -> None:
        self._ticks = array("d")
        self._truth = array("d")
        self._fixes: list[GnssFix] = []
        self._headings: list[HeadingReading] = []

    def record(
        self,
        now_s: float,
        truth: Truth,
        fix: GnssFix | None,
        heading: HeadingReading | None,
        command: MotorCommand,
    ) -> None:
        """Record the arguments of one call of the estimator. command: since the last call."""
        if len(self._ticks) % (TRUTH_EVERY * len(TICK_COLUMNS)) == 0:
            self._truth.extend(truth._replace(time_s=now_s))
        fix_index, heading_index = _index(self._fixes, fix), _index(self._headings, heading)
        self._ticks.extend((now_s, fix_index, heading_index, command.left, command.right, command.rudder))

    def recording(self, scenario: Scenario, name: str) -> SensorRecording:
        settings = {
            one: msgspec.to_builtins(getattr(scenario.vehicle, one))
            for one in ("speed", "estimation", "drive")
        }
        for one in ("environment", "faults", "hull", "thrusters", "sensors"):
            settings[one] = msgspec.json.decode(msgspec.json.encode(getattr(scenario, one)))
        return SensorRecording(
            settings={"name": name, "seed": scenario.seed, **settings},
            ticks=np.array(self._ticks, dtype=np.float64).reshape(-1, len(TICK_COLUMNS)),
            fixes=[msgspec.to_builtins(fix) for fix in self._fixes],
            headings=[msgspec.to_builtins(reading) for reading in self._headings],
            truth=np.array(self._truth, dtype=np.float64).reshape(-1, len(Truth._fields)),
            frame=(scenario.frame.origin.lat_deg, scenario.frame.origin.lon_deg),
        )


def _index(kept: list[R], reading: R | None) -> int:
    """Where a reading lies among those kept; a new one is appended."""
    if reading is None:
        return -1
    if not kept or kept[-1] is not reading:
        kept.append(reading)
    return len(kept) - 1
