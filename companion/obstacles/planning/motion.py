"""The boat's motion model, and a fan of its rollouts in the boat's frame.

Each rollout holds one heading and one speed through the water with the loops and the thrust that the boat
has: T. I. Fossen, *Handbook of Marine Craft Hydrodynamics and Motion Control*, 2nd ed. 2021, section 6.4
(surge: thrust against quadratic drag; yaw: Nomoto, first order). Thrust that turns the boat is not there to
brake it. The fan of a speed and yaw rate is computed once and kept; turned to the heading and moved with the
current it serves every decision (the dynamic window of D. Fox, W. Burgard, S. Thrun, IEEE Robotics and
Automation Magazine 4(1), 1997, with headings in place of yaw rates).
"""

import functools
import math
from collections.abc import Hashable
from typing import Final, NamedTuple

from companion.config.boat_config import BoatConfig
from companion.control.speed import ASTERN_SHARE, feed_forward
from companion.core.units import clamp
from companion.guidance.speed_profile import steered_speed_m_s

STEP_S: Final = 0.25  # half a hull's length at cruise
STEPS: Final = 20  # five seconds: what comes within sight at 1 m/s, and a turn around
APART_RAD: Final = math.radians(15.0)
TURNS: Final = tuple(APART_RAD * step for step in range(-12, 12))
_BETWEEN: Final = 3  # offsets of the turns: 5°, to meet the heading that is held
CRASH_STOP: Final = -10.0  # speed of the rollout with both propellers full astern until the boat is at rest,
FULL_ASTERN: Final = -20.0  # and of the one that keeps them so
_DECIDES_S: Final = 0.05  # half a period of the decisions
# Full thrust at rest over mass, of guidance's accel_m_s2, at which the boat brakes with ASTERN_SHARE of it
_THRUST: Final = 1.0 / ASTERN_SHARE
# Of a measured crash stop, at least: a hull that stops at once has more drag than thrust
_BRAKED: Final = 0.25
_ASTERN: Final = 0.5  # propellers' thrust astern, of ahead: at least, as in estimation/hull_model.py
BOW: Final = (
    0.25  # margins ahead of the centre, astern of it for a boat that goes astern: half a hull less its beam
)
_STILL_M_S: Final = 0.05  # slower it does not go astern
_BIN: Final = 0.2  # m/s and rad/s: within it the rollouts of a fan end within half a hull
_MOST_FANS: Final = 400  # 12 MB
_HALVINGS: Final = 10  # of the speed interval: to a thousandth of the top speed


class Rollout(NamedTuple):
    """turn_rad: of the bow, clockwise; speed_m_s: through the water, negative astern; ahead, right: of the
    middle of the hull's leading half, in the boat's frame at the start, in the water; bow_rad: heading change
    at the end.
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
    push, square = half_s * _THRUST * config.guidance.accel_m_s2, top * top
    delay_s = _DECIDES_S + handling.motor_time_s
    slew, held = config.motors.slew_per_s * half_s, feed_forward(max(surge_m_s, 0.0), setting)
    surge, rate, bow, ahead, right = surge_m_s, yaw_rate_rad_s, 0.0, 0.0, 0.0
    kp, kd, most, fastest = gains.kp, gains.kd, gains.max_steering, handling.turn_rate_rad_s
    most_throttle, astern, slip_m = setting.max_throttle, _astern_share(config), handling.slip_m
    wanted, base = speed_m_s, feed_forward(speed_m_s, setting)
    eases_rad = 0.5 * config.guidance.pivot_angle_rad  # beyond this error the speed is reduced
    aheads, rights = [], []
    bow_m = BOW * config.avoidance.margin_m
    for step in range(1, 2 * STEPS + 1):
        if step * half_s > delay_s:
            error = turn_rad - bow
            if radius_m > 0.0:
                fastest = min(handling.turn_rate_rad_s, abs(surge) / radius_m)
            effort = abs(kp * error - kd * rate)
            room = 1.0 - min(effort, most) if has_pair else 1.0
            follows_rad_s = kp * error / max(kd, 1.0)  # where proportional and rate terms cancel
            rate += follows * (clamp(follows_rad_s, -fastest, fastest) - rate)
            if speed_m_s <= CRASH_STOP:
                throttle = -most_throttle if surge > 0.0 or speed_m_s == FULL_ASTERN else 0.0
            else:
                if speed_m_s > 0.0 and (wanted != speed_m_s or abs(error) > eases_rad):
                    wanted = steered_speed_m_s(speed_m_s, error, config)
                    base = feed_forward(wanted, setting)
                throttle = clamp(
                    base + setting.kp * (wanted - surge),
                    -min(ASTERN_SHARE * most_throttle, room) if brakes else 0.0,
                    min(most_throttle, room),
                )
            held = throttle = clamp(throttle, held - slew, held + slew)
            thrust = throttle if throttle > 0.0 else astern * throttle
            if push * abs(surge) > square:
                surge = push * thrust  # drag stops the boat within the step
            else:
                surge += push * (thrust - surge * abs(surge) / square)
            if speed_m_s == CRASH_STOP:
                surge = max(surge, 0.0)
        bow += half_s * rate
        c, s = math.cos(bow), math.sin(bow)
        slip = -slip_m * rate * min(abs(surge), 1.0)  # outwards; none on the spot
        ahead += half_s * (surge * c - slip * s)
        right += half_s * (surge * s + slip * c)
        if step % 2 == 0:
            lead_m = bow_m if surge > -_STILL_M_S else -bow_m
            aheads.append(ahead + lead_m * c)
            rights.append(right + lead_m * s)
    return Rollout(turn_rad, speed_m_s, tuple(aheads), tuple(rights), bow)


def crash_stop_m(speed_m_s: float, reaction_s: float, config: BoatConfig) -> float:
    """The way through the water to rest, by a crash stop that begins after reaction_s.

    Under full thrust astern u' = −F (s + u² / top²), which takes top² / 2F ln(1 + u² / (s top²)). The motors
    reach it by their slew: half the time of the reversal is lost.
    """
    astern = _astern_share(config) * config.speed.max_throttle
    return _stop_m(speed_m_s, reaction_s, astern, config)


def _stop_m(speed_m_s: float, reaction_s: float, astern: float, config: BoatConfig) -> float:
    """astern: thrust astern over full thrust ahead."""
    top, force = config.handling.top_speed_m_s, _THRUST * config.guidance.accel_m_s2
    stops_m = 0.5 * top * top / force * math.log1p(speed_m_s * speed_m_s / (astern * top * top))
    return (reaction_s + _starts_s(speed_m_s, config)) * speed_m_s + stops_m


def _starts_s(speed_m_s: float, config: BoatConfig) -> float:
    """From the decision to full thrust astern, while the boat keeps its speed."""
    reversal = feed_forward(speed_m_s, config.speed) + config.speed.max_throttle
    return _DECIDES_S + config.handling.motor_time_s + 0.5 * reversal / config.motors.slew_per_s


def crash_stop_speed_m_s(room_m: float, reaction_s: float, config: BoatConfig) -> float:
    """The highest speed from which that takes room_m, at most the top speed."""
    low, high = 0.0, config.handling.top_speed_m_s
    for _ in range(_HALVINGS):
        speed = 0.5 * (low + high)
        low, high = (speed, high) if crash_stop_m(speed, reaction_s, config) <= room_m else (low, speed)
    return high


def stop_from_cruise_m(speed_m_s: float, stop_m: float, config: BoatConfig) -> float:
    """The way from cruise of a boat whose crash stop from speed_m_s took stop_m."""
    return _stop_m(config.speed.cruise_m_s, 0.0, _fitted(speed_m_s, stop_m, config), config)


def _fitted(speed_m_s: float, stop_m: float, config: BoatConfig) -> float:
    """Thrust astern over full thrust ahead of a crash stop in stop_m: `crash_stop_m` solved for s."""
    square, force = config.handling.top_speed_m_s**2, _THRUST * config.guidance.accel_m_s2
    braked_m = max(stop_m - _starts_s(speed_m_s, config) * speed_m_s, _BRAKED * stop_m)
    return speed_m_s**2 / square / math.expm1(2.0 * force * braked_m / square)


def _astern_share(config: BoatConfig) -> float:
    """Thrust astern of that ahead at the same throttle: by the measured crash stop, else what any boat has.

    A calibrated asymmetry may know that it is less.
    """
    if not config.handling.stop_m:
        return min(_ASTERN, 1.0 / config.thrusters.asymmetry)
    return _fitted(config.speed.cruise_m_s, config.handling.stop_m, config) / config.speed.max_throttle


_Fans = dict[tuple[int, int, int, int, bool], list[Rollout]]


@functools.lru_cache(maxsize=2)
def _fans_of(*figures: Hashable) -> _Fans:  # noqa: ARG001
    """What is known of the boats with the same figures in this process."""
    return {}


class CourseFan:
    """The rollouts of a boat, by its speed and yaw rate."""

    def __init__(self) -> None:
        self._config: BoatConfig | None = None
        self._fans: _Fans = {}

    def rollouts(
        self,
        surge_m_s: float,
        yaw_rate_rad_s: float,
        speed_m_s: float,
        config: BoatConfig,
        offset_rad: float = 0.0,
        *,
        brakes: bool = True,
    ) -> list[Rollout]:
        """Every turn at one speed through the water; at rest and astern only those that make sense.

        offset_rad: one of the turns, or a number of times APART_RAD away from one.
        """
        if config is not self._config:
            self._config = config
            self._fans = _fans_of(
                *(
                    config.handling,
                    config.heading,
                    config.speed,
                    config.drive,
                    config.guidance,
                    config.motors,
                ),
                *(config.thrusters.asymmetry, config.avoidance.margin_m),
            )
        if len(self._fans) > _MOST_FANS:
            self._fans.clear()
        offset = round(_BETWEEN * offset_rad / APART_RAD) % _BETWEEN
        bins = [round(value / _BIN) for value in (surge_m_s, yaw_rate_rad_s, speed_m_s)]
        key = (bins[0], bins[1], bins[2], offset, brakes)
        fan = self._fans.get(key)
        if fan is None:
            turns = TURNS
            if key[2] <= 0 and not (key[2] == 0 and config.drive.can_pivot):
                turns = (0.0, -TURNS[14], TURNS[14]) if key[2] else (0.0,)
            more = offset * APART_RAD / _BETWEEN if len(turns) == len(TURNS) else 0.0
            surge, rate, speed = key[0] * _BIN, key[1] * _BIN, key[2] * _BIN
            fan = [roll(surge, rate, turn + more, speed, config, brakes=brakes) for turn in turns]
            self._fans[key] = fan
        return fan
