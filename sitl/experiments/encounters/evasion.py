"""Whether any manoeuvre keeps clear of a mover from REACTION_S after an echo of it.

The search is exhaustive over all pairs of sustained motor commands on a grid: each motor at one of COMMANDS
until one of SWITCHES_S, then each motor at one of COMMANDS for the rest of WATCHED_S. Those are
25 × 30 × 25 = 18,750 manoeuvres of the true hull and motors, from the boat's true motion at that moment. If
none of them keeps clear, the touch is inevitable for a boat that arrives at this speed on this course.

Two echoes are asked about. The first possible one is the first moment at which a ping in the best direction
would reach the mover's nearest point, whether or not one was sent and heard: a touch that nothing after it
avoids is inevitable at this speed and reach, however well the boat looks. The first one heard is later: a
touch that nothing after that avoids went unheard too long, and no better planner would have helped. Doubts
count against the boat: there is no noise, and the manoeuvre is chosen with the mover's future known.
"""

import math
from itertools import product
from typing import Final, NamedTuple

from companion.boat import TICK_S
from companion.core.units import wrap_pi
from companion.planning.segments import point_distance2
from sitl.run.recording.recorder import Rows
from sitl.world.drive.thruster import Thrusters
from sitl.world.hull import Hull
from sitl.world.movers import Movers
from sitl.world.scenario import Scenario
from sitl.world.truth import Truth

Pair = tuple[float, float]

REACTION_S: Final = 0.3  # a second ping that confirms the echo, and a decision
COMMANDS: Final = (1.0, -1.0, 0.0, 0.5, -0.5)  # of each motor; the likeliest to succeed first
SWITCHES_S: Final = tuple(0.1 * step for step in range(1, 31))  # full astern stops the boat from 2 m/s in 2 s
WATCHED_S: Final = 8.0  # a mover of 0.2 m/s takes 5 s past a metre
_WARM_S: Final = 0.4  # two time constants of the motors: until they turn as in the run


class _State(NamedTuple):
    north_m: float
    east_m: float
    heading_rad: float
    surge_m_s: float
    sway_m_s: float
    yaw_rate_rad_s: float
    left_rad_s: float
    right_rad_s: float


def could_evade(scenario: Scenario, rows: Rows, heard_s: float | None = None) -> bool:
    """Whether some manoeuvre after an echo keeps clear of the movers.

    rows: the truth of every tick of a run with a touch, up to it at least. heard_s: when the echo was heard;
    None: the first possible one.
    """
    movers = Movers(scenario.movers)
    grounded = rows[:, Truth._fields.index("grounded")] > 0.0
    truths = [Truth(*row) for row in rows[: int(grounded.argmax())].tolist()]
    if heard_s is None:
        heard_s = next((truth.time_s for truth in truths if is_audible(scenario, movers, truth)), math.inf)
    acts = next((truth for truth in truths if truth.time_s >= heard_s + REACTION_S), None)
    return acts is not None and _Search(scenario, movers, acts).finds_clear_way()


def is_audible(scenario: Scenario, movers: Movers, truth: Truth) -> bool:
    """Whether a ping in the best direction would be answered by some mover."""
    sonar, lidar = scenario.sensors.sonar, scenario.sensors.lidar
    sights = [(sonar.max_range_m, sonar.sweep_deg + sonar.cone_deg)]
    if lidar.fitted:
        sights.append((lidar.max_range_m, lidar.field_deg + lidar.beam_deg))
    for east_m, north_m, radius_m in movers.positions_m(truth.time_s):
        north, east = north_m - truth.north_m, east_m - truth.east_m
        distance_m = math.hypot(north, east)
        off_bow = abs(wrap_pi(math.atan2(east, north) - truth.heading_rad))
        if any(
            distance_m - radius_m < reach_m and off_bow < 0.5 * math.radians(field_deg)
            for reach_m, field_deg in sights
        ):
            return True
    return False


class _Search:
    """All manoeuvres from one moment."""

    def __init__(self, scenario: Scenario, movers: Movers, at: Truth) -> None:
        self._movers, self._at, self._radius_m = movers, at, scenario.hull.length_m
        half, side = 0.5 * scenario.hull.length_m, 0.5 * scenario.hull.beam_m
        transom = scenario.hull.transom_share * side
        corners = ((half, 0.0), (0.0, side), (-half, transom), (-half, -transom), (0.0, -side))
        self._sides = tuple(zip(corners, (*corners[1:], corners[0]), strict=True))
        self._hull = Hull(scenario.hull)
        self._thrusters = Thrusters(scenario.thrusters)
        for _ in range(round(_WARM_S / TICK_S)):
            self._thrusters.step(
                at.left_command, at.right_command, at.voltage_v, at.surge_m_s, at.yaw_rate_rad_s, TICK_S
            )

    def finds_clear_way(self) -> bool:
        """Whether some manoeuvre keeps clear."""
        at, thrusters = self._at, self._thrusters
        begin = _State(
            at.north_m, at.east_m, at.heading_rad, at.surge_m_s, at.sway_m_s, at.yaw_rate_rad_s,
            thrusters.left.speed_rad_s, thrusters.right.speed_rad_s,
        )  # fmt: skip
        pairs = tuple(product(COMMANDS, COMMANDS))
        last = round(WATCHED_S / TICK_S)
        switches = [round(switch_s / TICK_S) for switch_s in SWITCHES_S]
        for first in pairs:
            tick, state = 0, begin
            for switch in switches:
                reached = self._simulate(state, tick, switch, first)
                if reached is None:
                    break
                tick, state = switch, reached
                if any(self._simulate(state, tick, last, then) is not None for then in pairs):
                    return True
        return False

    def _simulate(self, state: _State, tick: int, until: int, command: Pair) -> _State | None:
        """The state after holding a command from one tick to another; None if the hull touches."""
        at, hull, thrusters = self._at, self._hull, self._thrusters
        hull.place(state.north_m, state.east_m, state.heading_rad)
        hull.move(state.surge_m_s, state.sway_m_s, state.yaw_rate_rad_s)
        thrusters.left.speed_rad_s, thrusters.right.speed_rad_s = state.left_rad_s, state.right_rad_s
        for now in range(tick + 1, until + 1):
            surge_n, yaw_nm = thrusters.step(
                *command, at.voltage_v, hull.surge_m_s, hull.yaw_rate_rad_s, TICK_S
            )
            hull.step(surge_n, 0.0, yaw_nm, at.current_north_m_s, at.current_east_m_s, TICK_S)
            if self._touches(at.time_s + now * TICK_S):
                return None
        return _State(
            hull.north_m, hull.east_m, hull.heading_rad, hull.surge_m_s, hull.sway_m_s,
            hull.yaw_rate_rad_s, thrusters.left.speed_rad_s, thrusters.right.speed_rad_s,
        )  # fmt: skip

    def _touches(self, time_s: float) -> bool:
        """Whether a side of the hull comes into a mover's circle."""
        hull = self._hull
        for east_m, north_m, radius_m in self._movers.positions_m(time_s):
            north, east = north_m - hull.north_m, east_m - hull.east_m
            if math.hypot(north, east) > radius_m + self._radius_m:
                continue
            place = (north * hull.cos + east * hull.sin, east * hull.cos - north * hull.sin)
            if any(
                point_distance2(*place, *start, *end) <= radius_m * radius_m for start, end in self._sides
            ):
                return True
        return False
