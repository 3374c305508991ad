"""Turn rate as a moving heading set-point; it stops ahead of a bow that does not keep up."""

from companion.core.state import NavState
from companion.core.units import clamp, wrap_pi

MAX_LEAD_RAD = 1.0  # beyond the saturation of the heading loop


class Turning:
    """Keeps the heading set-point; None before the first update."""

    __slots__ = ("_heading_rad",)

    def __init__(self) -> None:
        self._heading_rad: float | None = None

    def reset(self) -> None:
        """Start again at the present heading."""
        self._heading_rad = None

    def update(self, yaw_rate_rad_s: float, nav: NavState, dt_s: float) -> float:
        """The heading for this tick, in [−π, π). At rate 0 it is constant."""
        heading = nav.heading_rad if self._heading_rad is None else self._heading_rad
        lead = wrap_pi(heading + yaw_rate_rad_s * dt_s - nav.heading_rad)
        self._heading_rad = heading = wrap_pi(nav.heading_rad + clamp(lead, -MAX_LEAD_RAD, MAX_LEAD_RAD))
        return heading
