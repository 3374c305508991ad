"""The correction of a magnetometer for the boat's own iron and motors.

In ArduPilot's order and signs (COMPASS_OFS, _DIA, _ODI, _MOT): the offset is added to the measured field, the
symmetric matrix is applied, then the motors' field is added, which is proportional to their load.
"""

from typing import Final

from msgspec import Struct

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
    """The live correction: set by the boat's thread, used by the driver's. Both attributes are replaced
    whole.
    """

    def __init__(self) -> None:
        self.correction = NO_CORRECTION
        self.load = MotorLoad()

    def correct(self, field: Vector) -> Vector:
        """The field of the earth alone. Called by the driver."""
        correction = self.correction
        return plus(correction.iron_corrected(field), correction.motor, self.load.of(correction.motor_source))
