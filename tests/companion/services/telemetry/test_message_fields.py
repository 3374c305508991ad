"""Every field of the messages that are functions of the boat's state, as pymavlink decodes them.

A row holds what differs from zero. The state has a value of its own wherever one may be told for another.
"""

import math
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import pytest

from companion import __version__
from companion.autopilot.snapshot import Snapshot
from companion.config.boat_config import BoatConfig, with_value
from companion.core.geo import LatLon, LocalFrame, Point, position_to_e7
from companion.core.modes import Mode
from companion.core.readings import DepthReading, GnssFix, HeadingReading, SonarReading
from companion.core.state import Demand, EstimateFault, MotorCommand, NavState, PidOutput
from companion.mavlink.dialect import Message, dialect
from companion.services.telemetry import estimate_messages as estimate
from companion.services.telemetry import motion_messages as motion
from companion.services.telemetry import payload_messages as payload
from companion.services.telemetry import sensor_messages as sensor
from companion.services.telemetry import sounding_messages as sounding
from companion.services.telemetry import status_messages as status

Fields = dict[str, Any]
FRAME = LocalFrame(LatLon(50.0, -1.2))
HERE, HOME, GOAL = Point(30.0, -40.0), Point(3.0, -5.0), Point(30.0, 60.0)  # the goal due east
LAT, LON = position_to_e7(FRAME.to_global(HERE))
HOME_LAT, HOME_LON = position_to_e7(FRAME.to_global(HOME))
GOAL_LAT, GOAL_LON = position_to_e7(FRAME.to_global(GOAL))
MS, US = 12_346, 12_345_600
CONFIG = BoatConfig()
NAV = NavState(
    time_s=12.3, north_m=HERE.north_m, east_m=HERE.east_m, heading_rad=-math.pi / 6.0, yaw_rate_rad_s=0.2,
    north_m_s=1.5, east_m_s=-2.0, surge_m_s=2.4, sway_m_s=0.6, position_age_s=0.5, heading_age_s=0.25,
    current_north_m_s=0.3, current_east_m_s=-0.4, position_sigma_m=2.0,
)  # fmt: skip
FIX = GnssFix(
    12.25, LatLon(50.0001, -1.2002), 4, 14, 0.75, north_m_s=-3.0, east_m_s=4.0, altitude_m=21.5,
    horizontal_accuracy_m=0.8, vertical_accuracy_m=1.2, speed_accuracy_m_s=0.05, heading_rad=0.0,
    heading_accuracy_rad=math.radians(2.0), correction_age_s=2.5,
)  # fmt: skip
PACK = SimpleNamespace(voltage_v=11.5, current_a=3.1)
COMPASS = HeadingReading(12.3, -0.5, yaw_rate_rad_s=0.25, field_mg=(110.0, -220.0, 330.0))
PING = SonarReading(12.2, -math.pi / 2.0, 1.5, min_range_m=0.25, max_range_m=4.0)
SOUNDING = DepthReading(12.1, 3.25, 17.5, min_range_m=0.3, max_range_m=50.0, quality=0.9)
MAG, GPS = dialect.MAV_SYS_STATUS_SENSOR_3D_MAG, dialect.MAV_SYS_STATUS_SENSOR_GPS
YAW, XY = dialect.MAV_SYS_STATUS_SENSOR_YAW_POSITION, dialect.MAV_SYS_STATUS_SENSOR_XY_POSITION_CONTROL
MOTORS, AHRS = dialect.MAV_SYS_STATUS_SENSOR_MOTOR_OUTPUTS, dialect.MAV_SYS_STATUS_AHRS
PREARM, FENCE = dialect.MAV_SYS_STATUS_PREARM_CHECK, dialect.MAV_SYS_STATUS_GEOFENCE
BATTERY, GYRO = dialect.MAV_SYS_STATUS_SENSOR_BATTERY, dialect.MAV_SYS_STATUS_SENSOR_3D_GYRO
RADIO, SONAR = dialect.MAV_SYS_STATUS_SENSOR_RC_RECEIVER, dialect.MAV_SYS_STATUS_SENSOR_PROXIMITY
ALWAYS, OPTIONAL = MAG | GPS | YAW | XY | MOTORS | AHRS | PREARM, FENCE | BATTERY | GYRO | RADIO | SONAR
RELATIVE = dialect.EKF_VELOCITY_HORIZ | dialect.EKF_POS_HORIZ_REL | dialect.EKF_PRED_POS_HORIZ_REL
WELL = dialect.EKF_ATTITUDE | RELATIVE | dialect.EKF_POS_HORIZ_ABS | dialect.EKF_PRED_POS_HORIZ_ABS
RECKONED = WELL & ~dialect.EKF_POS_HORIZ_ABS
UNTOLD = 0xFFFF


def state(**changes: object) -> Snapshot:
    """The boat that is told of: armed, outside of its fence, its pack low. changes: of its parts by path,
    as sensors__fix.
    """
    fence = SimpleNamespace(is_outside=True, breaches=3, breached_s=7.25)
    radio = SimpleNamespace(
        is_fitted=True, latest=SimpleNamespace(quality=0.5), is_fresh=lambda _part, _now_s: True
    )
    vehicle = SimpleNamespace(
        nav=NAV, frame=FRAME, home=FRAME.to_global(HOME), destination=FRAME.to_global(GOAL), way_left_m=None,
        armed=True, mode=Mode.AUTO, failsafes=SimpleNamespace(fence=fence, pack_is_low=True),
        fence=SimpleNamespace(is_active=True), arming_faults=list,
        manual_input=SimpleNamespace(rc=radio, channels_us=lambda _config, _now_s: [1100, 0, 1900]),
    )  # fmt: skip
    sensors = SimpleNamespace(
        fix=FIX, battery=PACK, compass=COMPASS, heading=COMPASS, sonar=PING, depth=SOUNDING, has_gyro=True,
        field=SimpleNamespace(correct=lambda field: (field[0] + 1.4, field[1] - 1.4, 2.0 * field[2])),
        gauge=SimpleNamespace(percent=63, time_left_s=4321.4), consumed_mah=1234.4, has_battery_monitor=True,
        is_sonar_fitted=True, sweep=SimpleNamespace(latest=PING, is_empty=lambda _now_s: False),
    )  # fmt: skip
    guidance = SimpleNamespace(
        demand=Demand(math.pi / 3.0, 2.0, cross_track_m=0.75, distance_m=12.4),
        helm=SimpleNamespace(heading_pid=PidOutput(0.1, 0.2, 0.3, 0.9, saturated=False, ff=0.6)),
    )
    units = SimpleNamespace(
        servo_us=lambda: [(9, 1234)], relays=lambda: (5, 7),
        winch=SimpleNamespace(out_m=2.5, speed_m_s=-0.5, is_moving=True, fault=""),
    )  # fmt: skip
    parts: dict[str, Any] = {
        "now_s": 12.3456, "unix_s": 1.7e9 + 0.25, "config": CONFIG, "vehicle": vehicle, "estimator": None,
        "sensors": sensors, "guidance": guidance, "command": MotorCommand(0.9, 0.5), "load": 0.123,
        "free_memory_bytes": 1 << 20, "payload": SimpleNamespace(units=units), "rows": (),
    }  # fmt: skip
    for path, value in changes.items():
        first, *inner = path.split("__")
        if not inner:
            parts[first] = value
            continue
        part = parts[first]
        for name in inner[:-1]:
            part = getattr(part, name)
        setattr(part, inner[-1], value)
    return Snapshot(**parts)


def nav(**changes: float) -> NavState:
    return NavState(**{name: getattr(NAV, name) for name in NAV.__struct_fields__} | changes)


def fix(**changes: Any) -> GnssFix:  # noqa: ANN401 (of any field)
    return GnssFix(**{name: getattr(FIX, name) for name in FIX.__struct_fields__} | changes)


def decoded(message: Message) -> Fields:
    """What differs from zero, by pymavlink."""
    link = dialect.MAVLink(None, 1, 1)
    told: Fields = link.decode(bytearray(message.pack(link))).to_dict()
    del told["mavpackettype"]
    return {name: value for name, value in told.items() if value not in (0, "") and value != [0] * 10}


IMU = {"zgyro": 250, "xmag": 111, "ymag": -221, "zmag": 660}
HEALTHY = {
    "onboard_control_sensors_present": ALWAYS | OPTIONAL,
    "onboard_control_sensors_enabled": ALWAYS | OPTIONAL,
    "load": 123, "voltage_battery": 11_500, "current_battery": 310, "battery_remaining": 63,
}  # fmt: skip
SENSORS, ENABLED = "onboard_control_sensors_health", "onboard_control_sensors_enabled"
PRESENT = "onboard_control_sensors_present"
SEEN = ALWAYS | GYRO | RADIO | SONAR  # outside of the fence, the pack low
GPS_RAW = {
    "time_usec": 12_250_000, "fix_type": 4, "lat": 500001000, "lon": -12002000, "alt": 21_500, "eph": 75,
    "epv": UNTOLD, "vel": 500, "cog": 12_687, "satellites_visible": 14, "h_acc": 800, "v_acc": 1200,
    "vel_acc": 50, "hdg_acc": 200_000, "yaw": 36_000,
}  # fmt: skip
STEERED = {
    "nav_bearing": 60, "target_bearing": 90, "wp_dist": 12, "aspd_error": -0.5, "xtrack_error": 0.75
}  # fmt: skip
PACK_TOLD = {
    "battery_function": dialect.MAV_BATTERY_FUNCTION_ALL, "type": dialect.MAV_BATTERY_TYPE_LIPO,
    "temperature": 0x7FFF, "voltages": [11_500] + [UNTOLD] * 9, "current_battery": 310,
    "current_consumed": 1234, "energy_consumed": -1, "battery_remaining": 63, "time_remaining": 4321,
    "charge_state": dialect.MAV_BATTERY_CHARGE_STATE_LOW, "voltages_ext": [0] * 4,
}  # fmt: skip
CHANNELS = {f"chan{number}_raw": UNTOLD for number in range(1, 19)}
LAG = 0.25 / 3.0  # of the heading, as a share of its limit
DISTANCE = {
    "time_boot_ms": 12_200, "min_distance": 25, "max_distance": 400, "current_distance": 150,
    "type": dialect.MAV_DISTANCE_SENSOR_ULTRASOUND, "orientation": dialect.MAV_SENSOR_ROTATION_YAW_270,
    "covariance": 255, "horizontal_fov": CONFIG.avoidance.beam_rad, "vertical_fov": CONFIG.avoidance.beam_rad,
    "quaternion": [math.sqrt(0.5), 0.0, 0.0, -math.sqrt(0.5)],
}  # fmt: skip
SOUNDED = {
    "time_boot_ms": 12_100, "min_distance": 30, "max_distance": 5000, "current_distance": 325, "id": 1,
    "type": dialect.MAV_DISTANCE_SENSOR_ULTRASOUND, "orientation": dialect.MAV_SENSOR_ROTATION_PITCH_270,
    "covariance": 255, "horizontal_fov": math.radians(30.0), "vertical_fov": math.radians(30.0),
    "quaternion": [0.0] * 4, "signal_quality": 90,
}  # fmt: skip
DEPTH = {
    "time_boot_ms": 12_100, "id": 1, "healthy": 1, "lat": LAT, "lng": LON, "yaw": -math.pi / 6.0,
    "distance": 3.25, "temperature": 17.5,
}  # fmt: skip
VERSION = b"%02x%02x%04x" % tuple(int(number) for number in __version__.split("."))
CAPABILITIES = sum(
    getattr(dialect, f"MAV_PROTOCOL_CAPABILITY_{name}")
    for name in (
        *("MISSION_FLOAT", "PARAM_ENCODE_C_CAST", "MISSION_INT", "COMMAND_INT", "FTP", "SET_ATTITUDE_TARGET"),
        *("SET_POSITION_TARGET_LOCAL_NED", "SET_POSITION_TARGET_GLOBAL_INT", "MAVLINK2", "MISSION_FENCE"),
        "MISSION_RALLY",
    )
)
WINCH = {
    "time_usec": US, "line_length": 2.5, "speed": -0.5, "tension": math.nan, "voltage": math.nan,
    "current": math.nan, "temperature": 0x7FFF,
    "status": dialect.MAV_WINCH_STATUS_HEALTHY | dialect.MAV_WINCH_STATUS_MOVING,
}  # fmt: skip


def ekf(flags: int, position: float, heading: float) -> Fields:
    """EKF_STATUS_REPORT."""
    told = {"velocity_variance": position, "pos_horiz_variance": position, "compass_variance": heading}
    return {"flags": flags} | {name: value for name, value in told.items() if value}


def health(bits: int, **more: Any) -> Fields:  # noqa: ANN401
    """SYS_STATUS."""
    return HEALTHY | {SENSORS: bits} | more


def winch(**changes: Any) -> SimpleNamespace:  # noqa: ANN401
    return SimpleNamespace(**{"out_m": 2.5, "speed_m_s": -0.5, "is_moving": True, "fault": ""} | changes)


Row = tuple[
    Callable[[Snapshot], Message | list[Message] | None], dict[str, Any], Fields | list[Fields] | None
]
ROWS: list[Row] = [
    (motion.attitude, {}, {"time_boot_ms": MS, "yaw": -math.pi / 6.0, "yawspeed": 0.2}),
    (
        motion.attitude_quaternion, {},
        {
            "time_boot_ms": MS, "q1": math.cos(math.pi / 12.0), "q4": -math.sin(math.pi / 12.0),
            "yawspeed": 0.2, "repr_offset_q": [0.0] * 4,
        },
    ),
    (
        motion.global_position_int, {},
        {"time_boot_ms": MS, "lat": LAT, "lon": LON, "vx": 150, "vy": -200, "hdg": 33_000},
    ),
    (
        motion.global_position_int, {"vehicle__nav": nav(north_m_s=500.0, east_m_s=-500.0)},
        {"time_boot_ms": MS, "lat": LAT, "lon": LON, "vx": 32_767, "vy": -32_767, "hdg": 33_000},
    ),
    (
        motion.global_position_int, {"vehicle__nav": nav(heading_rad=-1e-5)},
        {"time_boot_ms": MS, "lat": LAT, "lon": LON, "vx": 150, "vy": -200},
    ),
    (
        motion.local_position_ned, {},
        {"time_boot_ms": MS, "x": 30.0, "y": -40.0, "vx": 1.5, "vy": -2.0},
    ),
    (motion.gps_global_origin, {}, {"latitude": 500000000, "longitude": -12000000, "time_usec": US}),
    (
        motion.position_target_global_int, {},
        {
            "time_boot_ms": MS, "type_mask": 4 + 32 + 64 + 128 + 256 + 2048, "lat_int": GOAL_LAT,
            "lon_int": GOAL_LON, "vx": 1.0, "vy": math.sqrt(3.0), "yaw": math.pi / 3.0,
        },
    ),
    (motion.vfr_hud, {}, {"airspeed": 2.5, "groundspeed": 2.5, "heading": 330, "throttle": 70}),
    (
        motion.vfr_hud, {"command": MotorCommand(-0.5, -0.5), "vehicle__nav": nav(heading_rad=-1e-4)},
        {"airspeed": 2.5, "groundspeed": 2.5, "throttle": 50},
    ),
    (motion.gps_raw_int, {}, GPS_RAW),
    (
        motion.gps_raw_int,
        {
            "sensors__fix": fix(
                hdop=1e9, north_m_s=1e6, altitude_m=-1e9, satellites=300, horizontal_accuracy_m=None,
                vertical_accuracy_m=1e9, speed_accuracy_m_s=-1.0, heading_accuracy_rad=1e9, heading_rad=1.0,
            )
        },
        GPS_RAW
        | {"eph": 65_534, "vel": 65_534, "cog": 0, "alt": -0x7FFFFFFF, "satellites_visible": 255}
        | {"h_acc": 0, "v_acc": 0xFFFFFFFF, "vel_acc": 0, "hdg_acc": 0xFFFFFFFF, "yaw": 5730},
    ),
    (
        motion.gps_raw_int, {"sensors__fix": fix(east_m_s=None, heading_rad=None, heading_accuracy_rad=None)},
        GPS_RAW | {"vel": UNTOLD, "cog": UNTOLD, "hdg_acc": 0, "yaw": 0},
    ),
    (
        motion.gps_raw_int, {"sensors__fix": None},
        {"time_usec": US} | dict.fromkeys(("eph", "epv", "vel", "cog"), UNTOLD),
    ),
    (
        motion.gps_rtk, {},
        {
            "time_last_baseline_ms": 9750, "rtk_health": 1, "nsats": 14, "accuracy": 800,
            "baseline_coords_type": dialect.RTK_BASELINE_COORDINATE_SYSTEM_NED,
        },
    ),
    (
        motion.gps_rtk,
        {"sensors__fix": fix(time_s=130.5, correction_age_s=500.0, fix_type=3, satellites=300)},
        {
            "time_last_baseline_ms": 10_500, "nsats": 255, "accuracy": 800,
            "baseline_coords_type": dialect.RTK_BASELINE_COORDINATE_SYSTEM_NED,
        },
    ),
    (motion.gps_rtk, {"sensors__fix": fix(correction_age_s=None)}, None),
    (motion.nav_controller_output, {}, STEERED),
    (motion.nav_controller_output, {"vehicle__way_left_m": 250.4}, STEERED | {"wp_dist": 250}),
    (motion.nav_controller_output, {"vehicle__way_left_m": 1e6}, STEERED | {"wp_dist": 65_535}),
    (
        motion.nav_controller_output, {"guidance__demand": Demand(math.pi / 3.0, 2.0)},
        STEERED | {"wp_dist": 100, "xtrack_error": 0.0},  # it gives way: the goal is 100 m off
    ),
    (motion.nav_controller_output, {"vehicle__destination": None}, STEERED | {"target_bearing": 60}),
    (motion.nav_controller_output, {"guidance__demand": None}, {"nav_bearing": -30, "target_bearing": -30}),
    (
        motion.servo_output_raw, {},
        {"time_usec": US, "servo1_raw": 1950, "servo3_raw": 1750, "servo9_raw": 1234},
    ),
    (
        motion.pid_tuning, {},
        {
            "axis": dialect.PID_TUNING_YAW, "desired": 60.0, "achieved": -30.0, "FF": 0.6, "P": 0.1, "I": 0.2,
            "D": 0.3,
        },
    ),
    (motion.pid_tuning, {"guidance__demand": None}, None),
    (motion.pid_tuning, {"guidance__helm__heading_pid": None}, None),
    (sensor.scaled_imu, {}, {"time_boot_ms": MS} | IMU),
    (sensor.raw_imu, {}, {"time_usec": US} | IMU),
    (sensor.raw_imu, {"sensors__field": None}, {"time_usec": US, "zgyro": 250}),
    (
        sensor.raw_imu, {"sensors__compass": HeadingReading(0.0, 0.0, -1e3, field_mg=(1e6, 0.0, 0.0))},
        {"time_usec": US, "zgyro": -32_767, "xmag": 32_767, "ymag": -1},
    ),
    (sensor.raw_imu, {"sensors__compass": None}, None),
    (sensor.scaled_imu, {"sensors__compass": None}, None),
    (sensor.power_status, {}, {"Vservo": 11_500, "flags": 3}),
    (sensor.power_status, {"vehicle__armed": False}, {"Vservo": 11_500, "flags": 1}),
    (
        sensor.power_status, {"sensors__battery": SimpleNamespace(voltage_v=99.0, current_a=None)},
        {"Vservo": 65_535, "flags": 3},
    ),
    (sensor.power_status, {"sensors__battery": None}, None),
    (sensor.meminfo, {}, {"freemem": 65_535, "freemem32": 1 << 20}),
    (sensor.meminfo, {"free_memory_bytes": 1 << 33}, {"freemem": 65_535, "freemem32": 0xFFFFFFFF}),
    (sensor.meminfo, {"free_memory_bytes": 1}, {"freemem": 1, "freemem32": 1}),
    (sensor.meminfo, {"free_memory_bytes": 0}, None),
    (
        sensor.rc_channels, {},
        {"time_boot_ms": MS, "chancount": 3} | CHANNELS | {"chan1_raw": 1100, "chan3_raw": 1900, "rssi": 127},
    ),
    (
        sensor.rc_channels, {"vehicle__manual_input__rc__is_fresh": lambda _part, _now_s: False},
        {"time_boot_ms": MS, "chancount": 3} | CHANNELS | {"chan1_raw": 1100, "chan3_raw": 1900},
    ),
    (
        sensor.rc_channels, {"vehicle__manual_input__rc": SimpleNamespace(is_fitted=False, latest=None)},
        {"time_boot_ms": MS, "chancount": 4, "rssi": 255}
        | CHANNELS
        | {"chan1_raw": 1100, "chan2_raw": 1500, "chan3_raw": 1900, "chan4_raw": 1500},
    ),
    (estimate.ekf_status_report, {}, ekf(WELL, 0.2, LAG)),
    (estimate.ekf_status_report, {"vehicle__nav": nav(position_age_s=1.5)}, ekf(WELL, 0.5, LAG)),
    (estimate.ekf_status_report, {"vehicle__nav": None}, ekf(0, 1.0, 1.0)),
    (estimate.ekf_status_report, {"vehicle__frame": None}, ekf(WELL | dialect.EKF_UNINITIALIZED, 0.2, LAG)),
    (
        estimate.ekf_status_report, {"vehicle__nav": nav(faults=EstimateFault.POSITION_LOST)},
        ekf(dialect.EKF_ATTITUDE, 1.0, LAG),
    ),
    (
        estimate.ekf_status_report, {"vehicle__nav": nav(faults=EstimateFault.HEADING_LOST)},
        ekf(WELL & ~dialect.EKF_ATTITUDE, 0.2, 1.0),
    ),
    (
        estimate.ekf_status_report, {"vehicle__nav": nav(faults=EstimateFault.COMPASS_OFF)},
        ekf(WELL, 0.2, 0.8),
    ),
    (
        estimate.ekf_status_report, {"vehicle__nav": nav(faults=EstimateFault.COMPASS_LATE)},
        ekf(WELL, 0.2, LAG),
    ),
    (
        estimate.ekf_status_report, {"vehicle__nav": nav(faults=EstimateFault.GNSS_LOST)},
        ekf(RECKONED, 0.8, LAG),
    ),
    *(
        (
            estimate.ekf_status_report, {"vehicle__nav": nav(faults=fault)},
            ekf(RECKONED | dialect.EKF_GPS_GLITCHING, 0.8, LAG),
        )
        for fault in (EstimateFault.GNSS_FROZEN, EstimateFault.GNSS_JUMPING)
    ),
    (
        estimate.estimator_status, {},
        {
            "time_usec": US, "flags": WELL, "vel_ratio": 0.2, "pos_horiz_ratio": 0.2, "mag_ratio": LAG,
            "pos_horiz_accuracy": 2.0,
        },
    ),
    (
        estimate.estimator_status, {"vehicle__nav": nav(faults=EstimateFault.GNSS_JUMPING)},
        {
            "time_usec": US, "flags": RECKONED | dialect.ESTIMATOR_GPS_GLITCH, "vel_ratio": 0.8,
            "pos_horiz_ratio": 0.8, "mag_ratio": LAG, "pos_horiz_accuracy": 2.0,
        },
    ),
    (estimate.water_current, {}, {"name": "CURRENT", "time_usec": US, "x": 0.3, "y": -0.4}),
    (sounding.distance_sensor, {}, [DISTANCE, SOUNDED]),
    (
        sounding.distance_sensor,
        {
            "sensors__sonar": SonarReading(12.2, 0.1, None, 0.25, 4.0),
            "sensors__depth": DepthReading(12.1, None, max_range_m=50.0, quality=0.001),
        },
        [
            DISTANCE
            | {"current_distance": 401, "orientation": dialect.MAV_SENSOR_ROTATION_CUSTOM}
            | {"quaternion": [math.cos(0.05), 0.0, 0.0, math.sin(0.05)]},
            SOUNDED | {"current_distance": 5001, "signal_quality": 1},
        ],
    ),
    (
        sounding.distance_sensor,
        {"sensors__sonar": None, "sensors__depth": DepthReading(12.1, 900.0, max_range_m=1e3, quality=None)},
        [SOUNDED | {"max_distance": 65_535, "current_distance": 65_535, "signal_quality": 0}],
    ),
    (sounding.water_depth, {}, DEPTH),
    (
        sounding.water_depth, {"sensors__depth": DepthReading(12.1, None)},
        DEPTH | {"healthy": 0, "distance": 0.0, "temperature": 0.0},
    ),
    (sounding.water_depth, {"sensors__depth": None}, None),
    (payload.relay_status, {}, {"time_boot_ms": MS, "on": 5, "present": 7}),
    (payload.relay_status, {"payload__units__relays": lambda: (0, 0)}, None),
    (payload.winch_status, {}, WINCH),
    (
        payload.winch_status, {"payload__units__winch": winch(is_moving=False, fault="jammed")},
        WINCH | {"status": 0},
    ),
    (
        payload.winch_status, {"payload__units__winch": winch(is_moving=False, out_m=0.0, speed_m_s=0.0)},
        WINCH
        | {"line_length": 0.0, "speed": 0.0}
        | {"status": dialect.MAV_WINCH_STATUS_HEALTHY | dialect.MAV_WINCH_STATUS_FULLY_RETRACTED},
    ),
    (payload.winch_status, {"payload__units__winch": None}, None),
    (status.battery_status, {}, PACK_TOLD),
    (
        status.battery_status,
        {"vehicle__failsafes__pack_is_low": False, "sensors__gauge__time_left_s": 1e12},
        PACK_TOLD | {"charge_state": dialect.MAV_BATTERY_CHARGE_STATE_OK, "time_remaining": 0x7FFFFFFF},
    ),
    (
        status.battery_status, {"sensors__gauge__time_left_s": None},
        PACK_TOLD | {"time_remaining": 0},
    ),
    (
        status.battery_status, {"sensors__battery": None, "vehicle__failsafes__pack_is_low": False},
        PACK_TOLD
        | {"voltages": [UNTOLD] * 10, "current_battery": -1, "current_consumed": -1, "battery_remaining": -1}
        | {"time_remaining": 0, "charge_state": dialect.MAV_BATTERY_CHARGE_STATE_UNDEFINED},
    ),
    (status.battery_status, {"sensors__has_battery_monitor": False}, None),
    (status.extended_sys_state, {}, {}),
    (
        status.autopilot_version, {},
        {
            "capabilities": CAPABILITIES, "flight_sw_version": 4 << 24 | 6 << 16, "uid": 1,
            "flight_custom_version": list(VERSION), "middleware_custom_version": [0] * 8,
            "os_custom_version": [0] * 8, "uid2": [0] * 18,
        },
    ),
    (
        status.fence_status, {},
        {
            "breach_status": 1, "breach_count": 3, "breach_type": dialect.FENCE_BREACH_BOUNDARY,
            "breach_time": 7250,
        },
    ),
    (
        status.fence_status,
        {"vehicle__failsafes__fence": SimpleNamespace(is_outside=False, breaches=70_000, breached_s=5e6)},
        {"breach_count": 65_535, "breach_time": 5_000_000_000 - 2**32},
    ),
    (status.fence_status, {"vehicle__fence__is_active": False}, None),
    (status.system_time, {}, {"time_unix_usec": 1_700_000_000_250_000, "time_boot_ms": MS}),
    (
        status.home_position, {},
        {
            "latitude": HOME_LAT, "longitude": HOME_LON, "x": 3.0, "y": -5.0, "q": [1.0, 0.0, 0.0, 0.0],
            "time_usec": US,
        },
    ),
    (
        status.home_position, {"vehicle__frame": None},
        {"latitude": HOME_LAT, "longitude": HOME_LON, "q": [1.0, 0.0, 0.0, 0.0], "time_usec": US},
    ),
    (status.home_position, {"vehicle__home": None}, None),
    (status.sys_status, {}, health(SEEN)),
    (status.sys_status, {"vehicle__failsafes__fence__is_outside": False}, health(SEEN | FENCE)),
    (status.sys_status, {"vehicle__failsafes__pack_is_low": False}, health(SEEN | BATTERY)),
    (status.sys_status, {"sensors__heading": None}, health(SEEN & ~MAG)),
    (status.sys_status, {"vehicle__nav": nav(heading_age_s=3.1)}, health(SEEN & ~(MAG | YAW))),
    (status.sys_status, {"sensors__fix": None}, health(SEEN & ~GPS)),
    (status.sys_status, {"sensors__fix": fix(fix_type=2)}, health(SEEN & ~GPS)),
    (status.sys_status, {"sensors__fix": fix(fix_type=3)}, health(SEEN)),
    (status.sys_status, {"vehicle__nav": nav(position_age_s=3.1)}, health(SEEN & ~(GPS | XY | AHRS))),
    (status.sys_status, {"vehicle__nav": None}, health(SEEN & ~(MAG | YAW | GPS | XY | AHRS))),
    (status.sys_status, {"vehicle__arming_faults": lambda: ["no"]}, health(SEEN & ~PREARM)),
    (
        status.sys_status, {"vehicle__armed": False},
        health(SEEN & ~MOTORS, **{ENABLED: (ALWAYS | OPTIONAL) & ~MOTORS}),
    ),
    (status.sys_status, {"load": 7.0}, health(SEEN, load=1000)),
    (
        status.sys_status, {"config": with_value(CONFIG, "failsafe.rc_enabled", 0)},
        health(SEEN, **{ENABLED: (ALWAYS | OPTIONAL) & ~RADIO}),
    ),
    (
        status.sys_status, {"sensors__battery": None},
        health(SEEN, voltage_battery=UNTOLD, current_battery=-1, battery_remaining=-1),
    ),
    (
        status.sys_status,
        {
            "vehicle__fence__is_active": False, "sensors__has_battery_monitor": False,
            "sensors__has_gyro": False, "vehicle__manual_input__rc__is_fitted": False,
            "sensors__is_sonar_fitted": False, "sensors__sweep__latest": None,
        },
        health(ALWAYS, **{PRESENT: ALWAYS, ENABLED: ALWAYS}),
    ),
    (
        status.sys_status,
        {
            "sensors__compass": HeadingReading(12.3, -0.5), "sensors__is_sonar_fitted": False,
            "vehicle__manual_input__rc__is_fresh": lambda _part, _now_s: False,
            "sensors__sweep__is_empty": lambda _now_s: True,
        },
        health(ALWAYS),
    ),
]  # fmt: skip


@pytest.mark.parametrize(("build", "changes", "fields"), ROWS, ids=lambda one: getattr(one, "__name__", ""))
def test_each_field_is_as_pymavlink_reads_it(
    build: Callable[[Snapshot], Any], changes: dict[str, Any], fields: Fields | list[Fields] | None
) -> None:
    built = build(state(**changes))
    if fields is None:
        assert built is None
        return
    for message, expected in zip(
        built if isinstance(built, list) else [built],
        fields if isinstance(fields, list) else [fields],
        strict=True,
    ):
        told = decoded(message)
        for name in {*told, *expected}:
            value = expected.get(name, 0)
            is_exact = isinstance(value, int | str)  # bits among them
            close = value if is_exact else pytest.approx(value, rel=1e-6, abs=1e-6, nan_ok=True)
            assert told.get(name, 0) == close, name


@pytest.mark.parametrize(
    "build",
    [
        *(motion.attitude, motion.attitude_quaternion, motion.global_position_int, motion.local_position_ned),
        *(motion.vfr_hud, motion.nav_controller_output, motion.pid_tuning, estimate.estimator_status),
        *(estimate.water_current, sounding.water_depth),
    ],
)
def test_without_an_estimate_nothing_is_told_of_it(build: Callable[[Snapshot], Message | None]) -> None:
    assert build(state(vehicle__nav=None)) is None


@pytest.mark.parametrize(
    "build",
    [
        *(motion.global_position_int, motion.local_position_ned, motion.gps_global_origin),
        *(estimate.estimator_status, estimate.water_current, sounding.water_depth),
    ],
)
def test_without_an_origin_there_are_no_places(build: Callable[[Snapshot], Message | None]) -> None:
    assert build(state(vehicle__frame=None)) is None


@pytest.mark.parametrize("missing", ["vehicle__destination", "guidance__demand"])
def test_without_target_and_demand_no_target_is_told(missing: str) -> None:
    assert motion.position_target_global_int(state(**{missing: None})) is None
