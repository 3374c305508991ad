"""The heading loop: a PID from heading error to a share of full differential thrust.

Its gains are scheduled by speed. To steering u a hull answers as T ṙ + r = K u (Nomoto's first order; T.
I. Fossen, *Handbook of Marine Craft Hydrodynamics and Motion Control*, 2nd ed. 2021, chapter 7), and poles
placed at ω and ζ (the same, chapter 15) take Kp = ω² T/K and Kd = (2 ζ ω T − 1)/K. On two thrusters it
is K/T, the angular acceleration that steering gives, that changes with speed: thrust grows with the square of
the shaft's speed, so about a low throttle the same difference of the two sides gives less of it. Hence all
gains go with T/K, which falls from rest to cruise speed and is level beyond. On a hull that is not the
configured one the gains keep the poles where that has them: with b = K/T and a = 1/T learned, Kp b and
Kd b + a stay the same.

The integral is there for the steady moment of wind and leeway, and only what a boat on her course leaves over
tells of that. So it learns while the bow is within integral_band_rad of a heading that stands still, not from
the errors of a turn; and since that moment is another one on another heading, a turn makes it forget.
"""

from typing import Final

from companion.config.actuators import Handling
from companion.config.tuning import Heading
from companion.control.pid import Pid
from companion.core.state import PidOutput
from companion.core.units import clamp, wrap_pi

_FORGET_RAD: Final = 0.5  # turned, and little is left of what the integral has learned
_STEADY_RAD_S: Final = 0.1  # turning no faster than that


def heading_effort(
    pid: Pid,
    demand_rad: float,
    heading_rad: float,
    yaw_rate_rad_s: float,
    setting: Heading,
    dt_s: float,
    demand_rate_rad_s: float = 0.0,
    feed_forward: float = 0.0,
    schedule: float = 1.0,
    damping: float = 0.0,
) -> PidOutput:
    """Steering share that turns the bow toward a heading by the shorter way, positive to starboard.

    Angles are from north, clockwise; yaw_rate_rad_s is the measured rate, clockwise positive.
    demand_rate_rad_s: how fast the demand itself turns, which the derivative then does not brake.
    feed_forward: the steering that such a turn takes. schedule: what the gains are multiplied by, and the
    derivative's after damping has been added.
    """
    limit = setting.max_steering
    base = clamp(feed_forward, -limit, limit)
    error = wrap_pi(demand_rad - heading_rad)
    if setting.integral_band_rad:
        turning = abs(yaw_rate_rad_s)
        kept = 1.0 - turning * dt_s / _FORGET_RAD
        pid.integral *= kept if kept > 0.0 else 0.0
        if (
            abs(error) > setting.integral_band_rad
            or turning > _STEADY_RAD_S
            or abs(demand_rate_rad_s) > _STEADY_RAD_S
        ):
            dt_s = 0.0  # nothing is learned
    return pid.update(
        schedule * setting.kp,
        schedule * setting.ki,
        schedule * (setting.kd + damping),
        error,
        demand_rate_rad_s - yaw_rate_rad_s,
        dt_s,
        -limit - base,
        limit - base,
        base,
    )


def gain_schedule(water_m_s: float, cruise_m_s: float, slow_gain: float) -> float:
    """What the gains at cruise speed are to be multiplied by, at a speed along the bow through the water."""
    return 1.0 + (slow_gain - 1.0) * max(1.0 - abs(water_m_s) / cruise_m_s, 0.0)


def learned_gains(accel_rad_s2: float, damping_per_s: float, handling: Handling) -> tuple[float, float]:
    """Schedule and damping for a hull with this b and a. b = 0: it, or the configured one, is not known."""
    nominal = handling.turn_accel_rad_s2
    if not accel_rad_s2 * nominal > 0.0:
        return 1.0, 0.0
    return nominal / accel_rad_s2, (1.0 / handling.turn_time_s - damping_per_s) / nominal
