"""Faults of the estimate, as text for the operator, and whether it is usable."""

from typing import Final

from companion.core.state import EstimateFault, NavState

FAULT_TEXTS: Final[tuple[tuple[EstimateFault, str], ...]] = (
    (EstimateFault.POSITION_LOST, "Position lost"),
    (EstimateFault.HEADING_LOST, "Heading lost"),
    (EstimateFault.GNSS_LOST, "GPS lost: dead reckoning"),
    (EstimateFault.GNSS_FROZEN, "GPS frozen: dead reckoning"),
    (EstimateFault.GNSS_JUMPING, "GPS jumping: rejected"),
    (EstimateFault.COMPASS_LOST, "Compass lost: using gyro and course"),
    (EstimateFault.COMPASS_OFF, "Compass off: using gyro and course"),
    (EstimateFault.GNSS_LATE, "GPS late: compensated"),
    (EstimateFault.COMPASS_LATE, "Compass late: using yaw model"),
)
"""Worst first; each fits one STATUSTEXT with room for a prefix."""

# Plain numbers: an IntFlag's arithmetic costs microseconds
_POSITION_LOST: Final = int(EstimateFault.POSITION_LOST)
_HEADING_LOST: Final = int(EstimateFault.HEADING_LOST)


def fault_texts(faults: int) -> list[str]:
    """A line for each bit of EstimateFault, worst first; empty without a fault."""
    return [text for fault, text in FAULT_TEXTS if faults & fault] if faults else []


def lacks_position(nav: NavState, timeout_s: float) -> bool:
    """Whether the position is too old or too uncertain. During dead reckoning its age is held until the
    estimator gives up.
    """
    return bool(nav.faults & _POSITION_LOST) or not nav.position_age_s <= timeout_s


def lacks_heading(nav: NavState, timeout_s: float) -> bool:
    """Whether there is no heading. The course over ground alone is not one: it cannot hold a boat on a
    heading.
    """
    return bool(nav.faults & _HEADING_LOST) or not nav.heading_age_s <= timeout_s
