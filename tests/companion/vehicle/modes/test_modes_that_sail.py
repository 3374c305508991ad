"""The modes that sail somewhere, each alone: may it be entered, what it does as it begins, and its intent."""

import math

import pytest
from boat_rig import FRAME, nav_at, place
from mode_inputs import around, mode_inputs, turned

from companion.config.boat_config import BoatConfig, with_value
from companion.core.geo import Point
from companion.core.intent import (
    FollowCircle,
    FollowLeg,
    Intent,
    KeepStation,
)
from companion.core.status_text import StatusText
from companion.geofence.fence import Fence
from companion.vehicle.mission.progress import MissionProgress
from companion.vehicle.mission.steps import HandOver, Home, Waypoint
from companion.vehicle.modes.auto import AutoMode
from companion.vehicle.modes.circle import CircleMode
from companion.vehicle.modes.guided import GuidedMode
from companion.vehicle.modes.rtl import RtlMode
from companion.vehicle.modes.smart_rtl import SmartRtlMode
from companion.vehicle.return_route import ReturnRoute
from companion.vehicle.track import SailedTrack

CONFIG = BoatConfig()


def local(intent: Intent) -> Point:
    assert isinstance(intent, KeepStation)
    return intent.point


@pytest.mark.parametrize(("direction", "clockwise"), [(0, True), (1, False)])
def test_circle_goes_round_a_point_ahead(direction: int, clockwise: bool) -> None:
    config = with_value(with_value(CONFIG, "modes.circle_radius_m", 8.0), "modes.circle_direction", direction)
    mode = CircleMode()
    mode.enter(mode_inputs())
    intent = mode.intent(mode_inputs(turned(math.pi / 2.0), config=config))
    assert isinstance(intent, FollowCircle)
    assert intent.centre == pytest.approx((0.0, 8.0))
    assert (intent.radius_m, intent.clockwise, intent.speed_m_s) == (8.0, clockwise, 2.0)
    assert mode.intent(mode_inputs(nav_at(5.0, 5.0), config=config)) == intent
    mode.enter(mode_inputs())
    assert mode.intent(mode_inputs(nav_at(5.0, 5.0), config=config)) != intent


def routed(mode_texts: list[StatusText], config: BoatConfig = CONFIG) -> RtlMode:
    route = ReturnRoute(around(Fence()), mode_texts)
    route.prepare(FRAME, place(50.0, 0.0), config)
    mode = RtlMode(route, mode_texts)
    mode.enter(mode_inputs())
    return mode


def test_rtl_sails_home_at_its_own_speed_and_stays() -> None:
    texts: list[StatusText] = []
    mode = routed(texts)
    config = with_value(CONFIG, "mission.rtl_speed_m_s", 1.25)
    leg = mode.intent(mode_inputs(config=config))
    assert isinstance(leg, FollowLeg)
    assert leg.end == pytest.approx((50.0, 0.0), abs=1e-3)
    assert leg.speed_m_s == 1.25
    assert local(mode.intent(mode_inputs(nav_at(50.0, 0.0)))) == pytest.approx((50.0, 0.0), abs=1e-3)
    assert len(texts) == 1  # arrived
    mode.intent(mode_inputs(nav_at(49.0, 0.0)))
    assert [one.text for one in texts] == ["RTL: arrived"]
    assert mode.destination == place(50.0, 0.0)


def test_rtl_needs_a_home_unless_there_are_rally_points() -> None:
    route = ReturnRoute(around(Fence()), [])
    mode = RtlMode(route, [])
    assert mode.fault(mode_inputs(home=None)) == "no home"
    assert mode.fault(mode_inputs(home=place(100_500.0, 0.0))) == "home is more than 100 km away"
    assert mode.fault(mode_inputs()) == ""
    route.rally = (place(10.0, 0.0),)
    assert mode.fault(mode_inputs(home=None)) == ""


def tracked(*points: tuple[float, float]) -> SailedTrack:
    track = SailedTrack()
    track.points = [Point(*point) for point in points]
    return track


def test_smart_rtl_sails_the_track_back_leg_by_leg() -> None:
    texts: list[StatusText] = []
    track = tracked((0.0, 0.0), (40.0, 0.0), (40.0, 40.0))
    mode = SmartRtlMode(track, around(Fence()), texts)
    mode.enter(mode_inputs())
    ends = []
    for at in ((40.0, 60.0), (40.0, 40.0), (40.0, 0.0)):
        intent = mode.intent(mode_inputs(nav_at(*at)))
        assert isinstance(intent, FollowLeg)
        ends.append(tuple(intent.end))
    assert ends == [(40.0, 40.0), (40.0, 0.0), (0.0, 0.0)]
    assert local(mode.intent(mode_inputs(nav_at()))) == (0.0, 0.0)
    assert [one.text for one in texts] == ["SMART_RTL: arrived"]
    assert track.points == [Point(0.0, 0.0)]
    mode.enter(mode_inputs())
    assert isinstance(mode.intent(mode_inputs(nav_at(20.0, 0.0))), FollowLeg), (
        "sailed again when entered again"
    )


def auto(*steps: Waypoint | HandOver) -> tuple[AutoMode, GuidedMode, MissionProgress]:
    progress, guided = MissionProgress(), GuidedMode(around(Fence()), [])
    progress.replace((Home(), *steps))
    mode = AutoMode(progress, guided, around(Fence()), [])
    mode.prepare(FRAME)
    return mode, guided, progress


def test_auto_sails_the_mission_and_needs_one() -> None:
    mode, _, progress = auto(Waypoint(place(50.0, 0.0)))
    assert mode.fault(mode_inputs()) == ""
    mode.enter(mode_inputs())
    leg = mode.intent(mode_inputs())
    assert isinstance(leg, FollowLeg)
    assert mode.destination == place(50.0, 0.0)
    progress.replace((Home(),))
    assert mode.fault(mode_inputs()) == "no mission"


def test_auto_starts_a_complete_mission_again_and_continues_another() -> None:
    mode, _, progress = auto(Waypoint(place(50.0, 0.0)), Waypoint(place(50.0, 50.0)))
    progress.set_current(2)
    mode.enter(mode_inputs())
    assert progress.current_seq == 2
    progress.finished = True
    mode.enter(mode_inputs())
    assert progress.current_seq == 1


def test_auto_keeps_station_where_a_hand_over_begins() -> None:
    """Not at the station of the mode before, which may be far off."""
    mode, guided, progress = auto(HandOver(True), Waypoint(place(50.0, 0.0)))
    guided.enter(mode_inputs(nav_at(-300.0, 0.0)))
    guided.intent(mode_inputs(nav_at(-300.0, 0.0)))
    mode.enter(mode_inputs())
    assert local(mode.intent(mode_inputs(nav_at(7.0, 0.0)))) == pytest.approx((7.0, 0.0), abs=1e-3)
    assert progress.is_handed_over
    guided.go_to(place(20.0, 0.0))
    assert isinstance(mode.intent(mode_inputs(nav_at(7.0, 0.0))), FollowLeg)  # entered once, not each tick
    mode.exit()
    assert guided.target is None
