"""Configuration of the ranger that looks for obstacles."""

import math
from typing import Annotated, Final, Literal

from msgspec import Meta

from companion.config.board import OptionalPin, Pin
from companion.config.section import NonNegative, Positive, Section

# Least and greatest range by the data sheets: Elecfreaks HC-SR04; JSN-SR04T (blind 25 cm); DFRobot SEN0311
# (A02YYUW); Benewake TFmini Plus and TFmini-S
RANGES_M: Final = {
    "hcsr04": (0.02, 4.0),
    "jsnsr04t": (0.25, 4.5),
    "a02yyuw": (0.03, 4.5),
    "tfmini": (0.1, 12.0),
    "none": (0.02, 4.0),
}


class RangerPart(Section, frozen=True):
    """A ranger, fixed or on a sweeping servo: ultrasonic with trigger and echo pins (HC-SR04, JSN-SR04T) or
    on a serial port (A02YYUW), or a lidar on a serial port (TFmini).
    """

    driver: Literal["hcsr04", "jsnsr04t", "a02yyuw", "tfmini", "none"] = "none"
    trigger: Pin = 23
    echo: Pin = 24
    port: str = "/dev/ttyUSB1"
    min_strength: Annotated[int, Meta(ge=0, le=65534)] = 100  # of a lidar's echo; the first TFmini: 20
    servo: OptionalPin = -1  # −1: fixed ahead
    sweep_rad: Annotated[float, Meta(ge=0.0, le=math.pi)] = math.pi
    step_rad: Positive = math.radians(15.0)
    min_range_m: NonNegative = 0.0  # nothing closer is seen; 0: that of the data sheet
    max_range_m: NonNegative = 0.0  # 0: that of the data sheet
    air_c: Annotated[float, Meta(ge=-40.0, le=60.0)] = 15.0  # with echo pins; 10 °C are 1.8 % of the range

    def __post_init__(self) -> None:
        super().__post_init__()
        least_m, greatest_m = self.range_m
        if least_m >= greatest_m:
            raise ValueError(
                f"min_range_m = {least_m:g}: expected less than the greatest range, {greatest_m:g}"
            )

    @property
    def range_m(self) -> tuple[float, float]:
        """The least and the greatest range."""
        least_m, greatest_m = RANGES_M[self.driver]
        return self.min_range_m or least_m, self.max_range_m or greatest_m

    @property
    def is_laser(self) -> bool:
        """Whether it measures with light."""
        return self.driver == "tfmini"
