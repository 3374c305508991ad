"""The look through a mission for what leaves the fence, and the way onto its first leg."""

import pytest
from boat_rig import FRAME, place
from laid_fence import L_WATER, area, laid

from companion.config.tuning import FenceSetting
from companion.core.geo import LatLon, LocalFrame, Point
from companion.core.status_text import Severity, StatusText
from companion.vehicle.mission.check import MissionCheck
from companion.vehicle.mission.steps import GoRound, Home, Offset, SetSpeed, Step, Waypoint


def looked(*steps: Step, looks: int = 20) -> tuple[str, list[str]]:
    """The fault, and what the operator was told."""
    texts: list[StatusText] = []
    check, mission = MissionCheck(texts), (Home(), *steps)
    assert check.fault == ""
    for _ in range(looks):
        check.advance(mission, laid(L_WATER), FRAME)
    assert all(text.severity == Severity.WARNING for text in texts)
    return check.fault, [text.text for text in texts]


def to(north_m: float, east_m: float) -> Waypoint:
    return Waypoint(Point(north_m, east_m))


@pytest.mark.parametrize(
    ("steps", "fault"),
    [
        ([to(0.0, 60.0), to(60.0, 60.0)], ""),
        ([to(60.0, 0.0)], "item 1 is outside the fence"),
        ([to(0.0, 10.0), to(60.0, 60.0)], "the way to item 2 leaves the fence"),
        ([to(0.0, 10.0), SetSpeed(1.0), to(60.0, 60.0)], "the way to item 3 leaves the fence"),
        (
            [to(0.0, 10.0), GoRound(Point(0.0, 20.0), 1.0), to(60.0, 60.0)],
            "",
        ),  # it leaves the circle anywhere
        ([to(0.0, 10.0), GoRound(Point(60.0, 0.0), 1.0)], "item 2 is outside the fence"),
        ([to(0.0, 10.0), Waypoint(Offset(90.0, 0.0)), to(60.0, 60.0)], ""),  # from wherever its leg begins
        ([Waypoint(place(60.0, 0.0))], "item 1 is outside the fence"),
        ([Waypoint(place(60.0, 60.0))], ""),
    ],
)
def test_what_leaves_the_fence_is_found_and_told_once(steps: list[Step], fault: str) -> None:
    assert looked(*steps) == (fault, [f"Mission: {fault}"] if fault else [])


def test_ten_items_are_looked_at_in_a_tick() -> None:
    inside, outside = to(0.0, 0.0), to(90.0, 0.0)
    # Home is item 0: the first look ends with item 9
    assert looked(*[inside] * 8, outside, looks=1)[0] == "item 9 is outside the fence"
    assert looked(*[inside] * 9, outside, looks=1)[0] == ""
    assert looked(*[inside] * 9, outside, looks=2)[0] == "item 10 is outside the fence"
    assert looked(*[inside] * 19, outside, looks=2)[0] == ""
    assert looked(*[inside] * 19, outside, looks=3)[0] == "item 20 is outside the fence"


def test_the_way_is_looked_at_across_two_ticks() -> None:
    steps = [to(0.0, 10.0)] * 9 + [to(60.0, 60.0)]
    assert looked(*steps, looks=2)[0] == "the way to item 10 leaves the fence"


def test_another_mission_fence_or_frame_is_looked_at_from_the_beginning() -> None:
    texts: list[StatusText] = []
    check, fence = MissionCheck(texts), laid(L_WATER)
    bad, good = (Home(), to(90.0, 0.0)), (Home(), to(0.0, 0.0))
    check.advance(bad, fence, FRAME)
    assert check.fault
    check.advance(good, fence, FRAME)
    assert not check.fault
    fence.set_areas([area([(-50.0, 0.0), (-50.0, 5.0), (-45.0, 0.0)])])
    fence.update(FRAME, None, FenceSetting())
    check.advance(good, fence, FRAME)
    assert len(texts) == 2
    fence.set_areas([L_WATER])
    fence.update(FRAME, None, FenceSetting())
    check.advance(good, fence, FRAME)
    assert not check.fault
    check.advance(bad, fence, FRAME)
    check.advance(bad, fence, LocalFrame(LatLon(50.0, -1.2)))
    assert len(texts) == 4
