"""What is wrong with the estimate, in words for the operator."""

from typing import Final

from companion.state import EstimateFault

FAULT_TEXTS: Final[tuple[tuple[EstimateFault, str], ...]] = (
    (EstimateFault.POSITION_LOST, "Position lost"),
    (EstimateFault.HEADING_LOST, "Heading lost"),
    (EstimateFault.GNSS_LOST, "GPS lost: dead reckoning"),
    (EstimateFault.GNSS_FROZEN, "GPS frozen: dead reckoning"),
    (EstimateFault.GNSS_JUMPING, "GPS jumping: not believed"),
    (EstimateFault.COMPASS_LOST, "Compass lost: gyro and course"),
    (EstimateFault.COMPASS_OFF, "Compass off: gyro and course"),
)
"""Worst first; each fits one STATUSTEXT with room for a prefix."""


def fault_texts(faults: int) -> list[str]:
    """A line for each bit of EstimateFault that is set, worst first; empty when nothing is wrong."""
    return [text for fault, text in FAULT_TEXTS if faults & fault] if faults else []
