"""What avoidance makes of an evasive maneuver, and the costs that a maneuver is chosen by."""

import math

import pytest
from encounter_rig import CONFIG, NORTH, NOW_S, boat, mover, scene_of

from companion.config.boat_config import BoatConfig
from companion.core.geo import Point
from companion.core.intent import Drive, HoldCourse, HoldHeading, Intent
from companion.core.state import NavState
from companion.core.status_text import Severity, StatusText
from companion.geofence.fence import Fence
from companion.obstacles.perception.occupancy import Beam
from companion.obstacles.perception.perception import ObstaclePerception
from companion.obstacles.planning import avoidance, moving_obstacles
from companion.obstacles.planning.avoidance import Avoidance, Stage
from companion.obstacles.planning.moving_obstacles import EvasiveManeuver, choose_maneuver
from companion.obstacles.planning.scene import Scene

# The intent for a maneuver


class Encounter:
    """Avoidance with one mover, and the maneuver given."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, config: BoatConfig = CONFIG) -> None:
        self.texts: list[StatusText] = []
        self.avoidance = Avoidance(self.texts)
        self.track = mover(3.0, 0.0)
        self.perception = ObstaclePerception(CONFIG.avoidance)
        self.perception.tracks.all.append(self.track)
        astern = Beam(0.9, Point(0.0, 0.0), math.pi, 0.2, 3.0, 4.0)
        self.perception.occupancy.add(astern)  # its echo in the grid
        self.perception.reach_m = 4.0
        self.maneuver: EvasiveManeuver | None = None
        self.asked: list[tuple[float, float, EvasiveManeuver | None]] = []
        self.config = config
        monkeypatch.setattr(avoidance, "choose_maneuver", self._choose)

    def _choose(
        self, scene: Scene, course_rad: float, speed_m_s: float, last: EvasiveManeuver | None
    ) -> EvasiveManeuver | None:
        self.asked.append((course_rad, speed_m_s, last))
        return self.maneuver

    def at(self, now_s: float, nav: NavState | None = None, intent: Intent = NORTH) -> Intent:
        return self.avoidance.update(
            intent, nav or boat(), self.config, self.perception, Fence(), is_by_hand=False, now_s=now_s
        )


def test_a_turn_is_sailed_as_a_course_at_the_maneuvers_speed(monkeypatch: pytest.MonkeyPatch) -> None:
    meeting = Encounter(monkeypatch)
    meeting.maneuver = EvasiveManeuver(0.7, 1.2)
    assert meeting.at(1.0) == HoldCourse(0.7, 1.2)
    assert meeting.avoidance.stage is Stage.PASSING
    assert meeting.texts == [StatusText(Severity.INFO, "Moving obstacle: giving way")]
    # Since an unmapped obstacle was met, the speed is limited by sight; nothing was heard: 0.4 m/s
    assert meeting.at(1.1) == HoldCourse(0.7, 1.2)
    assert meeting.avoidance.safe_speed.ahead_m_s == 1.2
    assert meeting.asked == [(0.0, 1.0, None), (0.0, 0.4, meeting.maneuver)]
    assert len(meeting.texts) == 1
    over = HoldCourse(3.0, 1.0)
    found = meeting.at(1.2, intent=over)
    assert isinstance(found, HoldCourse)
    assert found.course_rad == pytest.approx(3.7 - math.tau)


def test_after_giving_way_the_intent_is_followed_and_the_next_time_is_told(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    meeting = Encounter(monkeypatch)
    for now_s, maneuver in ((1.0, EvasiveManeuver(0.7, 1.2)), (1.1, None)):
        meeting.maneuver = maneuver
        found = meeting.at(now_s)
    assert found is NORTH
    assert meeting.avoidance.stage is Stage.CLEAR
    meeting.maneuver = EvasiveManeuver(-0.7, 1.2)
    assert meeting.at(1.2) == HoldCourse(-0.7, 1.2)
    assert len(meeting.texts) == 2
    meeting.perception.tracks.all.clear()
    assert meeting.at(1.3) is NORTH
    assert meeting.avoidance.stage is Stage.CLEAR
    meeting.perception.tracks.all.append(meeting.track)
    meeting.at(1.4)
    assert meeting.asked[-1][2] is None, "the last maneuver is forgotten"


@pytest.mark.parametrize(
    ("speed_m_s", "surge_m_s", "expected"),
    [
        (0.0, 0.17, Drive(-CONFIG.speed.max_throttle, -0.05)),  # above 0.4 of 0.4 m/s: full reverse
        (-0.4, 0.17, Drive(-CONFIG.speed.max_throttle, -0.05)),
        (0.0, 0.15, HoldHeading(0.3, 0.0)),
        (-0.4, 0.15, HoldHeading(0.3, -0.4)),
    ],
)
def test_a_boat_stops_with_full_reverse_before_it_holds_or_backs(
    monkeypatch: pytest.MonkeyPatch, speed_m_s: float, surge_m_s: float, expected: Intent
) -> None:
    meeting = Encounter(monkeypatch)
    meeting.maneuver = EvasiveManeuver(0.0, speed_m_s)
    nav = boat(surge_m_s, heading_rad=0.3, yaw_rate_rad_s=0.1)
    assert meeting.at(1.0, nav) == expected


def test_a_probable_mover_is_avoided_without_a_word(monkeypatch: pytest.MonkeyPatch) -> None:
    meeting = Encounter(monkeypatch)
    meeting.track.is_mover = False
    meeting.maneuver = EvasiveManeuver(0.7, 1.2)
    assert meeting.at(1.0) == HoldCourse(0.7, 1.2)
    assert meeting.texts == []
    assert not meeting.perception.water.is_limited(Point(0.0, 0.0), 2, Fence())
    meeting.track.is_mover = True
    meeting.at(1.1)
    assert [one.text for one in meeting.texts] == ["Moving obstacle: giving way"]
    assert meeting.perception.water.is_limited(Point(0.0, 0.0), 2, Fence())


@pytest.mark.parametrize(("seen_ago_s", "is_avoided"), [(0.39, True), (0.41, False)])
def test_a_probable_mover_counts_while_it_is_seen(
    monkeypatch: pytest.MonkeyPatch, seen_ago_s: float, is_avoided: bool
) -> None:
    meeting = Encounter(monkeypatch)
    meeting.track.is_mover = False
    meeting.maneuver = EvasiveManeuver(0.7, 1.2)
    assert (meeting.at(NOW_S + seen_ago_s) is not NORTH) is is_avoided


# The choice, by its costs

BAD = (1.0, 1.0)
FREE = (0.0, 0.0)
Option = tuple[float, float]


def chosen(
    monkeypatch: pytest.MonkeyPatch,
    near: dict[Option, tuple[float, float]],
    last: EvasiveManeuver | None = None,
    scene: Scene | None = None,
) -> EvasiveManeuver | None:
    """near: how near the movers come for a turn and a speed; very near for all others."""

    def encroachment(scene: Scene, course_rad: float, speed_m_s: float) -> tuple[float, float]:
        return near.get((round(course_rad, 3), round(speed_m_s, 3)), BAD)

    monkeypatch.setattr(moving_obstacles, "_encroachment", encroachment)
    return choose_maneuver(scene or scene_of(mover(9.0, 0.0, -0.5)), 0.0, 1.0, last)


STRAIGHT, STOPPED = (0.0, 1.0), (0.0, 0.0)


@pytest.mark.parametrize("turn", [0.35, 0.7, 1.05, 1.4, 2.1, -0.35, -0.7, -1.05, -1.4, -2.1])
@pytest.mark.parametrize("speed_m_s", [1.0, 0.5, 1.2])  # the requested, half, three times the slowest
def test_the_only_safe_maneuver_is_chosen(
    monkeypatch: pytest.MonkeyPatch, turn: float, speed_m_s: float
) -> None:
    assert chosen(monkeypatch, {(turn, speed_m_s): FREE}) == pytest.approx((turn, speed_m_s))


@pytest.mark.parametrize("speed_m_s", [0.5, 1.2, 0.0, -0.4])
def test_the_only_safe_speed_is_chosen(monkeypatch: pytest.MonkeyPatch, speed_m_s: float) -> None:
    assert chosen(monkeypatch, {(0.0, speed_m_s): FREE}) == pytest.approx((0.0, speed_m_s))


@pytest.mark.parametrize(
    ("cheap", "dear", "less", "more", "hits"),
    [
        ((0.35, 1.0), STRAIGHT, 0.057, 0.060, 0.0),  # 0.35 rad against 6 near
        ((0.35, 1.0), STRAIGHT, 0.0001, 0.0001, 0.033),  # and against 10 hits
        ((-0.35, 1.0), (0.35, 1.0), 0.045, 0.055, 0.0),  # 0.3 more for port
        (STOPPED, (0.35, 1.0), 0.040, 0.043, 0.0),  # 0.6
        ((0.35, 1.0), (0.0, 0.5), 0.007, 0.010, 0.0),  # 0.3
        ((0.0, 1.2), (0.7, 1.0), 0.015, 0.018, 0.0),  # 0.8
        ((0.0, -0.4), (2.1, 1.0), 0.145, 0.155, 0.0),  # 3.0
    ],
)
def test_the_costs_of_turns_and_speeds(
    monkeypatch: pytest.MonkeyPatch, cheap: Option, dear: Option, less: float, more: float, hits: float
) -> None:
    """`dear` costs less on its own account, but comes nearer."""
    for near, more_hits, expected in ((less, 0.0, dear), (more, 0.003, cheap)):
        options = {cheap: FREE, dear: (near, hits + more_hits if hits else 0.0)}
        found = chosen(monkeypatch, options) or STRAIGHT
        assert found == pytest.approx(expected)


@pytest.mark.parametrize(
    ("last", "near", "is_kept"),
    [
        ((0.7, 1.0), 0.21, True),  # 0.7 + 1.26 − 2 < 0
        ((0.7, 1.0), 0.23, False),
        ((0.7, 0.91), 0.21, True),
        ((0.7, 1.09), 0.21, True),
        ((0.7, 0.89), 0.21, False),
        ((1.05, 1.0), 0.21, False),
    ],
)
def test_the_present_maneuver_is_kept_unless_another_is_better_by_two(
    monkeypatch: pytest.MonkeyPatch, last: Option, near: float, is_kept: bool
) -> None:
    options = {(0.7, 1.0): (near, 0.0), STRAIGHT: (0.001, 0.0)}
    found = chosen(monkeypatch, options, EvasiveManeuver(*last))
    assert found == ((0.7, 1.0) if is_kept else None)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_passing_ahead_of_crossing_traffic_costs_two_and_a_half(
    monkeypatch: pytest.MonkeyPatch, side: float
) -> None:
    crossing = scene_of(mover(9.0, 0.0, 0.0, 0.5 * side))
    ahead, astern = (0.35 * side, 1.0), (-0.35 * side, 1.0)
    to_port = 0.3 / 6.0
    for near, expected in ((0.37, STOPPED), (0.385, ahead)):  # 0.6 + 6 near against 0.35 + 2.5
        near += 0.0 if side > 0.0 else to_port  # noqa: PLW2901
        assert chosen(monkeypatch, {ahead: FREE, STOPPED: (near, 0.0)}, scene=crossing) == expected
    near = 0.01 + (to_port if side > 0.0 else 0.0)
    assert chosen(monkeypatch, {astern: FREE, STOPPED: (near, 0.0)}, scene=crossing) == astern


@pytest.mark.parametrize(("distance_m", "expected"), [(2.0, 0.7), (2.4, 0.35)])
def test_a_course_without_a_margin_of_room_is_no_way_out(
    monkeypatch: pytest.MonkeyPatch, distance_m: float, expected: float
) -> None:
    angle = math.radians(20.0)  # a detour keeps 1.2 margins: 0.8 m and 1.2 m of room
    rock = Point(distance_m * math.cos(angle), distance_m * math.sin(angle))
    beside = scene_of(mover(9.0, 0.0), solid=(rock,))
    options = {(0.35, 1.0): FREE, (-1.4, 1.0): FREE, (0.7, 1.0): (0.05, 0.0)}
    found = chosen(monkeypatch, options, scene=beside)
    assert found is not None
    assert found.turn_rad == (0.35 if expected == 0.35 else found.turn_rad)
    assert (found.turn_rad == 0.35) is (expected == 0.35)


def test_with_a_mover_alongside_the_last_maneuver_is_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    last = EvasiveManeuver(0.7, 1.0)
    beside = scene_of(mover(0.0, 1.3))
    assert chosen(monkeypatch, {STRAIGHT: FREE}, last, beside) == last
    assert chosen(monkeypatch, {STRAIGHT: FREE}, None, beside) is None
    assert chosen(monkeypatch, {STRAIGHT: FREE}, last) is None, "nothing is near"
