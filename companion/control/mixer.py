"""Two thrusters side by side: from throttle and steering to port and starboard thrust."""

from companion.core.state import Thrust
from companion.core.units import clamp


def mix(throttle: float, steering: float) -> Thrust:
    """left = throttle + steering, right = throttle − steering, all shares of full drive, −1..1.

    Steering is positive to starboard. Where a side would saturate, throttle gives way, so that the boat keeps
    the whole yaw moment that was asked for. NaN goes through: the gate behind the mixer stops the motors.
    """
    steering = clamp(steering, -1.0, 1.0)
    room = 1.0 - abs(steering)
    throttle = clamp(throttle, -room, room)
    return Thrust(throttle + steering, throttle - steering)
