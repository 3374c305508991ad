"""A mission with payload items, uploaded and sailed; outputs and places as the emulator records them."""

from itertools import pairwise

import pytest
from boat_rig import OK, waypoint
from payload_rig import BAIT, GRIPPER, PUMP, SAMPLE, PayloadRig

from companion.mavlink.dialect import dialect
from companion.mavlink.items import MissionItem

CMD = dialect


def do(command: int, *params: float) -> MissionItem:
    """An item as QGroundControl sends it: frame 2, the fifth parameter in x."""
    p = [*params, *[0.0] * (7 - len(params))]
    return MissionItem(2, command, 0, 1, p[0], p[1], p[2], p[3], int(p[4]), int(p[5]), p[6])


def test_the_boat_sails_to_an_item_and_works_its_payload_there() -> None:
    rig = PayloadRig().sail(
        waypoint(20.0, 0.0),
        do(CMD.MAV_CMD_DO_GRIPPER, 1, 0),
        do(CMD.MAV_CMD_DO_REPEAT_RELAY, 0, 2, 2.0),
        do(CMD.MAV_CMD_DO_SET_SERVO, 9, 1200),
        waypoint(40.0, 0.0),
        do(CMD.MAV_CMD_IMAGE_START_CAPTURE, 0, 0, 1, 1),
        do(CMD.MAV_CMD_DO_SEND_SCRIPT_MESSAGE, 7),
        waypoint(40.0, 20.0),
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
    rig.until(lambda: rig.mode != "AUTO", 120.0)
    rig.step()
    assert rig.output(BAIT).value == 1800  # the last item is done, too
    assert not [text for text in rig.peer.texts if "ignored" in text]


def test_images_by_distance_are_as_far_apart_as_asked() -> None:
    rig = PayloadRig()
    capture = rig.sim.capture
    assert capture is not None
    capture.run_s = 0.5
    rig.sail(
        waypoint(10.0, 0.0),
        do(CMD.MAV_CMD_DO_SET_CAM_TRIGG_DIST, 5.0),
        waypoint(50.0, 0.0),
        do(CMD.MAV_CMD_DO_SET_CAM_TRIGG_DIST, 0.0),
        waypoint(70.0, 0.0),
    )
    places: list[float] = []
    while rig.mode == "AUTO":
        rig.step()
        if len(capture.starts) > len(places):
            places.append(rig.world.truth.north_m)
        assert rig.now_s < 200.0
    gaps = [b - a for a, b in pairwise(places)]
    assert 6 <= len(places) <= 9
    assert gaps == pytest.approx([5.0] * len(gaps), abs=0.7)
    assert max(places) < 53.0


def test_a_payload_item_behind_a_condition_waits_for_it() -> None:
    rig = PayloadRig().sail(
        waypoint(10.0, 0.0),
        do(CMD.MAV_CMD_CONDITION_DISTANCE, 15.0),
        do(CMD.MAV_CMD_DO_SET_RELAY, 0, 1),
        waypoint(60.0, 0.0),
    )
    rig.until(lambda: rig.values(PUMP) == [0, 1], 90.0)
    assert rig.offset_m(45.0, 0.0) < 2.0
    assert rig.ask(CMD.MAV_CMD_DO_SET_RELAY, 0, 0) == OK
