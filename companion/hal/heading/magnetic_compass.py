"""A compass of a magnetometer and, where fitted, a gyro with accelerometer, read by one thread."""

import logging
import math
import time
from collections.abc import Callable, Mapping
from typing import Final, Generic, TypeVar

from companion.config.sensors import CompassPart
from companion.core.errors import HardwareError
from companion.core.readings import HeadingReading
from companion.core.status_text import Severity
from companion.core.units import wrap_pi
from companion.core.vectors import Vector, times
from companion.hal.background import BackgroundSensor
from companion.hal.heading.chips import Chip, InertialSensor, Magnetometer, Motion
from companion.hal.heading.inertial import INERTIAL
from companion.hal.heading.magnetometers import MAGNETOMETERS
from companion.hal.heading.orientation import board_to_body
from companion.hal.raspberry_pi import I2cBus, open_i2c
from companion.sensors.compass.attitude import AttitudeFilter, magnetic_heading
from companion.sensors.compass.magnetic_field import FieldCorrector

_log = logging.getLogger(__name__)

Sample = TypeVar("Sample")

PERIOD_S: Final = 0.02
SILENT_S: Final = 0.5  # without a new sample a part is set up again: after a supply dip it does not measure
STUCK: Final = 50  # equal samples, a second of them: a working part has a noise of more than one count
LOST_S: Final = 2.0  # the gyro bridges a magnetometer without a field for this long
RETRY_S: Final = 0.5  # after an error of one part; the other goes on meanwhile
_LEVEL: Final = (0.0, 0.0, 1.0)


class _Watched(Generic[Sample]):
    """Reads a part. It is set up again when it has been silent or stuck, and tried again after an error.

    is_lost: it has given nothing for LOST_S. error: of the last attempt.
    """

    def __init__(
        self, part: Chip[Sample], notify: Callable[[int, str], None], consequence: str, now_s: float
    ) -> None:
        self.is_lost = False
        self.error: OSError | None = None
        self._part = part
        self._notify = notify
        self._consequence = consequence
        self._heard_s = self._asked_s = now_s
        self._retry_s = -math.inf
        self._last: Sample | None = None
        self._equal = 0

    def read(self, now_s: float) -> Sample | None:
        sample = self._sample(now_s)
        if sample is not None:
            self._heard_s = self._asked_s = now_s
            if self.is_lost:
                self.is_lost = False
                self._notify(Severity.NOTICE, f"Compass: {self._part.name} answers again")
        elif now_s - self._heard_s > LOST_S and not self.is_lost:
            self.is_lost = True
            self._notify(Severity.WARNING, f"Compass: {self._part.name} is silent: {self._consequence}")
        return sample

    def _sample(self, now_s: float) -> Sample | None:
        if now_s < self._retry_s:
            return None
        try:
            sample = self._part.read()
            is_equal = sample is not None and sample == self._last
            self._equal = self._equal + 1 if is_equal else 0 if sample is not None else self._equal
            self._last = sample or self._last
            if now_s - self._asked_s > SILENT_S:
                self._asked_s = now_s
                _log.warning("%s: no new measurements; it is set up again", self._part.name)
                self._part.set_up()
        except OSError as error:
            if self.error is None:
                _log.warning("%s: %s; trying again", self._part.name, error)
            self.error, self._retry_s = error, now_s + RETRY_S
            return None
        self.error = None
        return sample if self._equal < STUCK else None


class MagneticCompass(BackgroundSensor[HeadingReading]):
    """Satisfies `companion.hal.interfaces.Compass`.

    Its north is magnetic. Without a gyro and accelerometer, or while these are lost, the boat is taken to be
    level, and no yaw rate is reported. The readings contain the field before correction, for the calibration.
    """

    def __init__(
        self,
        magnetometer: Magnetometer,
        inertial: InertialSensor | None,
        part: CompassPart,
        now: Callable[[], float],
        corrector: FieldCorrector,
        release: Callable[[], None] = lambda: None,
    ) -> None:
        """corrector: the live correction of the field."""
        super().__init__(self.step, "compass", now, release)
        self._field_part = _Watched(magnetometer, self.notify, "no heading", now())
        self._motion_part: _Watched[Motion] | None = None
        if inertial is not None:
            self._motion_part = _Watched(inertial, self.notify, "level, no turn rate", now())
        self._field_axes = board_to_body(part.mounting)
        self._motion_axes = board_to_body(part.imu_mounting)
        self._correction_rad = part.correction_rad
        self._corrector = corrector
        self._filter = AttitudeFilter()
        self._field: Vector = (0.0, 0.0, 0.0)
        self._field_s = -math.inf

    def step(self) -> float:
        """Read the parts once; returns the seconds to wait before the next reading."""
        began_s = self._now()
        has_moved = self._turn(began_s)
        has_field = self._point(began_s)
        motion = self._motion_part
        if has_moved:
            self._publish(began_s)
        elif has_field and (motion is None or motion.is_lost):
            self._publish_level(began_s)
        if self._field_part.error is not None and (motion is None or motion.error is not None):
            raise self._field_part.error  # the bus
        return max(0.0, PERIOD_S - (self._now() - began_s))

    def _turn(self, now_s: float) -> bool:
        motion = None if self._motion_part is None else self._motion_part.read(now_s)
        if motion is None:
            return False
        axes = self._motion_axes
        self._filter.turn(times(axes, motion.rate), times(axes, motion.force), now_s)
        return True

    def _point(self, now_s: float) -> bool:
        field = self._field_part.read(now_s)
        if field is None:
            return False
        self._field, self._field_s = times(self._field_axes, field), now_s
        is_calibrated = self._corrector.correction.is_calibrated
        self._filter.point(self._corrector.correct(self._field), now_s, is_calibrated=is_calibrated)
        return True

    def _publish(self, now_s: float) -> None:
        attitude = self._filter.attitude
        if attitude is None or now_s - self._field_s > LOST_S:
            return
        self._latest = HeadingReading(
            now_s,
            wrap_pi(attitude.heading_rad + self._correction_rad),
            attitude.yaw_rate_rad_s,
            attitude.roll_rad,
            attitude.pitch_rad,
            self._field,
            is_magnetic=True,
        )

    def _publish_level(self, now_s: float) -> None:
        """Without a gyro and accelerometer, or while they are lost."""
        heading_rad = magnetic_heading(self._corrector.correct(self._field), _LEVEL)
        if heading_rad is None:
            return
        heading_rad = wrap_pi(heading_rad + self._correction_rad)
        self._latest = HeadingReading(now_s, heading_rad, field_mg=self._field, is_magnetic=True)


def open_magnetic_compass(
    part: CompassPart,
    now: Callable[[], float],
    corrector: FieldCorrector,
    wait: Callable[[float], None] = time.sleep,
) -> MagneticCompass:
    """Open the parts on their I²C bus and start reading. wait: while a part starts.
    Raises HardwareError: smbus2 is missing, there is no bus, or a part does not answer.
    """
    bus = open_i2c(part.driver.upper(), part.i2c_bus)
    try:
        inertial: InertialSensor | None = None
        if part.imu != "none":  # first: it connects its auxiliary bus through
            inertial = _start(INERTIAL, part.imu, bus, part.imu_address, wait)
        magnetometer = _start(MAGNETOMETERS, part.driver, bus, part.address, wait)
    except HardwareError:
        bus.close()
        raise
    return MagneticCompass(magnetometer, inertial, part, now, corrector, bus.close).start()


def _start(
    kinds: Mapping[str, type[Chip[Sample]]],
    driver: str,
    bus: I2cBus,
    address: int,
    wait: Callable[[float], None],
) -> Chip[Sample]:
    part = kinds[driver](bus, address, wait)
    try:
        if found := part.identify():
            same_register = (one for one in kinds.values() if one.ID_AT == part.ID_AT)
            named = (f" ({one.name})" for one in same_register if not one(bus, part.address, wait).identify())
            told = found + next(named, "")
            raise HardwareError(f"{part.name}: the part at I²C address {part.address:#x} says {told}")
        part.set_up()
    except OSError as error:
        raise HardwareError(f"{part.name}: no answer at I²C address {part.address:#x}: {error}") from error
    return part
