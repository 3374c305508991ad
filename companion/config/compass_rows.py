"""The parameters of a bare magnetometer, with ArduPilot's names and units: its calibration.

With such a compass they replace the table's constants of the same names, which stations need from parts that
calibrate themselves.
"""

from typing import Final

from companion.config.parameter_values import MOTOR_SOURCES
from companion.config.parameters import ParameterRow, ParameterType

AXES: Final = "XYZ"
MOST_OFFSET_MG: Final = 1800.0  # ArduPilot's COMPASS_OFFS_MAX
DIAGONAL: Final = (0.2, 5.0)  # ArduPilot's limits of a fit
MOST_OFF_DIAGONAL: Final = 1.0
MOST_MOTOR_MG: Final = 1000.0
_SIDES: Final = ("ahead", "to starboard", "down")
_REAL: Final = ParameterType.REAL32


def _axis_rows(axis: str, side: str) -> list[ParameterRow]:
    offset, diagonal = f"Added to the field {side}; calibrated", f"Factor of the field {side}; calibrated"
    beside, motor = "Soft iron, beside the diagonal; calibrated", f"Field of the motors {side}; calibrated"
    most, (low, high), off, motor_mg = MOST_OFFSET_MG, DIAGONAL, MOST_OFF_DIAGONAL, MOST_MOTOR_MG
    return [
        ParameterRow(f"COMPASS_OFS_{axis}", _REAL, offset, unit="mGauss", low=-most, high=most),
        ParameterRow(f"COMPASS_DIA_{axis}", _REAL, diagonal, default=1.0, low=low, high=high),
        ParameterRow(f"COMPASS_ODI_{axis}", _REAL, beside, low=-off, high=off),
        ParameterRow(f"COMPASS_MOT_{axis}", _REAL, motor, unit="mGauss/A", low=-motor_mg, high=motor_mg),
    ]


MAGNETOMETER_ROWS: tuple[ParameterRow, ...] = (
    ParameterRow(
        "COMPASS_MOTCT",
        ParameterType.INT8,
        "What the motors' field is proportional to",
        low=0,
        high=2,
        values=MOTOR_SOURCES,
    ),
    *(row for axis, side in zip(AXES, _SIDES, strict=True) for row in _axis_rows(axis, side)),
)
