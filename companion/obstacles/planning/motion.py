"""The boat's motion model, and a fan of its rollouts in the boat's frame.

Each rollout holds one heading and one speed through the water with the loops and the thrust that the boat
has: T. I. Fossen, *Handbook of Marine Craft Hydrodynamics and Motion Control*, 2nd ed. 2021, section 6.4
(surge: thrust against quadratic drag; yaw: Nomoto, first order). Thrust that turns the boat is not there to
brake it. The fan of a speed and yaw rate is computed once and kept; turned to the heading and moved with the
current it serves every decision (the dynamic window of D. Fox, W. Burgard, S. Thrun, IEEE Robotics and
Automation Magazine 4(1), 1997, with headings in place of yaw rates).
"""

import math
from typing import Final, NamedTuple

from companion.config.boat_config import BoatConfig
from companion.control.speed import ASTERN_SHARE, feed_forward
from companion.core.units import clamp
from companion.guidance.speed_profile import steered_speed_m_s

STEP_S: Final = 0.25  # half a hull's length at cruise
STEPS: Final = 20  # five seconds: what comes within sight at 1 m/s, and a turn around
TURNS: Final = tuple(math.radians(15.0 * step) for step in range(-12, 12))
CRASH_STOP: Final = -10.0  # speed of the rollout with both propellers full astern until the boat is at rest,
FULL_ASTERN: Final = -20.0  # and of the one that keeps them so
_DELAY_S: Final = 0.25  # decision, slew and motors: the lake boat's motors take 0.22 s
# Full thrust at rest over mass, of guidance's accel_m_s2: the lake boat's 8.0 N on 8.6 kg are 0.93 m/s², less
# what the battery loses
_THRUST: Final = 2.0
_ASTERN: Final = 0.6  # propellers' thrust astern, of ahead: 0.55 to 0.65 (sitl/boats/lake.toml)
_BIN: Final = 0.2  # m/s and rad/s: within it the rollouts of a fan end within half a hull
_MOST_FANS: Final = 200


class Rollout(NamedTuple):
    """turn_rad: of the bow, clockwise; speed_m_s: through the water, negative astern; north, east: in the
    boat's frame at the start (ahead, starboard), in the water; bow_rad: heading change at the end.
    """

    turn_rad: float
    speed_m_s: float
    ahead_m: tuple[float, ...]
    right_m: tuple[float, ...]
    bow_rad: float


def roll(
    surge_m_s: float,
    yaw_rate_rad_s: float,
    turn_rad: float,
    speed_m_s: float,
    config: BoatConfig,
    *,
    brakes: bool = True,
) -> Rollout:
    """One rollout. surge_m_s, speed_m_s: through the water; brakes: whether with thrust astern."""
    handling, gains, setting = config.handling, config.heading, config.speed
    top, radius_m, has_pair = handling.top_speed_m_s, config.drive.least_radius_m, config.drive.has_pair
    half_s = 0.5 * STEP_S  # of the integration
    follows = 1.0 - math.exp(-half_s / handling.yaw_time_s)
    force = _THRUST * config.guidance.accel_m_s2
    surge, rate, bow, ahead, right = surge_m_s, yaw_rate_rad_s, 0.0, 0.0, 0.0
    aheads, rights = [], []
    for step in range(1, 2 * STEPS + 1):
        if step * half_s > _DELAY_S:
            error = turn_rad - bow
            effort = clamp(gains.kp * error - gains.kd * rate, -gains.max_steering, gains.max_steering)
            fastest = handling.turn_rate_rad_s
            if radius_m > 0.0:
                fastest = min(fastest, abs(surge) / radius_m)
            follows_rad_s = gains.kp * error / max(gains.kd, 1.0)  # where proportional and rate terms cancel
            rate += follows * (clamp(follows_rad_s, -fastest, fastest) - rate)
            wanted = steered_speed_m_s(speed_m_s, error, config) if speed_m_s > 0.0 else speed_m_s
            room = 1.0 - abs(effort) if has_pair else 1.0
            if speed_m_s <= CRASH_STOP:
                throttle = -setting.max_throttle if surge > 0.0 or speed_m_s == FULL_ASTERN else 0.0
            else:
                throttle = clamp(
                    feed_forward(wanted, setting) + setting.kp * (wanted - surge),
                    -min(ASTERN_SHARE * setting.max_throttle, room) if brakes else 0.0,
                    min(setting.max_throttle, room),
                )
            thrust = throttle if throttle > 0.0 else _ASTERN * throttle
            if half_s * force * abs(surge) > top * top:
                surge = half_s * force * thrust  # drag stops the boat within the step
            else:
                surge += half_s * force * (thrust - surge * abs(surge) / (top * top))
            if speed_m_s == CRASH_STOP:
                surge = max(surge, 0.0)
        bow += half_s * rate
        c, s = math.cos(bow), math.sin(bow)
        slip = -handling.slip_m * rate * min(abs(surge), 1.0)  # outwards; none on the spot
        ahead += half_s * (surge * c - slip * s)
        right += half_s * (surge * s + slip * c)
        if step % 2 == 0:
            aheads.append(ahead)
            rights.append(right)
    return Rollout(turn_rad, speed_m_s, tuple(aheads), tuple(rights), bow)


class CourseFan:
    """The rollouts of a boat, by its speed and yaw rate."""

    def __init__(self) -> None:
        self._config: BoatConfig | None = None
        self._fans: dict[tuple[int, int, int, bool], list[Rollout]] = {}

    def rollouts(
        self,
        surge_m_s: float,
        yaw_rate_rad_s: float,
        speed_m_s: float,
        config: BoatConfig,
        *,
        brakes: bool = True,
    ) -> list[Rollout]:
        """Every turn at one speed through the water; at rest and astern only those that make sense."""
        if config is not self._config or len(self._fans) > _MOST_FANS:
            self._fans.clear()
            self._config = config
        key = (round(surge_m_s / _BIN), round(yaw_rate_rad_s / _BIN), round(speed_m_s / _BIN), brakes)
        fan = self._fans.get(key)
        if fan is None:
            turns = TURNS
            if key[2] <= 0 and not (key[2] == 0 and config.drive.can_pivot):
                turns = (0.0, -TURNS[14], TURNS[14]) if key[2] else (0.0,)
            surge, rate, speed = key[0] * _BIN, key[1] * _BIN, key[2] * _BIN
            fan = self._fans[key] = [roll(surge, rate, turn, speed, config, brakes=brakes) for turn in turns]
        return fan
