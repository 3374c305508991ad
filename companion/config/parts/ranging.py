"""Configuration of the rangers."""

import math
from typing import Annotated, Literal

from msgspec import Meta

from companion.config.section import Positive, Section


class SonarPart(Section, frozen=True):
    """HC-SR04 ranger, fixed or on a sweeping servo."""

    driver: Literal["hcsr04", "none"] = "none"
    trigger: int = 23
    echo: int = 24
    servo: int = -1  # −1: fixed ahead
    sweep_rad: Annotated[float, Meta(ge=0.0, le=math.pi)] = math.pi
    step_rad: Positive = math.radians(15.0)
    max_range_m: Positive = 4.0
