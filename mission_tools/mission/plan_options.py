"""What a user asks of a route."""

from dataclasses import dataclass

from companion.core.geo import LatLon


@dataclass(frozen=True, slots=True)
class PlanOptions:
    """The route options of the command line; None where not given."""

    start_at: LatLon | None = None
    goal: LatLon | None = None
    case: str | None = None
    clearance_m: float | None = None
    cell_m: float | None = None
    heuristic: str | None = None
    smooth: bool | None = None
    speed_m_s: float | None = None
