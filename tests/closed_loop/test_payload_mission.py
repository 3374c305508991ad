"""A mission with payload items, uploaded and sailed; outputs and places as the emulator records them."""

import pytest
from boat_rig import waypoint
from payload_rig import BAIT, GRIPPER, PUMP, SAMPLE, PayloadRig
from sailing_rig import do

from companion.mavlink.dialect import dialect

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
