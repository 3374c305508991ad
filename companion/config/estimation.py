"""How the estimate is made, and when it is given up."""

import math
from typing import Annotated

from msgspec import Meta

from companion.config.section import NonNegative, Positive, Section, Share


class Estimation(Section, frozen=True):
    """Times and doubts of the estimator. What depends on the boat's size is in shares of its cruise speed."""

    gnss_timeout_s: Positive = 1.5  # a receiver that is silent for this long is lost
    compass_timeout_s: Positive = 1.5
    dead_reckoning_s: NonNegative = 60.0  # without a fix the position is lost after this
    lost_sigma_m: Positive = 10.0  # or once it is as uncertain as this
    surge_time_s: Positive = 3.0  # how fast the hull takes up a change of thrust, at cruise speed
    wander_s: Positive = 60.0  # how slowly a receiver's error wanders,
    wander_share: Share = 0.8  # and its share of the whole; the rest is white
    compass_doubt_rad: Annotated[float, Meta(gt=0.0, le=math.pi)] = 0.035  # what calibration leaves over
    compass_gate_rad: Annotated[float, Meta(gt=0.0, le=math.pi)] = 0.26  # off the gyro: not believed
