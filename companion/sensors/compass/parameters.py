"""A magnetometer's correction as parameters, which are stored with the others."""

from functools import partial

import msgspec

from companion.config.compass_rows import AXES, MAGNETOMETER_ROWS
from companion.config.parameters import ParameterHook
from companion.core.vectors import Matrix, Vector
from companion.sensors.compass.magnetic_field import FieldCorrector, MagneticCorrection


def compass_hooks(corrector: FieldCorrector) -> list[ParameterHook]:
    """Rows that set the corrector."""
    return [ParameterHook(row, partial(_apply, corrector, row.name)) for row in MAGNETOMETER_ROWS]


def parameter_values(correction: MagneticCorrection) -> list[tuple[str, float]]:
    """The parameters of a correction."""
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
