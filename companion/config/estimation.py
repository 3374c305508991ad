"""Configuration of the estimator."""

import math
from typing import Annotated

from msgspec import Meta

from companion.config.section import NonNegative, Positive, Section, Share


class Estimation(Section, frozen=True):
    """Time constants and uncertainties. Those that scale with the boat are shares of its cruise speed."""

    gnss_timeout_s: Positive = 1.5  # silence after which the receiver is lost
    compass_timeout_s: Positive = 1.5
    dead_reckoning_s: NonNegative = 60.0  # longest dead reckoning
    lost_sigma_m: Positive = 10.0  # uncertainty at which the position is lost
    surge_time_s: Positive = 3.0  # response time of the hull to thrust, at cruise speed
    wander_s: Positive = 60.0  # time constant of the receiver's drift,
    wander_share: Share = 0.8  # and its share of the error; the rest is white
    compass_doubt_rad: Annotated[float, Meta(gt=0.0, le=math.pi)] = 0.035  # residual error after calibration
    compass_gate_rad: Annotated[float, Meta(gt=0.0, le=math.pi)] = 0.26  # largest difference from the gyro
