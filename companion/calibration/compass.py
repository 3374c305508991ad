"""Calibration of a magnetometer for the boat's hard and soft iron, from readings in all directions.

A boat on the water can only be turned about the vertical. The levelled field then runs along an ellipse,
which gives the offset and the soft iron in the plane of the deck; the vertical offset follows from the
earth's field, where it is known. A boat that is small enough to be turned in the hands about all axes gives
the ellipsoid. The largest heel decides between the two.

The fit is accepted if the field's strength is that of the earth, the remaining error (RMS, as ArduPilot's
fitness) is small, and the field turned as far as the gyro.
"""

import math
from collections import deque
from enum import IntEnum
from statistics import fmean
from typing import Final, NamedTuple

from companion.calibration.ellipsoid import Ellipsoid, Point, fit_ellipsoid
from companion.config.compass_rows import DIAGONAL, MOST_OFF_DIAGONAL, MOST_OFFSET_MG
from companion.core.readings import HeadingReading
from companion.core.units import wrap_pi
from companion.core.vectors import Vector, length, plus
from companion.sensors.compass.attitude import down_axis, level_field
from companion.sensors.compass.earth_field import EarthField
from companion.sensors.compass.magnetic_field import NO_LOAD, MagneticCorrection, MotorLoad

TIMEOUT_S: Final = 600.0
SECTORS: Final = 24
_SECTORS_NEEDED: Final = 22
_CELLS_NEEDED: Final = 20  # of 24 parts of the sphere, four on each face of a cube
_LEVEL_RAD: Final = math.radians(20.0)  # heel up to which the boat is on the water
_LEAST_SAMPLES: Final = {2: 72, 3: 150}
_MOST_SAMPLES: Final = 320  # bounds the time of the fit
_APART_MG: Final = 4.0  # between two samples; the noise of a part is about 2 mG
_RING: Final = (0.75, 1.25)  # soft iron of a fifth makes a circle an ellipse between 0.9 and 1.1
_LOADS: Final = 3000  # a minute
_REVIEW_S: Final = 0.5  # between two looks at the coverage
# WMM: no compass works below 20 mG, and it is poor below 60 mG; the strongest horizontal field is 420 mG.
# The limits of the whole field are ArduPilot's
_HORIZONTAL_MG: Final = (40.0, 600.0)
_WHOLE_MG: Final = (150.0, 950.0)
_EARTH_RATIO: Final = (0.6, 1.6)  # of the strength measured to that of the model
_TURN_RATIO: Final = (0.7, 1.4)  # of the field's turn to the gyro's
_LEAST_TURN_RAD: Final = 2.0


class CompassVerdict(IntEnum):
    """MAVLink's MAG_CAL_STATUS, as far as used."""

    RUNNING = 2
    SUCCESS = 4
    FAILED = 5
    BAD_ORIENTATION = 6
    BAD_RADIUS = 7


class FieldFit(NamedTuple):
    """The result. fitness_mg: RMS error left over. reason: for the operator, empty on success."""

    verdict: CompassVerdict
    reason: str
    correction: MagneticCorrection
    fitness_mg: float = 0.0
    radius_mg: float = 0.0


class _Sample(NamedTuple):
    field: Vector  # in body axes
    level: Vector  # the same in level axes
    turned_rad: float | None  # by the gyro, since the start


class CompassCalibration:
    """Collects readings until they cover the circle or the sphere. `is_complete`: then call `solve`."""

    def __init__(self, before: MagneticCorrection, earth: EarthField | None, now_s: float) -> None:
        """before: the present correction; the motors' part is kept."""
        self.progress_percent = 0
        self.loads: deque[MotorLoad] = deque(maxlen=_LOADS)
        self.is_complete = False
        self._before = before
        self._earth = earth
        self._began_s = now_s
        self._samples: list[_Sample] = []
        self._reading_s = -math.inf
        self._turned_rad: float | None = None
        self._is_level = True
        self._review_s = now_s

    @property
    def dimensions(self) -> int:
        """2 for a boat on the water, 3 for one turned in the hands."""
        return 2 if self._is_level else 3

    def is_late(self, now_s: float) -> bool:
        """Whether it has taken too long."""
        return now_s - self._began_s > TIMEOUT_S

    def update(self, reading: HeadingReading | None, now_s: float, load: MotorLoad = NO_LOAD) -> None:
        """Add the latest reading. load: what the motors draw."""
        if reading is None or reading.field_mg is None or reading.time_s <= self._reading_s:
            return
        dt_s, self._reading_s = reading.time_s - self._reading_s, reading.time_s
        if reading.yaw_rate_rad_s is not None:
            since_rad = reading.yaw_rate_rad_s * dt_s if math.isfinite(dt_s) else 0.0
            self._turned_rad = (self._turned_rad or 0.0) + since_rad
        before = self._before
        # The motors' field is not iron; their part of the matrix's few percent is left out
        self._add(reading, plus(reading.field_mg, before.motor, load.of(before.motor_source)))
        self.loads.append(load)
        if now_s >= self._review_s:
            self._review_s = now_s + _REVIEW_S
            self._review()

    def _add(self, reading: HeadingReading, field: Vector) -> None:
        roll, pitch = reading.roll_rad or 0.0, reading.pitch_rad or 0.0
        self._is_level = self._is_level and max(abs(roll), abs(pitch)) <= _LEVEL_RAD
        samples = self._samples
        if samples and length(plus(field, samples[-1].field, -1.0)) < _APART_MG:
            return
        level = level_field(field, down_axis(roll, pitch))
        if level is None:
            return
        samples.append(_Sample(field, level, self._turned_rad))
        if len(samples) > _MOST_SAMPLES:
            del samples[::2]

    def _points(self) -> list[Point]:
        if self._is_level:
            return [sample.level[:2] for sample in self._samples]
        return [sample.field for sample in self._samples]

    def _review(self) -> None:
        points = self._points()
        covered = _sectors(points) / _SECTORS_NEEDED if self._is_level else _cells(points) / _CELLS_NEEDED
        share = min(covered, len(points) / _LEAST_SAMPLES[self.dimensions], 1.0)
        self.is_complete = self.is_complete or share >= 1.0
        self.progress_percent = max(self.progress_percent, int(100.0 * share))

    def solve(self, most_fitness_mg: float) -> FieldFit:
        """The correction, or why there is none. most_fitness_mg: ArduPilot's COMPASS_CAL_FIT."""
        found = fit_ellipsoid(self._points())
        if found is None:
            return self.failed("no ellipse fits")
        radius, dimensions = found.radius, self.dimensions
        low, high = _HORIZONTAL_MG if dimensions == 2 else _WHOLE_MG
        if not low <= radius <= high:
            return self.failed(f"field of {radius:.0f} mG", CompassVerdict.BAD_RADIUS)
        earth = self._earth
        wanted = radius
        if earth is not None:
            wanted = (
                earth.horizontal_mg if dimensions == 2 else math.hypot(earth.horizontal_mg, earth.down_mg)
            )
            if not _EARTH_RATIO[0] <= radius / wanted <= _EARTH_RATIO[1]:
                told = f"field of {radius:.0f} mG, the earth's is {wanted:.0f} mG"
                return self.failed(told, CompassVerdict.BAD_RADIUS)
        fitness = radius * math.sqrt(fmean((found.distance(point) - 1.0) ** 2 for point in self._points()))
        fit = FieldFit(CompassVerdict.SUCCESS, "", self._correction(found, wanted), fitness, radius)
        if not self._turns_with_gyro(fit.correction):
            return self.failed("turns against the gyro: check the mounting", CompassVerdict.BAD_ORIENTATION)
        if reason := _limits_fault(fit.correction):
            return self.failed(reason)
        if fitness > most_fitness_mg:
            return fit._replace(
                verdict=CompassVerdict.FAILED, reason=f"error of {fitness:.0f} mG is too large"
            )
        return fit

    def failed(self, reason: str, verdict: CompassVerdict = CompassVerdict.FAILED) -> FieldFit:
        """A result that changes nothing."""
        return FieldFit(verdict, reason, self._before)

    def _correction(self, found: Ellipsoid, radius: float) -> MagneticCorrection:
        rows = [[radius * value for value in row] for row in found.shape]
        centre = found.centre
        before = self._before
        if len(centre) == 3:
            matrix = (tuple(rows[0]), tuple(rows[1]), tuple(rows[2]))
            offset = (-centre[0], -centre[1], -centre[2])
            return MagneticCorrection(offset, matrix, before.motor, before.motor_source)  # type: ignore[arg-type]
        down = before.offset[2]
        if self._earth is not None:
            down = self._earth.down_mg - fmean(sample.level[2] for sample in self._samples)
        (a, b), (c, d) = rows
        return MagneticCorrection(
            (-centre[0], -centre[1], down),
            ((a, b, 0.0), (c, d, 0.0), (0.0, 0.0, 1.0)),
            before.motor,
            before.motor_source,
        )

    def _turns_with_gyro(self, correction: MagneticCorrection) -> bool:
        """Whether the corrected field turns as far as the gyro; True without a gyro or a turn."""
        if not self._is_level:
            return True
        both = square = 0.0
        headings = [_heading(correction.iron_corrected(sample.level)) for sample in self._samples]
        pairs = zip(headings, self._samples, headings[1:], self._samples[1:], strict=False)
        total = 0.0
        for heading_a, a, heading_b, b in pairs:
            if a.turned_rad is None or b.turned_rad is None:
                return True
            gyro_rad = b.turned_rad - a.turned_rad
            if abs(gyro_rad) > math.pi / 2.0:
                continue
            both += gyro_rad * wrap_pi(heading_b - heading_a)
            square += gyro_rad * gyro_rad
            total += abs(gyro_rad)
        return total < _LEAST_TURN_RAD or _TURN_RATIO[0] <= both / square <= _TURN_RATIO[1]


def _heading(field: Vector) -> float:
    return math.atan2(-field[1], field[0])


def _limits_fault(correction: MagneticCorrection) -> str:
    """Why a correction is not plausible, empty if it is."""
    matrix = correction.matrix
    if max(map(abs, correction.offset)) > MOST_OFFSET_MG:
        return "iron or a magnet is too near: move the compass"
    if not all(DIAGONAL[0] <= matrix[at][at] <= DIAGONAL[1] for at in range(3)):
        return "soft iron is too near: move the compass"
    if max(abs(matrix[0][1]), abs(matrix[0][2]), abs(matrix[1][2])) > MOST_OFF_DIAGONAL:
        return "soft iron is too near: move the compass"
    return ""


def _ring(points: list[Point]) -> list[list[float]]:
    """Points in the box that holds them all, from −1 to 1 on each axis, as far as they lie near its inscribed
    circle or sphere: those of an arc mostly do not. None while the box is too small to be more than noise.
    """
    sides = [(min(axis), max(axis)) for axis in zip(*points, strict=True)]
    if not sides or min(high - low for low, high in sides) < _HORIZONTAL_MG[0]:
        return []
    placed = [
        [(2.0 * p - low - high) / (high - low) for p, (low, high) in zip(point, sides, strict=True)]
        for point in points
    ]
    return [point for point in placed if _RING[0] < math.hypot(*point) < _RING[1]]


def _sectors(points: list[Point]) -> int:
    """Number of covered sectors of the circle."""
    turns = [math.atan2(y, x) / (2.0 * math.pi) for x, y in _ring(points)]
    return len({int((turn + 0.5) * SECTORS) % SECTORS for turn in turns})


def _cells(points: list[Point]) -> int:
    """Number of covered quarters of the faces of a cube."""
    covered = set()
    for point in _ring(points):
        face = max(range(3), key=lambda at: abs(point[at]))
        others = [value >= 0.0 for at, value in enumerate(point) if at != face]
        covered.add((face, point[face] >= 0.0, *others))
    return len(covered)
