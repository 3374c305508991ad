import math

import pytest
from boat_rig import HOME_ITEM, OK, Rig, Silent, waypoint
from fence_rig import L_CORNERS, fenced, polygon

from companion.core.geo import LatLon, Point
from companion.core.modes import Mode
from companion.core.units import deg_to_e7
from companion.mavlink.dialect import Message, dialect
from companion.services.telemetry.service import BUILDERS

pytestmark = pytest.mark.slow


def latest(rig: Rig, name: str) -> Message:
    return rig.peer.said(name)[-1]


@pytest.fixture(scope="module")
def rig() -> Rig:
    """A boat under way due east, 20 s into its mission."""
    rig = Rig().sail(waypoint(0.0, 100.0))
    rig.run(20.0)
    return rig


def test_all_that_the_boat_offers_can_be_requested(rig: Rig) -> None:
    rig.boat.free_memory_bytes = 1 << 30
    rig.step()
    # Open water has nothing to echo, sonar and sounder may not be fitted; no fence, payload, corrections,
    # and no speed controllers that report
    silent = (
        dialect.MAVLINK_MSG_ID_GPS_RTK,
        dialect.MAVLINK_MSG_ID_DISTANCE_SENSOR,
        dialect.MAVLINK_MSG_ID_OBSTACLE_DISTANCE,
        dialect.MAVLINK_MSG_ID_OBSTACLE_DISTANCE_3D,
        dialect.MAVLINK_MSG_ID_FENCE_STATUS,
        dialect.MAVLINK_MSG_ID_RELAY_STATUS,
        dialect.MAVLINK_MSG_ID_WINCH_STATUS,
        dialect.MAVLINK_MSG_ID_WATER_DEPTH,
        dialect.MAVLINK_MSG_ID_ESC_TELEMETRY_1_TO_4,
    )
    for message_id, builder in BUILDERS.items():
        if message_id in silent:
            continue
        assert rig.ask(dialect.MAV_CMD_REQUEST_MESSAGE, message_id) == OK, builder
        assert [one for one in rig.peer.heard if one.get_msgId() == message_id]
    rig.run(5.0)  # for the tests that follow


def test_position_and_motion_are_those_of_the_boat(rig: Rig) -> None:
    truth, frame = rig.world.truth, rig.scenario.frame
    message = latest(rig, "GLOBAL_POSITION_INT")
    north_m, east_m = frame.to_local(LatLon(message.lat / 1e7, message.lon / 1e7))
    assert math.hypot(north_m - truth.north_m, east_m - truth.east_m) < 1.5
    assert message.vy / 100.0 == pytest.approx(2.0, abs=0.25)
    assert message.hdg / 100.0 == pytest.approx(90.0, abs=6.0)
    hud = latest(rig, "VFR_HUD")
    assert hud.groundspeed == pytest.approx(2.0, abs=0.25)
    assert hud.heading == pytest.approx(90, abs=6)
    assert 30 < hud.throttle <= 100
    attitude = latest(rig, "ATTITUDE")
    assert attitude.yaw == pytest.approx(math.pi / 2, abs=0.1)
    assert (attitude.roll, attitude.pitch) == (0.0, 0.0)
    assert rig.ask(dialect.MAV_CMD_REQUEST_MESSAGE, dialect.MAVLINK_MSG_ID_ATTITUDE_QUATERNION) == OK
    turned = latest(rig, "ATTITUDE_QUATERNION")
    assert (turned.q1, turned.q4) == pytest.approx((math.sqrt(0.5), math.sqrt(0.5)), abs=0.1)
    assert turned.q2 == turned.q3 == turned.rollspeed == turned.pitchspeed == 0.0
    rig.run(5.0)  # for the tests that follow


def test_guidance_and_motors_are_shown(rig: Rig) -> None:
    output = latest(rig, "NAV_CONTROLLER_OUTPUT")
    assert output.target_bearing == pytest.approx(90, abs=5)
    assert output.wp_dist == pytest.approx(rig.offset_m(0.0, 100.0), abs=3.0)
    assert abs(output.xtrack_error) < 1.0
    target, item = latest(rig, "POSITION_TARGET_GLOBAL_INT"), waypoint(0.0, 100.0)
    assert (target.lat_int, target.lon_int) == (item.x, item.y)
    assert math.hypot(target.vx, target.vy) > 0.2
    servos = latest(rig, "SERVO_OUTPUT_RAW")
    assert servos.servo1_raw > 1600
    assert servos.servo3_raw > 1600
    pid = latest(rig, "PID_TUNING")
    assert pid.axis == dialect.PID_TUNING_YAW
    assert pid.desired == pytest.approx(90.0, abs=10.0)


def test_a_boat_that_knows_nothing_says_so_instead_of_inventing() -> None:
    rig = Rig(gnss=Silent())
    rig.run(10.0)
    raw = latest(rig, "GPS_RAW_INT")
    assert raw.fix_type == dialect.GPS_FIX_TYPE_NO_GPS
    assert raw.lat == raw.lon == raw.alt == raw.satellites_visible == 0
    assert raw.eph == raw.epv == raw.vel == raw.cog == 0xFFFF
    assert not rig.peer.said("GLOBAL_POSITION_INT")
    assert not rig.peer.said("HOME_POSITION")
    status = latest(rig, "SYS_STATUS")
    assert not status.onboard_control_sensors_health & dialect.MAV_SYS_STATUS_SENSOR_GPS


def test_the_prearm_bit_says_whether_the_boat_would_arm() -> None:
    bit = dialect.MAV_SYS_STATUS_PREARM_CHECK
    for limit_v, well in ((10.0, True), (50.0, False)):
        rig = Rig(config={"arming.battery_min_v": limit_v})
        rig.run(10.0)
        status = latest(rig, "SYS_STATUS")
        assert status.onboard_control_sensors_enabled & bit
        assert bool(status.onboard_control_sensors_health & bit) is well
        assert (rig.arm() == OK) is well


def test_the_mission_is_reported_through_all_its_states() -> None:
    rig = Rig().ready()

    def state() -> int:
        assert rig.ask(dialect.MAV_CMD_REQUEST_MESSAGE, dialect.MAVLINK_MSG_ID_MISSION_CURRENT) == OK
        return int(latest(rig, "MISSION_CURRENT").mission_state)

    assert state() == dialect.MISSION_STATE_NO_MISSION
    rig.upload([HOME_ITEM, waypoint(15.0, 0.0), waypoint(15.0, 15.0)])
    assert state() == dialect.MISSION_STATE_NOT_STARTED
    rig.arm()
    rig.ask(dialect.MAV_CMD_MISSION_START)
    rig.run(2.0)
    assert state() == dialect.MISSION_STATE_ACTIVE
    rig.set_mode(4)
    assert state() == dialect.MISSION_STATE_PAUSED
    rig.set_mode(10)
    rig.until(lambda: rig.mode != "AUTO", 60.0)
    assert state() == dialect.MISSION_STATE_COMPLETE
    current = latest(rig, "MISSION_CURRENT")
    assert (current.seq, current.total, current.mission_mode) == (2, 2, 2)


def test_the_distance_home_is_that_along_the_way() -> None:
    rig = fenced(Rig().ready(), *polygon(L_CORNERS))
    assert rig.set_mode(Mode.RTL) == OK
    place = rig.scenario.frame.to_global(Point(60.0, 60.0))
    rig.peer.command_int(dialect.MAV_CMD_DO_SET_HOME, x=deg_to_e7(place.lat_deg), y=deg_to_e7(place.lon_deg))
    rig.run(1.0)
    assert rig.arm() == OK
    rig.run(3.0)
    left_m = rig.offset_m(15.0, 45.0) + math.hypot(45.0, 15.0)  # round the corner of the water
    assert rig.offset_m(60.0, 60.0) < left_m - 5.0
    assert latest(rig, "NAV_CONTROLLER_OUTPUT").wp_dist == pytest.approx(left_m, abs=4.0)
