"""ArduPilot Rover on the other end of a line, as far as a companion sees it.

Written from ArduPilot's source (master of July 2025, 4.7-dev), not from the boat's driver: overrides are
taken from MAV_GCS_SYSID alone; after RC_OVERRIDE_TIME a receiver's sticks count again, without one the last
pulses stay (GCS_Common.cpp, RC_Channel.cpp). Half a second without either is a radio failsafe, with no
throttle at once and FS_ACTION after FS_TIMEOUT (radio.cpp, failsafe.cpp). Sticks have a dead zone
(RC_Channel.cpp); PILOT_STEER_TYPE and the mixer turn the steering round (mode.cpp, AP_MotorsUGV.cpp). Its
frames are packed and read by pymavlink; a recording of the real one is in tests/data/autopilot.
"""

import math
from dataclasses import dataclass, field

from pymavlink.dialects.v20 import ardupilotmega as mavlink

MANUAL, HOLD = 0, 4
CRITICAL, ACTIVE, STANDBY = 5, 4, 3
HEALTH = 0x10000 | 0x200000 | 0x4 | 0x1  # RC receiver, AHRS, magnetometer, gyro
PREARM = 0x10000000
AS_DELIVERED = {
    "MAV_GCS_SYSID": 255.0, "RC_OVERRIDE_TIME": 3.0, "FS_THR_ENABLE": 1.0, "FS_ACTION": 2.0,
    "RC_OPTIONS": 32.0, "PILOT_STEER_TYPE": 0.0, "RCMAP_ROLL": 1.0, "RCMAP_THROTTLE": 3.0,
    "MOT_SLEWRATE": 100.0, "MOT_THR_MIN": 0.0, "MOT_THR_MAX": 100.0, "MOT_THST_EXPO": 0.0,
    "MOT_THST_ASYM": 1.0, "MANUAL_STR_EXPO": 0.0,
    **{f"RC{n}_{key}": value for n in range(1, 17) for key, value in
       {"MIN": 1100.0, "TRIM": 1500.0, "MAX": 1900.0, "DZ": 30.0, "REVERSED": 0.0}.items()},
    **{f"SERVO{n}_FUNCTION": 0.0 for n in range(1, 17)},
    "SERVO1_FUNCTION": 73.0, "SERVO3_FUNCTION": 74.0,
}  # fmt: skip
SET_UP = AS_DELIVERED | {"RC_OVERRIDE_TIME": 0.4, "PILOT_STEER_TYPE": 3.0, "MOT_SLEWRATE": 0.0}
RUDDER = SET_UP | {"SERVO1_FUNCTION": 26.0, "SERVO3_FUNCTION": 70.0, "PILOT_STEER_TYPE": 0.0}


@dataclass
class Rover:
    """left, right: shares of drive of the outputs; with a rudder motor and rudder. now_s: since its boot."""

    parameters: dict[str, float] = field(default_factory=lambda: dict(SET_UP))
    mode: int = HOLD
    is_armed: bool = False
    refusal: str = ""
    flags: int = 0x33F  # EKF_STATUS_REPORT: attitude, velocity, position
    health: int = HEALTH
    yaw_rad: float = 1.0
    yaw_rate_rad_s: float = 0.1
    fix: dict[str, int] = field(default_factory=dict)
    left: float = 0.0
    right: float = 0.0
    now_s: float = 20.0
    commands: list[tuple[int, float, float]] = field(default_factory=list)
    has_receiver: bool = False
    heard: set[tuple[str, int]] = field(default_factory=set)

    def __post_init__(self) -> None:
        self.wire = mavlink.MAVLink(None, srcSystem=1, srcComponent=1)
        self.reader = mavlink.MAVLink(None)
        self.reader.robust_parsing = True
        self.out: list[bytes] = []
        self.intervals_s: dict[int, float] = {}
        self._due_s: dict[int, float] = {0: 0.0}
        self._stick_us = {1: 1500, 3: 1500}
        self._override_s = self._input_s = -math.inf
        self._failed_s = math.inf

    def receive(self, data: bytes) -> None:
        """Bytes from the companion."""
        for message in self.reader.parse_buffer(data) or []:
            self.heard.add((message.get_type(), message.get_srcComponent()))
            handle = getattr(self, f"_on_{message.get_type().lower()}", None)
            if handle is not None:
                handle(message)

    def _on_param_request_read(self, message: mavlink.MAVLink_message) -> None:
        name = message.param_id.rstrip("\0")
        if name in self.parameters:
            self.send(mavlink.MAVLink_param_value_message(name.encode(), self.parameters[name], 9, 1200, 0))

    def _on_param_request_list(self, message: mavlink.MAVLink_message) -> None:
        for index, (name, value) in enumerate(self.parameters.items()):
            self.send(
                mavlink.MAVLink_param_value_message(name.encode(), value, 9, len(self.parameters), index)
            )

    def _on_param_set(self, message: mavlink.MAVLink_message) -> None:
        self.parameters[message.param_id.rstrip("\0")] = message.param_value
        self._on_param_request_read(message)

    def _on_file_transfer_protocol(self, message: mavlink.MAVLink_message) -> None:
        asker = message.get_srcSystem(), message.get_srcComponent()
        self.send(mavlink.MAVLink_file_transfer_protocol_message(0, *asker, bytes(message.payload)))

    def _on_rc_channels_override(self, message: mavlink.MAVLink_message) -> None:
        if message.get_srcSystem() != self.parameters.get(
            "MAV_GCS_SYSID", self.parameters.get("SYSID_MYGCS")
        ):
            return
        for channel in self._stick_us:
            pulse_us = getattr(message, f"chan{channel}_raw")
            if pulse_us != 0xFFFF:
                self._stick_us[channel], self._override_s = pulse_us, self.now_s

    def _on_command_long(self, message: mavlink.MAVLink_message) -> None:
        self.commands.append((message.command, message.param1, message.param2))
        result = 0
        if message.command == mavlink.MAV_CMD_SET_MESSAGE_INTERVAL:
            self.intervals_s[int(message.param1)] = message.param2 * 1e-6
        elif message.command == mavlink.MAV_CMD_DO_SET_MODE:
            self.mode = int(message.param2)
        elif message.command == mavlink.MAV_CMD_COMPONENT_ARM_DISARM:
            if message.param1 and (self.refusal or self._is_radio_lost or self._stick(3)):
                self.text(2, f"Arm: {self.refusal or 'Radio failsafe on'}")
                result = 4
            else:
                self.is_armed = bool(message.param1)
        elif message.command == mavlink.MAV_CMD_RUN_PREARM_CHECKS and self.refusal:
            self.text(2, f"PreArm: {self.refusal}")
        asker = message.get_srcSystem(), message.get_srcComponent()
        self.send(mavlink.MAVLink_command_ack_message(message.command, result, 0, 0, *asker))

    def text(self, severity: int, text: str) -> None:
        self.send(mavlink.MAVLink_statustext_message(severity, text.encode()))

    def send(self, message: mavlink.MAVLink_message) -> None:
        self.out.append(message.pack(self.wire))

    def reboot(self) -> None:
        """All is as after power-on, but for the parameters."""
        self.__init__(self.parameters, now_s=0.0)  # type: ignore[misc]

    @property
    def _is_radio_lost(self) -> bool:
        return bool(self.parameters["FS_THR_ENABLE"]) and self.now_s - self._input_s > 0.5

    @property
    def is_critical(self) -> bool:
        return self.now_s - self._failed_s > 1.5  # FS_TIMEOUT

    def _stick(self, channel: int) -> float:
        least, trim, most, zone = (
            self.parameters[f"RC{channel}_{key}"] for key in ("MIN", "TRIM", "MAX", "DZ")
        )
        pulse_us = min(max(self._stick_us[channel], least), most)
        turned = -1.0 if self.parameters[f"RC{channel}_REVERSED"] else 1.0
        if pulse_us > trim + zone:
            return turned * (pulse_us - trim - zone) / (most - trim - zone)
        if pulse_us < trim - zone:
            return turned * (pulse_us - trim + zone) / (trim - zone - least)
        return 0.0

    def step(self, dt_s: float) -> bytes:
        """A while later; what it has sent."""
        self.now_s += dt_s
        self._input_s = max(self._input_s, self._override_s)
        if self.has_receiver and self.now_s - self._override_s > self.parameters["RC_OVERRIDE_TIME"]:
            self._input_s, self._stick_us = self.now_s, {1: 1500, 3: 1500}
        self._failed_s = min(self._failed_s, self.now_s) if self._is_radio_lost else math.inf
        if self.is_critical and self.parameters["FS_ACTION"] == 2:
            self.mode = HOLD
        self._drive()
        for number, interval_s in ({0: 1.0} | self.intervals_s).items():
            if self.now_s >= self._due_s.get(number, 0.0) and (report := self._report(number)) is not None:
                self._due_s[number] = self.now_s + interval_s
                self.send(report)
        sent, self.out = b"".join(self.out), []
        return sent

    def _drive(self) -> None:
        self.left = self.right = 0.0
        if not self.is_armed or self.mode != MANUAL or self._is_radio_lost:
            return
        throttle, steering = self._stick(3), self._stick(1)
        has_rudder = self.parameters["SERVO1_FUNCTION"] == 26
        for turns in (self.parameters["PILOT_STEER_TYPE"] in (0, 2), has_rudder):
            if turns and throttle < 0.0:
                steering = -steering
        self.left, self.right = (
            (throttle, steering) if has_rudder else (throttle + steering, throttle - steering)
        )

    def _report(self, number: int) -> mavlink.MAVLink_message | None:
        boot_ms = int(1000 * self.now_s)
        match number:
            case 0:
                status = CRITICAL if self.is_critical else STANDBY if self.mode == HOLD else ACTIVE
                base = 0x51 | (0x80 if self.is_armed else 0)
                return mavlink.MAVLink_heartbeat_message(11, 3, base, self.mode, status, 3)
            case 1:
                enabled, health = HEALTH | PREARM, self.health | (0 if self.refusal else PREARM)
                health &= ~0x10000 if self._is_radio_lost and math.isfinite(self._override_s) else ~0
                return mavlink.MAVLink_sys_status_message(
                    enabled, enabled, health, 100, 12100, 430, 88, 0, 0, 0, 0, 0, 0
                )
            case 2:
                return mavlink.MAVLink_system_time_message(int(1e6 * (1.7e9 + self.now_s)), boot_ms)
            case 24:
                fix = {"type": 3, "lat": 500000000, "lon": -12000000, "vel": 200, "cog": 9000} | self.fix
                stamp_us = int(self.now_s / 0.2) * 200_000
                return mavlink.MAVLink_gps_raw_int_message(
                    stamp_us, fix["type"], fix["lat"], fix["lon"], 1000, 80, 120, fix["vel"], fix["cog"], 14,
                    0, 700, 900, 150, 0, 0,
                )  # fmt: skip
            case 30:
                return mavlink.MAVLink_attitude_message(
                    boot_ms, 0.02, -0.01, self.yaw_rad, 0.0, 0.0, self.yaw_rate_rad_s
                )
            case 65:
                pulses = [1500, 1500, 1600, 1500, 1900, *([0] * 13)]
                if math.isfinite(self._override_s):
                    pulses[0], pulses[2] = self._stick_us[1], self._stick_us[3]
                return mavlink.MAVLink_rc_channels_message(boot_ms, 5, *pulses, 127)
            case 193:
                return mavlink.MAVLink_ekf_status_report_message(self.flags, 0.1, 0.1, 0.1, 0.2, 0.0)
        return None
