"""What the estimator says is wrong with position and heading."""

from typing import TYPE_CHECKING

from companion.config import Motors
from companion.state import EstimateFault, NavState

if TYPE_CHECKING:
    from companion.vehicle.failsafes.signs import Signs

_POSITION = int(EstimateFault.POSITION_LOST)
_HEADING = int(EstimateFault.HEADING_LOST)
_FROZEN = int(EstimateFault.GNSS_FROZEN)
_JUMPING = int(EstimateFault.GNSS_JUMPING)
_GNSS = int(EstimateFault.GNSS_LOST) | _FROZEN | _JUMPING
_COMPASS_OFF = int(EstimateFault.COMPASS_OFF)
_COMPASS = int(EstimateFault.COMPASS_LOST) | _COMPASS_OFF


def lacks_position(nav: NavState, setting: Motors) -> bool:
    """Whether the position is too uncertain to sail by.

    An estimator that names the trouble says so itself, and reckons on until then; an old position without a
    reason given is old.
    """
    if nav.faults & _GNSS:
        return bool(nav.faults & _POSITION)
    return bool(nav.faults & _POSITION) or not nav.position_age_s <= setting.estimate_timeout_s


def lacks_heading(nav: NavState, setting: Motors) -> bool:
    """Whether nothing says where the bow points."""
    if nav.faults & _COMPASS:
        return bool(nav.faults & _HEADING)
    return bool(nav.faults & _HEADING) or not nav.heading_age_s <= setting.estimate_timeout_s


def position_lost(signs: "Signs") -> str:
    """The position can no longer be sailed by."""
    nav = signs.nav
    return "Position lost" if nav is not None and lacks_position(nav, signs.config.motors) else ""


def heading_lost(signs: "Signs") -> str:
    """The heading can no longer be steered by."""
    nav = signs.nav
    return "Heading lost" if nav is not None and lacks_heading(nav, signs.config.motors) else ""


def gnss_bad(signs: "Signs") -> str:
    """The receiver is silent, says the same again and again, or what cannot be."""
    nav = signs.nav
    if nav is None or not nav.faults & _GNSS:
        return ""
    if nav.faults & _FROZEN:
        return "GPS frozen, dead reckoning"
    return "GPS jumping, dead reckoning" if nav.faults & _JUMPING else "GPS lost, dead reckoning"


def compass_bad(signs: "Signs") -> str:
    """The compass is silent or stuck, or disagrees with the way that the boat goes."""
    nav = signs.nav
    if nav is None or not nav.faults & _COMPASS:
        return ""
    return "Compass disagrees with the course" if nav.faults & _COMPASS_OFF else "Compass lost"
