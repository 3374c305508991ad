"""The correction of a magnetometer for the boat's own iron and motors.

In ArduPilot's order and signs (COMPASS_OFS, _DIA, _ODI, _MOT): the offset is added to the measured field, the
symmetric matrix is applied, then the motors' field is added, which is proportional to their load.
"""

from functools import partial
from typing import Final

import msgspec
from msgspec import Struct

from companion.config.compass_rows import AXES, MAGNETOMETER_ROWS
from companion.config.parameters import ParameterHook
from companion.core.vectors import UNIT, ZERO, Matrix, Vector, plus, times

NO_MOTORS, BY_THROTTLE, BY_CURRENT = 0, 1, 2  # COMPASS_MOTCT


class MagneticCorrection(Struct, frozen=True):
    """offset: mG, added. matrix: symmetric, applied to the sum. motor: mG per ampere or per full throttle,
    by motor_source, added.
    """

    offset: Vector = ZERO
    matrix: Matrix = UNIT
    motor: Vector = ZERO
    motor_source: int = NO_MOTORS

    @property
    def is_calibrated(self) -> bool:
        """Whether the correction for iron has been set."""
        return self.offset != ZERO

    def iron_corrected(self, field: Vector) -> Vector:
        """The field without the boat's iron."""
        return times(self.matrix, plus(field, self.offset))


NO_CORRECTION: Final = MagneticCorrection()


class MotorLoad(Struct, frozen=True):
    """What the motors draw. throttle: mean of both, 0..1; current_a: None if not measured."""

    throttle: float = 0.0
    current_a: float | None = None

    def of(self, source: int) -> float:
        """The load in the unit of a source; 0 where it is not measured."""
        if source == BY_THROTTLE:
            return self.throttle
        return self.current_a or 0.0 if source == BY_CURRENT else 0.0


NO_LOAD: Final = MotorLoad()


class FieldCorrector:
    """The live correction, set by the boat's thread, used by the driver's; replaced whole."""

    def __init__(self) -> None:
        self.correction = NO_CORRECTION
        self.load = MotorLoad()

    def correct(self, field: Vector) -> Vector:
        """The field of the earth alone. Called by the driver."""
        correction = self.correction
        return plus(correction.iron_corrected(field), correction.motor, self.load.of(correction.motor_source))


def compass_hooks(corrector: FieldCorrector) -> list[ParameterHook]:
    """Rows that set the corrector."""
    return [ParameterHook(row, partial(_apply, corrector, row.name)) for row in MAGNETOMETER_ROWS]


def parameter_values(correction: MagneticCorrection) -> list[tuple[str, float]]:
    matrix = correction.matrix
    off_diagonal = (matrix[0][1], matrix[0][2], matrix[1][2])
    values = [("COMPASS_MOTCT", float(correction.motor_source))]
    for at, axis in enumerate(AXES):
        values += [
            (f"COMPASS_OFS_{axis}", correction.offset[at]),
            (f"COMPASS_DIA_{axis}", matrix[at][at]),
            (f"COMPASS_ODI_{axis}", off_diagonal[at]),
            (f"COMPASS_MOT_{axis}", correction.motor[at]),
        ]
    return values


def _apply(corrector: FieldCorrector, name: str, value: float) -> None:
    correction = corrector.correction
    group, at = name.split("_")[1], AXES.find(name[-1])
    match group:
        case "OFS":
            changed = msgspec.structs.replace(correction, offset=_with(correction.offset, at, value))
        case "MOT":
            changed = msgspec.structs.replace(correction, motor=_with(correction.motor, at, value))
        case "MOTCT":
            changed = msgspec.structs.replace(correction, motor_source=round(value))
        case "DIA":
            changed = msgspec.structs.replace(correction, matrix=_symmetric(correction.matrix, at, at, value))
        case _:
            row, column = ((0, 1), (0, 2), (1, 2))[at]
            matrix = _symmetric(correction.matrix, row, column, value)
            changed = msgspec.structs.replace(correction, matrix=matrix)
    corrector.correction = changed


def _with(vector: Vector, at: int, value: float) -> Vector:
    x, y, z = (value if here == at else one for here, one in enumerate(vector))
    return x, y, z


def _symmetric(matrix: Matrix, row: int, column: int, value: float) -> Matrix:
    rows = list(matrix)
    rows[row] = _with(rows[row], column, value)
    rows[column] = _with(rows[column], row, value)
    return rows[0], rows[1], rows[2]
