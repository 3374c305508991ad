"""The parameters of a bare magnetometer, with ArduPilot's names and units. They hold its calibration, which
is stored with the other parameters.

They replace the table's constants of the same names, which stations need from parts that calibrate
themselves.
"""

from functools import partial
from typing import Final

import msgspec

from companion.config.parameter_values import MOTOR_SOURCES
from companion.config.parameters import ParameterHook, ParameterRow, ParameterType
from companion.core.vectors import Matrix, Vector
from companion.sensors.magnetic_field import FieldCorrector, MagneticCorrection

AXES: Final = "XYZ"
MOST_OFFSET_MG: Final = 1800.0  # ArduPilot's COMPASS_OFFS_MAX
DIAGONAL: Final = (0.2, 5.0)  # ArduPilot's limits of a fit
MOST_OFF_DIAGONAL: Final = 1.0
_SIDES: Final = ("ahead", "to starboard", "down")
_REAL: Final = ParameterType.REAL32


def compass_hooks(corrector: FieldCorrector) -> list[ParameterHook]:
    """Rows that set the corrector."""
    rows = [
        ParameterRow(
            "COMPASS_MOTCT",
            ParameterType.INT8,
            "What the motors' field is proportional to",
            low=0,
            high=2,
            values=MOTOR_SOURCES,
        )
    ]
    for axis, side in zip(AXES, _SIDES, strict=True):
        offset, diagonal = f"Added to the field {side}; calibrated", f"Factor of the field {side}; calibrated"
        beside, motor = (
            "Soft iron, beside the diagonal; calibrated",
            f"Field of the motors {side}; calibrated",
        )
        most, (low, high), off = MOST_OFFSET_MG, DIAGONAL, MOST_OFF_DIAGONAL
        rows += [
            ParameterRow(f"COMPASS_OFS_{axis}", _REAL, offset, unit="mGauss", low=-most, high=most),
            ParameterRow(f"COMPASS_DIA_{axis}", _REAL, diagonal, default=1.0, low=low, high=high),
            ParameterRow(f"COMPASS_ODI_{axis}", _REAL, beside, low=-off, high=off),
            ParameterRow(f"COMPASS_MOT_{axis}", _REAL, motor, unit="mGauss/A", low=-1000, high=1000),
        ]
    return [ParameterHook(row, partial(_apply, corrector, row.name)) for row in rows]


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
