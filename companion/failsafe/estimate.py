"""What the estimator says is wrong with position and heading."""

from typing import TYPE_CHECKING

from companion.core.health import fault_texts, lacks_heading, lacks_position
from companion.core.state import EstimateFault

if TYPE_CHECKING:
    from companion.failsafe.inputs import FailsafeInputs

_GNSS = int(
    EstimateFault.GNSS_LOST | EstimateFault.GNSS_FROZEN | EstimateFault.GNSS_JUMPING | EstimateFault.GNSS_LATE
)
_COMPASS = int(EstimateFault.COMPASS_LOST | EstimateFault.COMPASS_OFF | EstimateFault.COMPASS_LATE)


def position_lost(signs: "FailsafeInputs") -> str:
    """The position can no longer be sailed by."""
    nav, timeout_s = signs.nav, signs.config.motors.estimate_timeout_s
    return "Position lost" if nav is not None and lacks_position(nav, timeout_s) else ""


def heading_lost(signs: "FailsafeInputs") -> str:
    """The heading can no longer be steered by."""
    nav, timeout_s = signs.nav, signs.config.motors.estimate_timeout_s
    return "Heading lost" if nav is not None and lacks_heading(nav, timeout_s) else ""


def gnss_bad(signs: "FailsafeInputs") -> str:
    """The receiver is silent, late, says the same again and again, or what cannot be."""
    return _worst(signs, _GNSS)


def compass_bad(signs: "FailsafeInputs") -> str:
    """The compass is silent, late or stuck, or disagrees with the way that the boat goes."""
    return _worst(signs, _COMPASS)


def _worst(signs: "FailsafeInputs", of: int) -> str:
    nav = signs.nav
    return "" if nav is None or not nav.faults & of else fault_texts(nav.faults & of)[0]
