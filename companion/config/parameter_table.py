"""The table of parameters. List, file and documentation are generated from it."""

import math

from companion.config import parameter_values as names
from companion.config.parameter_values import Names
from companion.config.parameters import Choice, ParameterRow, ParameterType
from companion.core.modes import Mode

_DEG = 180.0 / math.pi
_REAL, _I8, _I16, _I32 = ParameterType.REAL32, ParameterType.INT8, ParameterType.INT16, ParameterType.INT32


def _tuning() -> list[ParameterRow]:
    return [
        ParameterRow("SYSID_THISMAV", _I16, "MAVLink system id of the boat", "identity.system_id", low=1, high=255, needs_restart=True),
        ParameterRow("SYSID_MYGCS", _I16, "Operator's system id, 0 any station: whose silence counts, and who may steer manually", "identity.operator_system_id", low=0, high=255),
        ParameterRow("SYSID_ENFORCE", _I8, "Only SYSID_MYGCS may arm, command, upload and set parameters", "identity.only_operator", low=0, high=1, values=names.DISABLED_ENABLED),
        ParameterRow("LOG_BACKEND_TYPE", _I8, "Onboard log", "log.onboard", low=0, high=1, values=names.LOG_BACKENDS),
        ParameterRow("LOG_DISARMED", _I8, "When the onboard log records", "log.disarmed", low=0, high=1, values=names.LOG_TIMES),
        ParameterRow("LOG_FILE_RATEMAX", _REAL, "How often motion is logged", "log.motion_hz", unit="Hz", low=0.1, high=50),
        ParameterRow("HDG_KP", _REAL, "Heading PID: share of full steering per radian of error", "heading.kp", low=0, high=50),
        ParameterRow("HDG_KI", _REAL, "Heading PID: integral gain, Kp/Ti", "heading.ki", low=0, high=50),
        ParameterRow("HDG_KD", _REAL, "Heading PID: derivative gain on the measured yaw rate, Kp Td", "heading.kd", low=0, high=50),
        ParameterRow("HDG_SLOW_GAIN", _REAL, "Heading PID: factor of the gains at rest", "heading.slow_gain", low=0.2, high=5),
        ParameterRow("HDG_STR_MAX", _REAL, "Largest share of differential thrust for steering", "heading.max_steering", low=0, high=1),
        ParameterRow("CRUISE_SPEED", _REAL, "Speed over ground in AUTO, GUIDED and RTL", "speed.cruise_m_s", unit="m/s", low=0.001, high=20),
        ParameterRow("CRUISE_THROTTLE", _REAL, "Throttle that holds cruise speed in still water", "speed.cruise_throttle", scale=100.0, unit="%", low=0, high=100),
        ParameterRow("WP_SPEED", _REAL, "Same as CRUISE_SPEED (ArduPilot Rover's name)", "speed.cruise_m_s", unit="m/s", low=0.001, high=20),
        ParameterRow("WPNAV_SPEED", _REAL, "Same as CRUISE_SPEED, in cm/s (ArduCopter's name); upper end of QGroundControl's speed slider", "speed.cruise_m_s", scale=100.0, unit="cm/s", low=0.1, high=2000),
        ParameterRow("ATC_SPEED_P", _REAL, "Speed loop: share of full throttle per m/s of error", "speed.kp", low=0, high=50),
        ParameterRow("ATC_SPEED_I", _REAL, "Speed loop: integral gain", "speed.ki", low=0, high=50),
        ParameterRow("MOT_THR_MAX", _I16, "Largest throttle", "speed.max_throttle", scale=100.0, unit="%", low=0, high=100),
        ParameterRow("MOT_THR_MIN", _I16, "Smaller commands are not sent", "motors.deadband", scale=100.0, unit="%", low=0, high=20),
        ParameterRow("MOT_L_MIN_FWD", _REAL, "Dead band of the left motor ahead; the thruster calibration sets it", "thrusters.left_ahead", scale=100.0, unit="%", low=0, high=60),
        ParameterRow("MOT_L_MIN_REV", _REAL, "Dead band of the left motor astern", "thrusters.left_astern", scale=100.0, unit="%", low=0, high=60),
        ParameterRow("MOT_R_MIN_FWD", _REAL, "Dead band of the right motor ahead", "thrusters.right_ahead", scale=100.0, unit="%", low=0, high=60),
        ParameterRow("MOT_R_MIN_REV", _REAL, "Dead band of the right motor astern", "thrusters.right_astern", scale=100.0, unit="%", low=0, high=60),
        ParameterRow("MOT_L_GAIN", _REAL, "Factor of the left motor's command, for equal thrust", "thrusters.left_gain", low=0.2, high=1),
        ParameterRow("MOT_R_GAIN", _REAL, "Factor of the right motor's command", "thrusters.right_gain", low=0.2, high=1),
        ParameterRow("MOT_THST_ASYM", _REAL, "Ratio of command astern to ahead for the same thrust; calibrated", "thrusters.asymmetry", low=1, high=10),
        ParameterRow("HND_TOP_SPEED", _REAL, "Speed through the water at full throttle; calibrated", "handling.top_speed_m_s", unit="m/s", low=0.05, high=20),
        ParameterRow("HND_TURN_RATE", _REAL, "Turn rate at full steering under way; calibrated", "handling.turn_rate_rad_s", scale=_DEG, unit="deg/s", low=0.1, high=360),
        ParameterRow("HND_YAW_TIME", _REAL, "Delay of the heading behind its demand", "handling.yaw_time_s", unit="s", low=0.01, high=20),
        ParameterRow("HND_SURGE_TIME", _REAL, "Delay of the speed behind the throttle", "handling.surge_time_s", unit="s", low=0.01, high=100),
        ParameterRow("HND_TURN_ACCEL", _REAL, "Angular acceleration by full steering (Nomoto's K/T) that the gains are for; calibrated", "handling.turn_accel_rad_s2", scale=_DEG, unit="deg/s/s", low=0, high=3600),
        ParameterRow("HND_TURN_TIME", _REAL, "Delay of the turn rate behind steering (Nomoto's T)", "handling.turn_time_s", unit="s", low=0.05, high=20),
        ParameterRow("HND_MOTOR_TIME", _REAL, "Delay of the thrust behind the command", "handling.motor_time_s", unit="s", low=0.02, high=5),
        ParameterRow("HND_STOP", _REAL, "Stopping distance from cruise speed, full astern in still water; calibrated; 0: not measured", "handling.stop_m", unit="m", low=0, high=100),
        ParameterRow("HND_SLIP", _REAL, "Outward slip in a turn, per turn rate", "handling.slip_m", unit="m", low=0, high=20),
        ParameterRow("MOT_SLEWRATE", _I16, "Largest change of motor command", "motors.slew_per_s", scale=100.0, unit="%/s", low=1, high=5000),
        ParameterRow("WP_RADIUS", _REAL, "Acceptance radius of a waypoint", "guidance.waypoint_radius_m", unit="m", low=0.001, high=100),
        ParameterRow("WP_ACCEL", _REAL, "Deceleration for corners and stops", "guidance.accel_m_s2", unit="m/s/s", low=0.0001, high=20),
        ParameterRow("WP_PIVOT_ANGLE", _I16, "Heading error beyond which the boat turns on the spot", "guidance.pivot_angle_rad", scale=_DEG, unit="deg", low=1, high=180),
        ParameterRow("LOS_LOOKAHEAD", _REAL, "Lookahead of the line-of-sight guidance", "guidance.lookahead_m", unit="m", low=0.001, high=100),
        ParameterRow("LOS_TURN_RATE", _REAL, "Turn rate at full steering under way, used for corners", "handling.turn_rate_rad_s", scale=_DEG, unit="deg/s", low=1, high=360),
        ParameterRow("LOS_TOP_SPEED", _REAL, "Speed through the water at full throttle", "handling.top_speed_m_s", unit="m/s", low=0.05, high=20),
        ParameterRow("LOS_YAW_TIME", _REAL, "Delay of the heading behind its demand", "handling.yaw_time_s", unit="s", low=0.01, high=10),
        ParameterRow("LOS_SLIP", _REAL, "Outward slip in a turn, per turn rate", "handling.slip_m", unit="m", low=0, high=10),
        ParameterRow("ATC_TURN_MAX_G", _REAL, "Largest lateral acceleration in a corner", "guidance.corner_accel_m_s2", scale=1.0 / 9.80665, unit="gravities", low=0.00001, high=10),
        ParameterRow("WP_SPEED_MIN", _REAL, "Slowest speed with steerage way", "guidance.min_speed_m_s", unit="m/s", low=0.001, high=20),
        ParameterRow("LOIT_RADIUS", _REAL, "Station keeping acts outside this distance", "guidance.station_radius_m", unit="m", low=0.001, high=20),
        ParameterRow("RTL_SPEED", _REAL, "Speed in RTL, 0: CRUISE_SPEED", "mission.rtl_speed_m_s", unit="m/s", low=0, high=20),
        ParameterRow("MIS_DONE_BEHAVE", _I8, "Mode after the last mission item", "mission.done_behave", low=0, high=1, values=names.MISSION_ENDS),
        ParameterRow("ACRO_TURN_RATE", _REAL, "Turn rate of full stick in ACRO", "modes.turn_rate_rad_s", scale=_DEG, unit="deg/s", low=1, high=360),
        ParameterRow("SIMPLE_TYPE", _I8, "Direction of the stick's ahead in SIMPLE", "modes.simple_type", low=0, high=1, values=names.SIMPLE_DIRECTIONS),
        ParameterRow("CIRC_RADIUS", _REAL, "Radius of CIRCLE", "modes.circle_radius_m", unit="m", low=0.1, high=1000),
        ParameterRow("CIRC_SPEED", _REAL, "Speed in CIRCLE, 0: CRUISE_SPEED", "modes.circle_speed_m_s", unit="m/s", low=0, high=20),
        ParameterRow("CIRC_DIR", _I8, "Direction of CIRCLE", "modes.circle_direction", low=0, high=1, values=names.TURN_DIRECTIONS),
        ParameterRow("SRTL_ACCURACY", _REAL, "Largest deviation of SMART_RTL's recorded track", "modes.trail_accuracy_m", unit="m", low=0.01, high=10),
        ParameterRow("SRTL_POINTS", _I16, "Maximum number of points of SMART_RTL's track", "modes.trail_points", low=10, high=5000),
        ParameterRow("GUID_TIMEOUT", _REAL, "Lifetime of a velocity or attitude in GUIDED", "modes.set_point_timeout_s", unit="s", low=0.1, high=60),
        ParameterRow("FOLL_ENABLE", _I8, "FOLLOW can always be chosen", default=1.0, read_only=True, values=((1, "Enabled"),)),
        ParameterRow("FOLL_SYSID", _I16, "System id to follow, 0 the first vehicle heard", "follow.system_id", low=0, high=255),
        ParameterRow("FOLL_DIST_MAX", _REAL, "Largest distance of the followed vehicle, 0 no limit", "follow.max_distance_m", unit="m", low=0, high=10000),
        ParameterRow("FOLL_OFS_TYPE", _I8, "Axes of FOLL_OFS_X and FOLL_OFS_Y", "follow.offset_type", low=0, high=1, values=names.OFFSET_AXES),
        ParameterRow("FOLL_OFS_X", _REAL, "Offset north or ahead, negative astern", "follow.offset_x_m", unit="m", low=-1000, high=1000),
        ParameterRow("FOLL_OFS_Y", _REAL, "Offset east or to starboard", "follow.offset_y_m", unit="m", low=-1000, high=1000),
        ParameterRow("FOLL_POS_P", _REAL, "Speed added for each metre behind", "follow.gain_per_s", unit="1/s", low=0.01, high=1),
        ParameterRow("FOLL_TIMEOUT", _REAL, "Silence of the followed vehicle that ends following", "follow.timeout_s", unit="s", low=0.5, high=60),
        ParameterRow("AVOID_ENABLE", _I8, "Obstacle sources", "avoidance.enable", low=0, high=7, bits=names.AVOIDED),
        ParameterRow("AVOID_MARGIN", _REAL, "Distance to keep from obstacles", "avoidance.margin_m", unit="m", low=0.01, high=50),
        ParameterRow("AVOID_SIGHT", _I8, "Where the speed is limited to what allows a stop within the water looked at", "avoidance.by_sight", low=0, high=3, values=names.SIGHT_LIMITS),
        ParameterRow("AVOID_DETOUR", _REAL, "Longest detour", "avoidance.detour_m", unit="m", low=0, high=10000),
        ParameterRow("AVOID_RETRY", _REAL, "Time until the next attempt when blocked", "avoidance.retry_s", unit="s", low=1, high=3600),
        ParameterRow("OA_TYPE", _I8, "Action for an obstacle ahead", "avoidance.goes_round", low=0, high=1, values=names.OBSTACLE_ACTIONS),
        ParameterRow("OA_BR_LOOKAHEAD", _REAL, "Obstacles farther off are ignored", "avoidance.lookahead_m", unit="m", low=0.1, high=100),
        ParameterRow("FS_GCS_ENABLE", _I8, "Failsafe for loss of the operator", "failsafe.gcs_enabled", low=0, high=1, values=names.DISABLED_ENABLED),
        ParameterRow("FS_GCS_TIMEOUT", _REAL, "Silence of the operator that triggers it", "failsafe.gcs_timeout_s", unit="s", low=2, high=600),
        ParameterRow("FS_ACTION", _I8, "Operator or RC lost", "failsafe.action", low=0, high=6, values=names.ACTIONS),
        ParameterRow("FS_LONG_TIMEOUT", _REAL, "Operator, planner or RC lost for this long after FS_ACTION, 0 never", "failsafe.long_timeout_s", unit="s", low=0, high=3600),
        ParameterRow("FS_LONG_ACTN", _I8, "Action after FS_LONG_TIMEOUT", "failsafe.long_action", low=0, high=6, values=names.ACTIONS),
        ParameterRow("FS_THR_ENABLE", _I8, "Failsafe for loss of RC or manual input", "failsafe.rc_enabled", low=0, high=2, values=names.RC_FAILSAFES),
        ParameterRow("FS_THR_VALUE", _I16, "Throttle pulse below which RC is lost, 0 never", "rc.failsafe_us", unit="us", low=0, high=1100),
        ParameterRow("FS_TIMEOUT", _REAL, "Loss of RC or manual input that triggers it", "failsafe.rc_timeout_s", unit="s", low=0, high=100),
        ParameterRow("FS_PLAN_TIMEOUT", _REAL, "Silence of a planner in control that triggers its failsafe, 0 never", "failsafe.planner_timeout_s", unit="s", low=0, high=600),
        ParameterRow("FS_PLAN_ACT", _I8, "Planner lost", "failsafe.planner_action", low=0, high=6, values=names.ACTIONS),
        ParameterRow("FS_POS_ACT", _I8, "Position lost; LOITER then holds the bow into the current by dead reckoning", "failsafe.position_action", low=0, high=6, values=names.ACTIONS),
        ParameterRow("FS_DR_TIMEOUT", _REAL, "Position lost for this long after FS_POS_ACT: HOLD, 0 never", "failsafe.dead_reckoning_s", unit="s", low=0, high=3600),
        ParameterRow("FS_HDG_ACT", _I8, "Heading lost", "failsafe.heading_action", low=0, high=6, values=names.ACTIONS),
        ParameterRow("FS_GPS_ACT", _I8, "GPS silent, frozen or jumping, while dead reckoning goes on", "failsafe.gnss_action", low=0, high=6, values=names.ACTIONS),
        ParameterRow("FS_COMP_ACT", _I8, "Compass lost or off, while the estimate goes on", "failsafe.compass_action", low=0, high=6, values=names.ACTIONS),
        ParameterRow("FS_SONAR_ACT", _I8, "Sonar lost", "failsafe.sonar_action", low=0, high=6, values=names.ACTIONS),
        ParameterRow("FS_SONAR_TIMEOUT", _REAL, "Silence of the sonar that triggers it", "failsafe.sonar_timeout_s", unit="s", low=0.5, high=600),
        ParameterRow("FENCE_ENABLE", _I8, "Fence", "fence.enabled", low=0, high=1, values=names.DISABLED_ENABLED),
        ParameterRow("FENCE_TYPE", _I8, "Parts of the fence", "fence.kinds", low=0, high=7, bits=names.FENCE_PARTS),
        ParameterRow("FENCE_RADIUS", _REAL, "Radius of the circle around home", "fence.radius_m", unit="m", low=1, high=10000),
        ParameterRow("FENCE_MARGIN", _REAL, "Distance from the line at which the boat stops", "fence.margin_m", unit="m", low=0, high=50),
        ParameterRow("FENCE_ACTION", _I8, "Outside the fence; LOITER is at the nearest place inside", "failsafe.fence_action", low=0, high=6, values=names.ACTIONS),
        ParameterRow("RALLY_INCL_HOME", _I8, "RTL may go home even if there are rally points", "fence.rally_includes_home", low=0, high=1, values=names.NO_YES),
        ParameterRow("FS_STEER_ACT", _I8, "Steering fails, or a motor is reversed", "failsafe.steering_action", low=0, high=8, values=names.MOTOR_ACTIONS),
        ParameterRow("FS_MOT_ACT", _I8, "A motor gives no thrust", "failsafe.motor_action", low=0, high=8, values=names.MOTOR_ACTIONS),
        ParameterRow("FS_STUCK_ACT", _I8, "Boat obstructed", "failsafe.stuck_action", low=0, high=7, values=names.STUCK_ACTIONS),
        ParameterRow("FS_GRND_ACT", _I8, "Boat aground", "failsafe.aground_action", low=0, high=9, values=names.GROUND_ACTIONS),
        ParameterRow("FS_DEPTH_MIN", _REAL, "Depth of the water that triggers its failsafe, 0 never", "failsafe.min_depth_m", unit="m", low=0, high=100),
        ParameterRow("FS_DEPTH_ACT", _I8, "Shallow water", "failsafe.depth_action", low=0, high=6, values=names.ACTIONS),
        ParameterRow("FS_CLEAR_TRIES", _I8, "Attempts to clear the propellers before RTL", "failsafe.clearing_tries", low=1, high=10),
        ParameterRow("FS_WAY_ACT", _I8, "No headway against the current", "failsafe.headway_action", low=0, high=6, values=names.ACTIONS),
        ParameterRow("CRASH_ANGLE", _REAL, "Roll or pitch that counts as capsized, 0 off", "failsafe.capsize_rad", scale=_DEG, unit="deg", low=0, high=180),
        ParameterRow("FS_CAPS_ACT", _I8, "Capsized", "failsafe.capsize_action", low=0, high=6, values=names.ACTIONS),
        ParameterRow("FS_LEAK_ACT", _I8, "Water in the hull", "failsafe.leak_action", low=0, high=6, values=names.ACTIONS),
        ParameterRow("FS_TEMP_MAX", _REAL, "Temperature of hull or computer that triggers its failsafe, 0 never", "failsafe.max_temperature_c", unit="degC", low=0, high=150),
        ParameterRow("FS_TEMP_ACT", _I8, "Too hot", "failsafe.temperature_action", low=0, high=6, values=names.ACTIONS),
        ParameterRow("FS_LOAD_ACT", _I8, "Control loop overloaded", "failsafe.overrun_action", low=0, high=6, values=names.ACTIONS),
        ParameterRow("FS_DISK_ACT", _I8, "Logs or settings cannot be written", "failsafe.storage_action", low=0, high=6, values=names.ACTIONS),
        ParameterRow("FS_RANGE_ACT", _I8, "Charge insufficient for the way home", "failsafe.range_action", low=0, high=6, values=names.ACTIONS),
        ParameterRow("FS_RANGE_MARGIN", _REAL, "Required charge, times that for the way home", "failsafe.range_margin", low=1, high=10),
        ParameterRow("FS_RESUME", _I8, "Mission interrupted by a power loss", "failsafe.resume", low=0, high=2, values=names.RESUMPTIONS),
        ParameterRow("EST_DR_TIME", _REAL, "Dead reckoning after which the position is lost", "estimation.dead_reckoning_s", unit="s", low=0, high=3600, needs_restart=True),
        ParameterRow("EST_SD_MAX", _REAL, "Uncertainty at which the position is lost", "estimation.lost_sigma_m", unit="m", low=0.01, high=1000, needs_restart=True),
        ParameterRow("EST_SURGE_TIME", _REAL, "Response time of the hull to thrust at cruise speed", "estimation.surge_time_s", unit="s", low=0.05, high=100, needs_restart=True),
        ParameterRow("RC_OVERRIDE_TIME", _REAL, "Lifetime of MANUAL_CONTROL and RC override", "failsafe.manual_timeout_s", unit="s", low=0.1, high=120),
        ParameterRow("HDG_TRIM", _REAL, "Added to the compass heading; set by FIXED_MAG_CAL_YAW", "trim.heading_rad", scale=_DEG, unit="deg", low=-180, high=180),
        ParameterRow("COMPASS_AUTODEC", _I8, "Declination from the world magnetic model", "parts.compass.auto_declination", low=0, high=1, values=names.DISABLED_ENABLED),
        ParameterRow("COMPASS_DEC", _REAL, "Declination without COMPASS_AUTODEC, east positive", "parts.compass.declination_rad", unit="rad", low=-3.14, high=3.14),
        ParameterRow("INS_GYROFFS_Z", _REAL, "Bias of the yaw gyro; set by the gyro calibration", "trim.gyro_bias_rad_s", unit="rad/s", low=-0.2, high=0.2, decimals=5),
        ParameterRow("EXT_POSITION", _I8, "Position over MAVLink", "external.position", low=0, high=2, values=names.EXTERNAL_USES),
        ParameterRow("EXT_HEADING", _I8, "Heading over MAVLink", "external.heading", low=0, high=2, values=names.EXTERNAL_USES),
        ParameterRow("EXT_OBSTACLES", _I8, "Obstacles over MAVLink", "external.obstacles", low=0, high=1, values=names.OBSTACLE_USES),
        ParameterRow("EXT_TIMEOUT", _REAL, "Time-out of either source", "external.timeout_s", unit="s", low=0.1, high=10),
        ParameterRow("EXT_YAW", _REAL, "Direction of the x axis of external poses, clockwise from north", "external.north_rad", scale=_DEG, unit="deg", low=-180, high=180),
        ParameterRow("RNGFND2_POS_X", _REAL, "Depth transducer ahead of the GNSS antenna", "parts.depth.forward_m", unit="m", low=-20, high=20),
        ParameterRow("RNGFND2_POS_Y", _REAL, "Depth transducer to starboard of the GNSS antenna", "parts.depth.starboard_m", unit="m", low=-20, high=20),
        ParameterRow("RNGFND2_POS_Z", _REAL, "Depth transducer below the surface, 0 as the sounder says", "parts.depth.transducer_m", unit="m", low=0, high=20, needs_restart=True),
        ParameterRow("RNGFND2_LATENCY", _REAL, "Time from the echo until the sounding has arrived", "parts.depth.latency_s", unit="s", low=0, high=5),
        ParameterRow("RNGFND2_SOUND", _REAL, "Speed of sound that the depth sounder assumes", "parts.depth.sound_m_s", unit="m/s", low=1300, high=1700, needs_restart=True),
        ParameterRow("BATT_CAPACITY", _I32, "Capacity of the pack", "battery.capacity_mah", unit="mAh", low=1, high=1000000),
        ParameterRow("BATT_LOW_VOLT", _REAL, "Voltage of the battery failsafe, 0 off", "failsafe.battery_low_v", unit="V", low=0, high=100),
        ParameterRow("BATT_LOW_TIMER", _REAL, "Time below BATT_LOW_VOLT that triggers it", "failsafe.battery_low_s", unit="s", low=0.1, high=120),
        ParameterRow("BATT_FS_LOW_ACT", _I8, "Action of the battery failsafe", "failsafe.battery_action", low=0, high=6, values=names.ACTIONS),
        ParameterRow("BATT_CRT_VOLT", _REAL, "Voltage of the critical battery failsafe, 0 off", "failsafe.battery_critical_v", unit="V", low=0, high=100),
        ParameterRow("BATT_FS_CRT_ACT", _I8, "Action of the critical battery failsafe", "failsafe.battery_critical_action", low=0, high=6, values=names.ACTIONS),
        ParameterRow("BATT_ARM_VOLT", _REAL, "Voltage needed to arm", "arming.battery_min_v", unit="V", low=0, high=100),
        ParameterRow("ARMING_CHECK", _I32, "Arming checks", "arming.check", low=0, high=1, bits=names.ARMING_CHECKS),
        ParameterRow("GPS_HDOP_GOOD", _I16, "HDOP above which the boat does not arm", "arming.max_hdop", scale=100.0, unit="1/100", low=1, high=900),
    ]  # fmt: skip


def _radio() -> list[ParameterRow]:
    """Sticks and switches of the RC transmitter and RC override."""
    rows = [
        ParameterRow("RCMAP_ROLL", _I8, "Channel that steers", "rc.steering_channel", low=1, high=4),
        ParameterRow("RCMAP_THROTTLE", _I8, "Channel of the throttle", "rc.throttle_channel", low=1, high=4),
        ParameterRow("RCMAP_PITCH", _I8, "Unused; written by stations during RC calibration", default=2.0, low=1, high=16),
        ParameterRow("RCMAP_YAW", _I8, "Unused; written by stations during RC calibration", default=4.0, low=1, high=16),
        ParameterRow("COMPASS_CAL_FIT", _REAL, "Largest RMS error of an accepted compass calibration", default=16.0, unit="mGauss", low=0, high=1000),
        ParameterRow("RC_FS_TIMEOUT", _REAL, "Time without a good frame after which RC is lost", "rc.timeout_s", unit="s", low=0.1, high=10),
        ParameterRow("RC_ARM_CH", _I8, "Channel of the switch that arms and disarms, 0 none", "rc.arm_channel", low=0, high=18),
        ParameterRow("MODE_CH", _I8, "Channel of the mode switch, 0 none", "rc.mode_channel", low=0, high=18),
    ]  # fmt: skip
    rows += [
        ParameterRow(f"MODE{position}", _I8, "Mode of this position of the mode switch", f"rc.mode_{position}", low=0, high=float(max(Mode)), values=names.MODES)
        for position in range(1, 7)
    ]  # fmt: skip
    rows += [
        ParameterRow(f"RC{number}_OPTION", _I16, "Function of this channel's switch; RC_ARM_CH is the arming channel", "rc.arm_channel", low=0, high=names.ARM_DISARM, values=names.SWITCHES, choice=Choice(number, names.ARM_DISARM))
        for number in range(5, 17)
    ]  # fmt: skip
    for number in range(1, 5):
        name, path = f"RC{number}", f"rc.channel_{number}"
        rows += [
            ParameterRow(f"{name}_MIN", _I16, "Pulse of the stick at its lower end", f"{path}.min_us", unit="us", low=800, high=2200),
            ParameterRow(f"{name}_TRIM", _I16, "Pulse of the stick at rest", f"{path}.trim_us", unit="us", low=800, high=2200),
            ParameterRow(f"{name}_MAX", _I16, "Pulse of the stick at its upper end", f"{path}.max_us", unit="us", low=800, high=2200),
            ParameterRow(f"{name}_DZ", _I16, "Dead zone on either side of the trim", f"{path}.dead_us", unit="us", low=0, high=200),
            ParameterRow(f"{name}_REVERSED", _I8, "Stick reversed", f"{path}.is_reversed", low=0, high=1, values=names.NO_YES),
        ]  # fmt: skip
    return rows


_MEASURED = "The monitor measures by itself"


def _constants() -> list[ParameterRow]:
    """Constants that QGroundControl's setup pages for Rover require.

    Without them it shows "Parameters are missing from firmware".
    """
    fixed: list[tuple[str, ParameterType, float, str, Names]] = [
        ("FRAME_CLASS", _I8, 2.0, "Boat", names.FRAME_CLASSES),
        ("FRAME_TYPE", _I8, 0.0, "Undefined", ((0, "Undefined"),)),
        ("ARMING_REQUIRE", _I8, 1.0, "Arming is needed before the motors turn", ((1, "Yes"),)),
        ("BATT_MONITOR", _I8, 4.0, "Voltage and current", ((4, "Voltage and current"),)),
        ("BATT_VOLT_PIN", _I8, -1.0, _MEASURED, ((-1, "Disabled"),)),
        ("BATT_CURR_PIN", _I8, -1.0, _MEASURED, ((-1, "Disabled"),)),
        ("BATT_VOLT_MULT", _REAL, 1.0, _MEASURED, ()),
        ("BATT_AMP_PERVLT", _REAL, 1.0, _MEASURED, ()),
        ("BATT_AMP_OFFSET", _REAL, 0.0, _MEASURED, ()),
        ("BATT2_MONITOR", _I8, 0.0, "No second battery monitor", ((0, "Disabled"),)),
        ("AHRS_ORIENTATION", _I8, 0.0, "HDG_TRIM sets how the heading sensor is mounted", ((0, "None"),)),
        ("FS_CRASH_CHECK", _I8, 0.0, "FS_STUCK_ACT, FS_GRND_ACT and FS_CAPS_ACT replace it", ((0, "Disabled"),)),
        ("INS_ACCOFFS_X", _REAL, 0.001, "No accelerometer to calibrate", ()),
        ("INS_ACCOFFS_Y", _REAL, 0.001, "No accelerometer to calibrate", ()),
        ("INS_ACCOFFS_Z", _REAL, 0.001, "No accelerometer to calibrate", ()),
    ]  # fmt: skip
    for number, compass, is_used in ((1, "", True), (2, "2", False), (3, "3", False)):
        device_id = 1.0 if is_used else 0.0
        fixed.append((f"COMPASS_DEV_ID{compass}", _I32, device_id, "Heading sensor", ()))
        fixed.append((f"COMPASS_PRIO{number}_ID", _I32, device_id, "Heading sensor of this priority", ()))
        fixed.append((f"COMPASS_USE{compass}", _I8, device_id, "Heading sensor is used", names.NO_YES))
        offset = 0.001 if is_used else 0.0
        fixed += [
            (f"COMPASS_OFS{compass}_{axis}", _REAL, offset, "Calibrated in the part", ()) for axis in "XYZ"
        ]
    return [
        ParameterRow(name, kind, text, default=value, read_only=True, values=values)
        for name, kind, value, text, values in fixed
    ]


ROWS: tuple[ParameterRow, ...] = tuple(
    sorted([*_tuning(), *_radio(), *_constants()], key=lambda row: row.name)
)
