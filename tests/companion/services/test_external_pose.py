"""Position, heading and obstacles from outside: what is taken, what is dropped, what the boat makes of it."""

import math

import pytest
from boat_rig import OK, Peer, Rig, Silent
from hypothesis import given, settings
from hypothesis import strategies as st

from companion.core.geo import LatLon
from companion.core.units import deg_to_e7
from companion.mavlink.address import Address
from companion.mavlink.dialect import Message, dialect

pytestmark = pytest.mark.slow

CAMERA = Address(1, 197)
NAN = math.nan
ORIGIN = LatLon(50.0, -1.2)
NED, FRD, BODY_FRD = dialect.MAV_FRAME_LOCAL_NED, dialect.MAV_FRAME_LOCAL_FRD, dialect.MAV_FRAME_BODY_FRD
ALONE: dict[str, object] = {"external.position": 2, "external.heading": 2}


def set_origin(place: LatLon) -> Message:
    message: Message = dialect.MAVLink_set_gps_global_origin_message(
        1, deg_to_e7(place.lat_deg), deg_to_e7(place.lon_deg), 0
    )
    return message


def vision(
    north_m: float, east_m: float, yaw_rad: float, stamp_us: int = 0,
    variances: tuple[float, float] = (4e-6, 4e-6),  # 2 mm
) -> Message:  # fmt: skip
    covariance = [variances[0], *[0.0] * 5, variances[1], *[0.0] * 14]
    message: Message = dialect.MAVLink_vision_position_estimate_message(
        stamp_us, north_m, east_m, 0.0, 0.0, 0.0, yaw_rad, covariance
    )
    return message


def odometry(
    x: float, y: float, yaw: float, vx: float, vy: float, rate: float, frame: int = NED, quality: int = 100
) -> Message:
    q = [math.cos(yaw / 2), 0.0, 0.0, math.sin(yaw / 2)]
    covariances = [NAN] + [0.0] * 20
    message: Message = dialect.MAVLink_odometry_message(
        0, frame, BODY_FRD, x, y, 0.0, q, vx, vy, 0.0, 0.0, 0.0, rate, covariances, covariances, 0, 0, quality
    )
    return message


def gps_input(place: LatLon, fix_type: int = 3, yaw_cdeg: int = 0, **values: float) -> Message:
    fields = {"hdop": 0.9, "vn": 1.0, "ve": 0.5, "horiz_accuracy": 0.4, **values}
    lat, lon = deg_to_e7(place.lat_deg), deg_to_e7(place.lon_deg)
    message: Message = dialect.MAVLink_gps_input_message(
        0, 0, 0, 0, 0, fix_type, lat, lon, 0.0, fields["hdop"], 1.0, fields["vn"], fields["ve"], 0.0,
        0.1, fields["horiz_accuracy"], 0.1, 14, yaw_cdeg,
    )  # fmt: skip
    return message


def blind(**config: object) -> tuple[Rig, Peer]:
    """A boat with neither receiver nor compass, and the camera that stands in for both."""
    rig = Rig(config={**ALONE, **config}, gnss=Silent(), compass=Silent(), sonar=None)
    camera = rig.connect(CAMERA)
    rig.peer.send(set_origin(ORIGIN))
    rig.step()
    return rig, camera


def watch(rig: Rig, camera: Peer, seconds: float, *poses: Message) -> None:
    """The camera says these at 25 Hz."""
    for _ in range(round(seconds / 0.04)):
        for pose in poses:
            camera.send(pose)
        rig.step(2)


def test_a_local_pose_is_where_the_boat_is() -> None:
    rig, camera = blind()
    watch(rig, camera, 2.0, vision(3.0, -2.0, 1.0))
    nav = rig.boat.nav
    assert nav is not None
    assert (nav.north_m, nav.east_m) == pytest.approx((3.0, -2.0), abs=1e-3)
    assert nav.heading_rad == pytest.approx(1.0, abs=1e-3)
    assert rig.boat.estimator.frame is not None
    assert rig.boat.estimator.frame.origin == ORIGIN


@pytest.mark.parametrize(
    ("north", "east", "sigma_m"),
    [
        (0.04, 0.25, 0.5), (0.25, 0.04, 0.5), (9e3, 0.0, math.sqrt(9e3)), (1.1e4, 0.0, 0.05),
        (2e-6, 0.0, 1.414e-3), (5e-7, 0.0, 0.05), (NAN, 0.25, 0.05), (0.0, 0.0, 0.05),
    ],
)  # fmt: skip
def test_the_accuracy_of_a_pose_is_the_worse_one_of_both_axes_within_reason(
    north: float, east: float, sigma_m: float
) -> None:
    rig, camera = blind()
    watch(rig, camera, 0.1, vision(3.0, -2.0, 1.0, variances=(north, east)))
    fix = rig.boat.sensors.external.fix
    assert fix is not None
    assert fix.horizontal_accuracy_m == pytest.approx(sigma_m, rel=1e-3)


def test_the_origin_is_told_and_once_laid_is_not_moved() -> None:
    rig, camera = blind()
    (said,) = rig.peer.said("GPS_GLOBAL_ORIGIN")
    assert (said.latitude, said.longitude) == (500_000_000, -12_000_000)
    watch(rig, camera, 1.0, vision(0.0, 0.0, 0.0))
    rig.peer.forget()
    rig.peer.send(dialect.MAVLink_set_gps_global_origin_message(1, 510_000_000, 0, 0))
    watch(rig, camera, 0.5, vision(0.0, 0.0, 0.0))
    assert "Origin: already set, not moved" in rig.peer.texts
    assert rig.boat.vehicle.frame is not None
    assert rig.boat.vehicle.frame.origin == ORIGIN


@pytest.mark.parametrize(
    "pose",
    [
        vision(NAN, 0.0, 0.0),
        vision(0.0, math.inf, 0.0),
        vision(0.0, 0.0, NAN),
        vision(1e6, 0.0, 0.0),
        odometry(NAN, 0.0, 0.0, 0.0, 0.0, 0.0),
        odometry(0.0, 0.0, NAN, 0.0, 0.0, 0.0),
        odometry(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, quality=-1),
        odometry(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, frame=dialect.MAV_FRAME_GLOBAL),
        gps_input(LatLon(0.0, 0.0)),
        gps_input(ORIGIN, fix_type=9),
        gps_input(ORIGIN, hdop=NAN),
        gps_input(ORIGIN, hdop=-1.0),
        gps_input(ORIGIN, horiz_accuracy=-1.0),
        gps_input(ORIGIN, vn=math.inf),
        gps_input(ORIGIN, horiz_accuracy=NAN),
    ],
)
def test_what_is_no_pose_is_dropped_and_counted(pose: Message) -> None:
    rig, camera = blind()
    watch(rig, camera, 0.4, pose)
    assert rig.boat.nav is None
    assert rig.boat.sensors.external.fix is None
    assert rig.boat.endpoint._pose.dropped == 10
    assert rig.boat.endpoint.faults == 0


@settings(max_examples=12)
@given(
    st.lists(st.floats(width=32), min_size=10, max_size=10),
    st.lists(st.floats(width=32), min_size=4, max_size=4),
    st.integers(0, 30),
)
def test_no_odometry_makes_the_estimate_something_other_than_numbers(
    values: list[float], q: list[float], frame: int
) -> None:
    rig, camera = blind()
    x, y, z, vx, vy, vz, roll, pitch, rate, first = values
    covariances = [first] * 21
    camera.send(
        dialect.MAVLink_odometry_message(
            0, frame, BODY_FRD, x, y, z, q, vx, vy, vz, roll, pitch, rate, covariances, covariances
        )
    )
    rig.step(10)
    nav = rig.boat.nav
    if nav is not None:
        assert all(map(math.isfinite, (nav.north_m, nav.east_m, nav.heading_rad, nav.yaw_rate_rad_s)))
    assert rig.boat.endpoint.faults == 0


def test_a_fallback_is_taken_only_while_the_receiver_is_silent() -> None:
    rig = Rig(config={"external.position": 1}, gnss=Silent())
    camera = rig.connect(CAMERA)
    watch(rig, camera, 1.0, gps_input(ORIGIN))
    assert rig.boat.nav is not None
    assert rig.boat.nav.position_age_s < 0.1
    healthy = Rig(config={"external.position": 1}).ready()
    helper = healthy.connect(CAMERA)
    watch(healthy, helper, 1.0, gps_input(LatLon(40.0, 10.0)))
    fix = healthy.boat.sensors.fix
    assert fix is not None
    assert fix.position.lat_deg == pytest.approx(50.0, abs=0.1)


def test_one_source_at_a_time_and_another_once_the_first_is_silent() -> None:
    rig, camera = blind()
    other = rig.connect(Address(1, 198))
    watch(rig, camera, 0.5, vision(1.0, 0.0, 0.0))
    for _ in range(10):
        camera.send(vision(1.0, 0.0, 0.0))
        other.send(vision(99.0, 0.0, 0.0))
        rig.step(2)
    assert rig.boat.nav is not None
    assert rig.boat.nav.north_m == pytest.approx(1.0, abs=0.01)
    rig.run(2.0)
    watch(rig, other, 12.0, vision(99.0, 0.0, 0.0))
    assert rig.boat.nav.north_m == pytest.approx(99.0, abs=0.5)


def test_gps_input_stands_in_for_receiver_and_compass() -> None:
    rig = Rig(config=ALONE, gnss=Silent(), compass=Silent())
    camera = rig.connect(CAMERA)
    watch(rig, camera, 2.0, gps_input(ORIGIN, yaw_cdeg=9000))
    shown = rig.peer.said("GPS_RAW_INT")[-1]
    assert (shown.fix_type, shown.satellites_visible, shown.h_acc) == (3, 14, 400)
    assert rig.boat.nav is not None
    assert rig.boat.nav.heading_rad == pytest.approx(math.pi / 2, abs=1e-3)
    assert not rig.boat.vehicle.arming_faults()


def bins(rig: Rig) -> list[int]:
    assert rig.ask(dialect.MAV_CMD_REQUEST_MESSAGE, dialect.MAVLINK_MSG_ID_OBSTACLE_DISTANCE) == OK
    (message,) = rig.peer.said("OBSTACLE_DISTANCE")
    assert message.frame == BODY_FRD
    return list(message.distances)


def obstacles(distances: list[int], frame: int = BODY_FRD) -> Message:
    message: Message = dialect.MAVLink_obstacle_distance_message(0, 0, distances, 5, 20, 500, 5.0, 0.0, frame)
    return message


def test_obstacles_from_outside_are_told_on_bin_for_bin() -> None:
    rig = Rig(config={"external.obstacles": True}, sonar=None).ready()
    camera = rig.connect(CAMERA)
    seen = [0xFFFF] * 72
    seen[0], seen[18], seen[71] = 150, 501, 300
    camera.send(obstacles(seen))
    rig.step(2)
    assert bins(rig) == seen
    rig.run(4.0)
    assert rig.ask(dialect.MAV_CMD_REQUEST_MESSAGE, dialect.MAVLINK_MSG_ID_OBSTACLE_DISTANCE) != OK


EIGHTH = [math.cos(math.pi / 8.0), 0.0, 0.0, math.sin(math.pi / 8.0)]  # of a turn to starboard


@pytest.mark.parametrize(
    ("orientation", "quality", "quaternion", "sector"),
    [
        *((0, 0, None, 0), (2, 100, None, 18), (6, 0, None, 54), (7, 2, None, 63), (100, 0, EIGHTH, 9)),
        *((0, 1, None, None), (24, 0, None, None), (25, 0, None, None), (100, 0, [0.0] * 4, None)),
    ],
)
def test_a_ranger_says_what_is_in_its_direction(
    orientation: int, quality: int, quaternion: list[float] | None, sector: int | None
) -> None:
    """A quality of 1 is no signal; 24 and 25 look up and down."""
    rig = Rig(config={"external.obstacles": True}, sonar=None).ready()
    camera = rig.connect(CAMERA)
    camera.send(
        dialect.MAVLink_distance_sensor_message(
            0, 20, 700, 321, 0, 3, orientation, 255, 0.0, 0.0, quaternion or [0.0] * 4, quality
        )
    )
    rig.step(2)
    if sector is None:
        assert rig.ask(dialect.MAV_CMD_REQUEST_MESSAGE, dialect.MAVLINK_MSG_ID_OBSTACLE_DISTANCE) != OK
        return
    told = bins(rig)
    assert told[sector] == 321
    assert told[(sector + 36) % 72] == 0xFFFF


@pytest.mark.parametrize(("week", "is_believed"), [(2400, True), (0, False), (65535, False)])
def test_the_date_of_gps_input_is_believed_where_it_can_be(week: int, is_believed: bool) -> None:
    rig = Rig(config=ALONE, gnss=Silent(), compass=Silent())
    camera = rig.connect(CAMERA)
    fix = gps_input(ORIGIN)
    fix.time_week, fix.time_week_ms = week, 1000
    watch(rig, camera, 1.0, fix)
    assert rig.ask(dialect.MAV_CMD_REQUEST_MESSAGE, dialect.MAVLINK_MSG_ID_SYSTEM_TIME) == OK
    told_s = rig.peer.said("SYSTEM_TIME")[-1].time_unix_usec * 1e-6
    assert told_s == (pytest.approx(315964800 + 2400 * 604800 - 17, abs=0.1) if is_believed else 0.0)


def test_a_delayed_pose_is_placed_when_it_was_taken_where_the_clocks_are_known() -> None:
    rig, camera = blind()
    rig.until(lambda: bool(camera.said("TIMESYNC")), 11.0)  # the boat asks every ten seconds
    (question,) = camera.said("TIMESYNC")
    camera.send(dialect.MAVLink_timesync_message(question.ts1 + 500 * 10**9, question.ts1))
    rig.step(2)
    stamp_us = round((rig.now_s - 0.2 + 500.0) * 1e6)
    camera.send(vision(1.0, 1.0, 0.0, stamp_us))
    rig.step(2)
    fix = rig.boat.sensors.external.fix
    assert fix is not None
    assert fix.time_s == pytest.approx(rig.now_s - 0.24, abs=0.03)


def test_nothing_from_outside_is_taken_unless_the_configuration_says_so() -> None:
    rig = Rig().ready()
    camera = rig.connect(CAMERA)
    before = rig.boat.nav
    watch(rig, camera, 1.0, vision(500.0, 500.0, 3.0), gps_input(LatLon(40.0, 10.0)))
    nav = rig.boat.nav
    assert nav is not None
    assert before is not None
    assert math.hypot(nav.north_m - before.north_m, nav.east_m - before.east_m) < 3.0
    assert rig.boat.sensors.external.fix is None
