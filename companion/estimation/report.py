"""The filter's inside, for log, reports and consistency tests."""

from msgspec import Struct

from companion.estimation.covariance import STATE_NAMES
from companion.estimation.error_state import ErrorStateFilter
from companion.estimation.innovation import Innovation


class EstimatorReport(Struct, frozen=True):
    """state: as in `covariance.STATE_NAMES`; covariance: of its error, row by row. hypotheses: name and
    probability.
    """

    state: tuple[float, ...]
    covariance: tuple[tuple[float, ...], ...]
    position_north: Innovation
    position_east: Innovation
    velocity_north: Innovation
    velocity_east: Innovation
    compass: Innovation
    gyro: Innovation
    hypotheses: tuple[tuple[str, float], ...] = ()


def report_of(state: ErrorStateFilter, hypotheses: tuple[tuple[str, float], ...] = ()) -> EstimatorReport:
    """The present inside of a filter."""
    yaw = state.yaw_model
    return EstimatorReport(
        tuple(getattr(state, name) for name in STATE_NAMES),
        tuple(tuple(row) for row in state.covariance.rows),
        state.position_north,
        state.position_east,
        state.velocity_north,
        state.velocity_east,
        state.compass,
        Innovation(state.turned_s, yaw.innovation_rad_s, yaw.variance, is_accepted=True),
        hypotheses,
    )
