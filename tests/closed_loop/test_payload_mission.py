"""A mission with payload items, uploaded and sailed; outputs and places as the emulator records them."""

import pytest
from boat_rig import waypoint
from payload_rig import BAIT, GRIPPER, PUMP, SAMPLE, PayloadRig
from sailing_rig import do

from companion.core.geo import LatLon, LocalFrame, Point
from companion.mavlink.dialect import dialect
from mission_tools.mission.trigger import parse_trigger
from mission_tools.tasks.task_route import TaskLeg, TaskRoute, mission_of

CMD = dialect


def test_the_boat_sails_to_an_item_and_works_its_payload_there() -> None:
    rig = PayloadRig().sail(
        waypoint(20.0, 0.0),
        do(CMD.MAV_CMD_DO_GRIPPER, 1, 0),
        do(CMD.MAV_CMD_DO_REPEAT_RELAY, 0, 2, 2.0),
        do(CMD.MAV_CMD_DO_SET_SERVO, 9, 1200),
        waypoint(40.0, 0.0),
        do(CMD.MAV_CMD_IMAGE_START_CAPTURE, 0, 0, 1, 1),
        do(CMD.MAV_CMD_DO_SEND_SCRIPT_MESSAGE, 7),
        do(CMD.MAV_CMD_CONDITION_DISTANCE, 10.0),
        do(CMD.MAV_CMD_DO_SET_RELAY, 0, 1),
        waypoint(40.0, 30.0),
        do(CMD.MAV_CMD_DO_SET_SERVO, 9, 1800),
    )
    rig.until(lambda: bool(rig.values(GRIPPER)), 60.0)
    assert rig.offset_m(20.0, 0.0) < 3.0
    assert rig.values(GRIPPER) == [1900]  # open
    assert rig.output(BAIT).value == 1200
    capture = rig.sim.capture
    assert capture is not None
    assert not capture.starts
    rig.until(lambda: bool(capture.starts), 60.0)
    assert rig.offset_m(40.0, 0.0) < 3.0
    assert len(rig.sim.programs[SAMPLE].starts) == 1
    assert rig.values(PUMP) == [0, 1, 0, 1, 0]
    times_s = [one.time_s for one in rig.output(PUMP).history[1:]]
    assert [later - times_s[0] for later in times_s] == pytest.approx([0.0, 1.0, 2.0, 3.0], abs=0.021)
    rig.until(lambda: rig.values(PUMP) == [0, 1, 0, 1, 0, 1], 60.0)
    assert rig.offset_m(40.0, 20.0) < 2.0, "ten metres before the waypoint"
    rig.until(lambda: rig.mode != "AUTO", 120.0)
    rig.step()
    assert rig.output(BAIT).value == 1800  # the last item is done, too
    assert not [text for text in rig.peer.texts if "ignored" in text]


def test_images_are_taken_along_the_tracks_of_a_planned_survey_and_nowhere_else() -> None:
    """Two tracks of 30 m, 20 m apart, and an image every 6 m of them: six each, the first at once."""
    corners = [
        Point(*at) for at in ((0.0, 0.0), (15.0, 0.0), (45.0, 0.0), (45.0, 20.0), (15.0, 20.0), (0.0, 20.0))
    ]
    kinds = ("transit", "track", "transit", "track", "transit")
    route = TaskRoute(tuple(TaskLeg(kind, corners[n : n + 2]) for n, kind in enumerate(kinds)))  # type: ignore[arg-type]
    frame = LocalFrame(LatLon(50.0, -1.0))
    items = []
    for item in mission_of(route, frame, trigger=parse_trigger("camera:6")).items:
        local = None if item.place is None else frame.to_local(item.place)
        items.append(
            do(item.command, *item.params) if local is None else waypoint(local.north_m, local.east_m)
        )
    rig = PayloadRig().sail(*items)
    capture = rig.sim.capture
    assert capture is not None
    places: list[tuple[float, float]] = []

    def is_done() -> bool:
        if len(capture.starts) > len(places):
            truth = rig.world.truth
            places.append((truth.north_m, truth.east_m))
        return rig.mode != "AUTO"

    rig.until(is_done, 200.0)
    assert 10 <= len(places) <= 12
    assert all(12.0 < north_m < 48.0 for north_m, _ in places)
    assert all(min(abs(east_m), abs(east_m - 20.0)) < 3.0 for _, east_m in places)
