"""The speed loop: feed-forward throttle, and a PI on what it leaves."""

from companion.config.tuning import Speed
from companion.control.pid import Pid
from companion.core.state import PidOutput
from companion.core.units import clamp

ASTERN_SHARE = 0.5  # of max_throttle: propellers bite less astern, and a hard stop throws spray over the deck


def feed_forward(speed_m_s: float, setting: Speed) -> float:
    """Throttle share that holds a speed in still water.

    Hull resistance grows with v² (Fossen, *Handbook of Marine Craft Hydrodynamics and Motion Control*, 2nd
    ed. 2021, section 6.4: quadratic surge damping) and propeller thrust at a given advance number with n².
    Both together make the shaft speed n, which a DC motor turns in proportion to its voltage, linear in v:
    a straight line through (0, 0) and (cruise_m_s, cruise_throttle). Negative speeds are astern.
    """
    return setting.cruise_throttle * speed_m_s / setting.cruise_m_s


def speed_effort(
    pid: Pid,
    demand_m_s: float,
    surge_m_s: float,
    setting: Speed,
    dt_s: float,
    room: float = 1.0,
    current_m_s: float = 0.0,
    least: float = -1.0,
    schedule: float = 1.0,
) -> PidOutput:
    """Throttle share that holds a speed along the bow, over ground.

    Astern it is limited to ASTERN_SHARE of what is allowed ahead. room: the share that steering leaves to
    throttle, 0..1; the integral must not wind up on what the mixer takes away. current_m_s: the known current
    along the bow; what is not known of it ends up in the integral. least: the lowest throttle share.
    schedule: what the gains are multiplied by.
    """
    base = feed_forward(demand_m_s - current_m_s, setting)
    high = min(setting.max_throttle, room)
    low = min(max(-min(setting.max_throttle * ASTERN_SHARE, room), least), high)
    # The PI works inside what the feed-forward leaves, whose span must contain 0.
    base = clamp(base, low, high)
    return pid.update(
        schedule * setting.kp,
        schedule * setting.ki,
        0.0,
        demand_m_s - surge_m_s,
        0.0,
        dt_s,
        low - base,
        high - base,
        base,
    )
