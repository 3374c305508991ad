"""From the axes of a board to those of the boat, and the orientation that a part has fused as a reading."""

import math

from companion.config.sensors import Mounting
from companion.core.readings import HeadingReading
from companion.core.units import wrap_pi
from companion.core.vectors import Matrix, Vector, dot, product, quarter_turns, times
from companion.sensors.compass.attitude import roll_pitch

Quaternion = tuple[float, float, float, float]
"""x, y, z, w; turns board axes into east, north, up."""


# A board's axes are x along its arrow, y to its left, z up; half a turn about x makes them body axes
_BOARD = quarter_turns(2, 0, 0)


def board_to_body(mounting: Mounting) -> Matrix:
    """Turns vectors in the axes printed on a board into body axes."""
    turns = (mounting.roll_deg // 90, mounting.pitch_deg // 90, mounting.yaw_deg // 90)
    return product(quarter_turns(*turns), _BOARD)


def heading_reading(
    quaternion: Quaternion, rate: Vector | None, axes: Matrix, correction_rad: float, time_s: float
) -> HeadingReading:
    """The magnetic heading, roll and pitch of the boat.

    quaternion: of unit length. rate: rad/s in board axes. axes: board to body. correction_rad is added to the
    heading.
    """
    ahead = _turned(quaternion, axes[0])  # a row: the body's axis in board axes
    heading_rad = wrap_pi(math.atan2(ahead[0], ahead[1]) + correction_rad)
    x, y, z, w = quaternion
    up = _turned((-x, -y, -z, w), (0.0, 0.0, 1.0))  # in board axes
    down = times(axes, (-up[0], -up[1], -up[2]))
    roll_rad, pitch_rad = roll_pitch(down)
    rate_rad_s = None if rate is None else dot(times(axes, rate), down)
    return HeadingReading(time_s, heading_rad, rate_rad_s, roll_rad, pitch_rad, is_magnetic=True)


def _turned(quaternion: Quaternion, vector: Vector) -> Vector:
    """A vector turned by a unit quaternion."""
    x, y, z, w = quaternion
    a, b, c = vector
    s, t, u = 2.0 * (y * c - z * b), 2.0 * (z * a - x * c), 2.0 * (x * b - y * a)
    return (a + w * s + y * u - z * t, b + w * t + z * s - x * u, c + w * u + x * t - y * s)
