"""Items that work a sensor along the tracks of a task."""

import pytest

from companion.core.geo import LatLon, LocalFrame, Point
from mission_tools.errors import UsageError
from mission_tools.mission.mission import Command, Frame, MissionItem
from mission_tools.mission.trigger import Trigger, parse_trigger
from mission_tools.tasks.task_route import LegKind, TaskLeg, TaskRoute, mission_of

CAMERA = (Command.DO_SET_CAM_TRIGG_DIST, Frame.MISSION)
FRAME = LocalFrame(LatLon(50.0, -1.0))


def row(*kinds: LegKind) -> TaskRoute:
    """Legs of 10 m to the north."""
    return TaskRoute(
        tuple(
            TaskLeg(kind, (Point(10.0 * n, 0.0), Point(10.0 * n + 10.0, 0.0))) for n, kind in enumerate(kinds)
        )
    )


def commands(route: TaskRoute, trigger: Trigger | None) -> list[tuple[str, float]]:
    """W and metres to the north, or T and the distance between images."""
    return [
        ("W", round(FRAME.to_local(item.place).north_m)) if item.place is not None else ("T", item.params[0])
        for item in mission_of(route, FRAME, trigger=trigger).items
    ]


def test_images_begin_at_once_where_a_track_begins_and_end_where_it_ends() -> None:
    trigger = parse_trigger("camera:5.5")
    assert trigger.begin == MissionItem(*CAMERA, (5.5, 0.0, 1.0, 0.0))
    assert trigger.end == MissionItem(*CAMERA, (0.0, 0.0, 0.0, 0.0))
    found = commands(row("transit", "track", "transit", "track"), trigger)
    on, off = ("T", 5.5), ("T", 0.0)
    assert found == [("W", 10), on, ("W", 20), off, ("W", 30), on, ("W", 40), off]


def test_what_follows_without_a_transit_is_one_track() -> None:
    found = commands(row("transit", "shore", "track", "cross", "transit"), parse_trigger("camera:5"))
    assert found == [("W", 10), ("T", 5.0), ("W", 20), ("W", 30), ("W", 40), ("T", 0.0), ("W", 50)]


def test_a_track_that_begins_at_home_begins_when_the_boat_is_there() -> None:
    assert commands(row("track"), parse_trigger("camera:5")) == [
        ("W", 0),
        ("T", 5.0),
        ("W", 10),
        ("T", 0.0),
    ]
    assert commands(row("track"), None) == [("W", 10)]


def test_a_relay_is_on_along_tracks() -> None:
    trigger = parse_trigger("relay:3")
    assert (trigger.begin.command, trigger.begin.params[:2]) == (Command.DO_SET_RELAY, (3.0, 1.0))
    assert (trigger.end.command, trigger.end.params[:2]) == (Command.DO_SET_RELAY, (3.0, 0.0))


@pytest.mark.parametrize(
    "text",
    ["", "camera", "camera:", "camera:0", "camera:-1", "camera:nan", "camera:10001", "relay:16", "relay:0.5",
     "relay:-1", "sonar:1", "camera:1:2"],
)  # fmt: skip
def test_other_triggers_are_refused(text: str) -> None:
    with pytest.raises(UsageError, match="expected camera:METRES between images, or relay:NUMBER"):
        parse_trigger(text)
