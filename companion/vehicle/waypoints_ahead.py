"""Which waypoints a mission leads to next."""

from collections.abc import Mapping

from companion.vehicle.mission_steps import (
    GoRound,
    HandOver,
    Jump,
    Mission,
    ReturnHome,
    Turn,
    Wait,
    Waypoint,
)

MOST = 48  # looked ahead
_MOST_STEPS = 100


def waypoints_ahead(mission: Mission, seq: int, jumps: Mapping[int, int]) -> list[Waypoint]:
    """Those that follow an item without a stop between, up to one where the boat stops.

    jumps: how often each was made. One is looked beyond, and no other after it.
    """
    ahead: list[Waypoint] = []
    jumped, step = False, mission[seq]
    for _ in range(_MOST_STEPS):
        if isinstance(step, Waypoint) and step.hold_s > 0.0:
            break
        seq += 1
        if seq >= len(mission) or len(ahead) == MOST:
            break
        step = mission[seq]
        match step:
            case Waypoint():
                ahead.append(step)
            case Jump(target, times):
                goes = times < 0 or jumps.get(seq, 0) < times
                if goes and jumped:
                    break  # one jump leads to another: more than this looks ahead
                if goes:
                    seq, jumped = target - 1, True
            case GoRound() | Wait() | Turn() | HandOver() | ReturnHome():
                break
    return ahead
