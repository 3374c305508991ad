"""The estimator's inputs from an onboard log, to replay an estimator on them.

A log has a sample of everything a motion sample, ten times a second by default. `LOG_FILE_RATEMAX = 50`
(`log.motion_hz`) logs every tick: a replay then gives the boat's own estimates but for rounding. With fewer
samples, fixes and commands come up to a sample later than they did, and gyro readings are missing.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from msgspec.structs import replace
from pymavlink.DFReader import DFReader_binary

from companion.config.boat_config import BoatConfig
from companion.config.parameter_table import ROWS
from companion.config.parameters import Parameters
from companion.core.errors import ConfigError
from companion.core.geo import LatLon
from companion.core.readings import GnssFix, HeadingReading
from companion.core.state import STOPPED, MotorCommand, NavState
from companion.core.storage import MemoryStorage
from companion.core.units import wrap_pi
from companion.estimation.estimator import Estimator
from companion.log.records import MAGIC

_UNKNOWN_CENTS = 32767  # of HDop, and 65535 of accuracies: as the log has what is not finite


@dataclass(frozen=True, slots=True)
class LoggedTick:
    """The arguments of `Estimator.update` of one motion sample; logged: the boat's own estimate then, north,
    east, heading (m, m, rad), None without one.
    """

    fix: GnssFix | None
    heading: HeadingReading | None
    now_s: float
    command: MotorCommand
    logged: tuple[float, float, float] | None


@dataclass(frozen=True, slots=True)
class LoggedRun:
    """config: the boat's, as far as its parameters are logged."""

    config: BoatConfig
    ticks: tuple[LoggedTick, ...]

    def estimator(self) -> Estimator:
        """A new estimator with the boat's settings."""
        return Estimator(self.config.speed, self.config.estimation, self.config.drive, self.config.handling)

    def estimates(self, estimator: Estimator) -> Iterator[tuple[LoggedTick, NavState | None]]:
        """Feed an estimator, tick by tick."""
        for tick in self.ticks:
            yield tick, estimator.update(tick.fix, tick.heading, tick.now_s, tick.command)


def read_log(path: Path) -> LoggedRun:
    """Read a log of the boat.

    Raises ConfigError: it cannot be read, or has no heading readings: an older log, or another vehicle's.
    """
    try:
        with path.open("rb") as file:  # pymavlink leaves an empty file open
            if tuple(file.read(2)) != MAGIC:
                raise ConfigError(f"{path}: not a log")
        with DFReader_binary(str(path), zero_time_base=True) as reader:
            records = list(iter(reader.recv_msg, None))
    except (OSError, ValueError) as error:
        raise ConfigError(f"{path}: not a log: {error}") from None
    kinds = {record.get_type() for record in records}
    if not {"RCOU", "HDG"} <= kinds:
        raise ConfigError(f"{path}: no records RCOU and HDG to replay")
    parameters = Parameters(BoatConfig(), ROWS, MemoryStorage())
    parameters.set_many((one.Name, one.Value) for one in records if one.get_type() == "PARM")
    return LoggedRun(parameters.config, tuple(_ticks(records, parameters.config)))


def _ticks(records: list[Any], config: BoatConfig) -> Iterator[LoggedTick]:
    """A motion sample begins with RCOU; what follows was measured before its tick, the command after it."""
    fix: GnssFix | None = None
    heading: HeadingReading | None = None
    before, command = STOPPED, STOPPED
    logged: tuple[float, float, float] | None = None
    now_s = math.nan
    for one in records:
        kind = one.get_type()
        if kind == "RCOU":
            if not math.isnan(now_s):
                yield LoggedTick(fix, heading, now_s, before, logged)
            now_s, before, logged = one.TimeUS * 1e-6, command, None
            command = _command(one, config)
        elif kind == "XKF1":
            logged = (one.PN, one.PE, logged[2] if logged else math.nan)
        elif kind == "ATT":
            logged = (math.nan, math.nan, wrap_pi(math.radians(one.Yaw)))
        elif kind == "HDG":
            rate = None if math.isnan(one.GyrZ) else math.radians(one.GyrZ)
            heading = HeadingReading(one.TimeUS * 1e-6, wrap_pi(math.radians(one.Hdg)), rate)
        elif kind == "GPS":
            fix = _fix(one)
        elif kind == "GPA" and fix is not None and one.TimeUS * 1e-6 == fix.time_s:
            # GPA follows the GPS record of a receiver that states its accuracy
            fix = replace(fix, horizontal_accuracy_m=one.HAcc, speed_accuracy_m_s=one.SAcc or None)
    if not math.isnan(now_s):
        yield LoggedTick(fix, heading, now_s, before, logged)


def _command(record: Any, config: BoatConfig) -> MotorCommand:  # noqa: ANN401 (pymavlink's record)
    """From the pulse widths of RCOU, as Snapshot.output_us makes them."""
    first, second, third = ((width - 1500.0) / 500.0 for width in (record.C1, record.C2, record.C3))
    drive = config.drive
    if not drive.has_rudder:
        return MotorCommand(first, third)
    return MotorCommand(first, third, "", second) if drive.has_pair else MotorCommand(third, third, "", first)


def _fix(record: Any) -> GnssFix:  # noqa: ANN401
    north_m_s = east_m_s = None
    if not math.isnan(record.Spd):
        course = math.radians(record.GCrs)
        north_m_s, east_m_s = record.Spd * math.cos(course), record.Spd * math.sin(course)
    hdop = record.HDop
    return GnssFix(
        record.TimeUS * 1e-6,
        LatLon(record.Lat, record.Lng),
        record.Status,
        record.NSats,
        math.inf if hdop >= 0.01 * _UNKNOWN_CENTS else hdop,
        north_m_s,
        east_m_s,
    )
