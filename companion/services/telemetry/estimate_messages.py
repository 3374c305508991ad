"""Telemetry of the estimate: its quality, and the current."""

from companion.autopilot.snapshot import Snapshot
from companion.core.state import COMPASS_FAULTS, EstimateFault
from companion.mavlink.dialect import Message, build_message, dialect

_GNSS_BAD = EstimateFault.GNSS_LOST | EstimateFault.GNSS_FROZEN | EstimateFault.GNSS_JUMPING
_GLITCH = EstimateFault.GNSS_FROZEN | EstimateFault.GNSS_JUMPING
_SHAKEN = 0.8  # where stations turn a bar yellow: a substitute source is in use
_RELATIVE_FLAGS = dialect.EKF_VELOCITY_HORIZ | dialect.EKF_POS_HORIZ_REL | dialect.EKF_PRED_POS_HORIZ_REL
_ABSOLUTE_FLAGS = dialect.EKF_POS_HORIZ_ABS | dialect.EKF_PRED_POS_HORIZ_ABS
_CURRENT_NAME = b"CURRENT"


def _health(now: Snapshot) -> tuple[int, float, float]:
    """Flags, and the state of position and heading from 0 to 1 (lost).

    ESTIMATOR_STATUS_FLAGS and EKF_STATUS_FLAGS have the same bits up to EKF_PRED_POS_HORIZ_ABS.
    """
    nav, config = now.vehicle.nav, now.config
    if nav is None:
        return 0, 1.0, 1.0
    faults, timeout_s = nav.faults, config.motors.estimate_timeout_s
    position = min(nav.position_age_s / timeout_s, 1.0)
    position = max(position, min(nav.position_sigma_m / config.estimation.lost_sigma_m, 1.0))
    heading = min(nav.heading_age_s / timeout_s, 1.0)
    if faults & EstimateFault.POSITION_LOST:
        position = 1.0
    if faults & EstimateFault.HEADING_LOST:
        heading = 1.0
    elif faults & COMPASS_FAULTS & ~EstimateFault.COMPASS_LATE:
        heading = max(heading, _SHAKEN)
    flags = dialect.EKF_ATTITUDE if heading < 1.0 else 0
    if position < 1.0:
        flags |= _RELATIVE_FLAGS | _ABSOLUTE_FLAGS
        if faults & _GNSS_BAD:
            flags &= ~dialect.EKF_POS_HORIZ_ABS  # dead reckoning
            position = max(position, _SHAKEN)
    return flags, position, heading


def ekf_status_report(now: Snapshot) -> Message:
    """Which parts of the estimate are usable.

    The variances are normalised: 1 is the limit used by stations and the boat.
    """
    flags, position, heading = _health(now)
    if now.vehicle.frame is None:
        flags |= dialect.EKF_UNINITIALIZED
    elif now.vehicle.nav is not None and now.vehicle.nav.faults & _GLITCH:
        flags |= dialect.EKF_GPS_GLITCHING
    return dialect.MAVLink_ekf_status_report_message(flags, position, position, 0.0, heading, 0.0)


def estimator_status(now: Snapshot) -> Message | None:
    """The same in the standard message, with the position accuracy in metres."""
    nav = now.vehicle.nav
    if nav is None or now.vehicle.frame is None:
        return None
    flags, position, heading = _health(now)
    if nav.faults & _GLITCH:
        flags |= dialect.ESTIMATOR_GPS_GLITCH
    return build_message(
        "ESTIMATOR_STATUS",
        time_usec=now.boot_us,
        flags=flags,
        vel_ratio=position,
        pos_horiz_ratio=position,
        mag_ratio=heading,
        pos_horiz_accuracy=nav.position_sigma_m,
    )


def water_current(now: Snapshot) -> Message | None:
    """Current and leeway, m/s north and east.

    MAVLink has no message for a current, and WIND would show it as wind, so it is sent as a named vector.
    """
    nav = now.vehicle.nav
    if nav is None or now.vehicle.frame is None:
        return None
    return dialect.MAVLink_debug_vect_message(
        _CURRENT_NAME, now.boot_us, nav.current_north_m_s, nav.current_east_m_s, 0.0
    )
