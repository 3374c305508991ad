"""Telemetry: the table of messages, a schedule per channel, and single requests."""

import math
from collections.abc import Callable, Sequence
from dataclasses import InitVar, dataclass, field

from companion.autopilot.snapshot import Snapshot
from companion.config.sensors import ProbePart
from companion.mavlink.dialect import Message, dialect, message_ids
from companion.services.ftp import component_metadata as metadata
from companion.services.outbox import Outbox
from companion.services.telemetry import available_modes as modes
from companion.services.telemetry import estimate_messages as estimate
from companion.services.telemetry import motion_messages as motion
from companion.services.telemetry import obstacle_messages as obstacle
from companion.services.telemetry import payload_messages as payload
from companion.services.telemetry import sensor_messages as sensor
from companion.services.telemetry import sounding_messages as sounding
from companion.services.telemetry import status_messages as status
from companion.services.telemetry.ais_messages import VesselSchedule
from companion.services.telemetry.probe_messages import ProbeSchedule, probe_values
from companion.services.telemetry.streams import Streams

Built = Message | list[Message] | None
# Each function has its message's name
_BUILDERS: tuple[Callable[[Snapshot], Built], ...] = (
    *(motion.attitude, motion.attitude_quaternion, motion.global_position_int, motion.gps_global_origin),
    *(motion.gps_raw_int, motion.gps_rtk, motion.local_position_ned, motion.nav_controller_output),
    *(motion.pid_tuning, motion.position_target_global_int, motion.servo_output_raw, motion.vfr_hud),
    *(sensor.esc_telemetry_1_to_4, sensor.meminfo, sensor.power_status),
    *(sensor.raw_imu, sensor.rc_channels, sensor.scaled_imu),
    *(estimate.ekf_status_report, estimate.estimator_status),
    *(obstacle.obstacle_distance, obstacle.obstacle_distance_3d),
    *(payload.relay_status, payload.winch_status, sounding.distance_sensor, sounding.water_depth),
    *(status.autopilot_version, status.battery_status, status.extended_sys_state, status.fence_status),
    *(status.home_position, status.sys_status, status.system_time),
    *(metadata.component_information, metadata.component_metadata),
)
BUILDERS: dict[int, Callable[[Snapshot], Built]] = {
    **{message_ids(build.__name__.upper())[0]: build for build in _BUILDERS},
    dialect.MAVLINK_MSG_ID_AVAILABLE_MODES_MONITOR: lambda _: modes.available_modes_monitor(),
    dialect.MAVLINK_MSG_ID_CURRENT_MODE: lambda now: modes.current_mode(now.vehicle),
    dialect.MAVLINK_MSG_ID_DEBUG_VECT: estimate.water_current,
    dialect.MAVLINK_MSG_ID_MISSION_CURRENT: lambda now: status.mission_current(now.vehicle),
}

# Sent only on request, with REQUEST_MESSAGE's second parameter
INDEXED: dict[int, Callable[[Snapshot, float], list[Message]]] = {
    dialect.MAVLINK_MSG_ID_AVAILABLE_MODES: lambda _, which: modes.available_modes(which),
    dialect.MAVLINK_MSG_ID_NAMED_VALUE_FLOAT: probe_values,
}

_LONGEST_US = float(2**31 - 128)  # MESSAGE_INTERVAL counts in 32 bits: a little over half an hour


MaySend = Callable[[int, float], bool]
"""Whether a channel has room for telemetry now."""

TakeSnapshot = Callable[[], Snapshot | None]
"""The present state of the boat; None before the first step."""


@dataclass(eq=False)
class TelemetryService:
    """Sends due messages on each channel; without room, all messages wait."""

    _outbox: Outbox
    _take_snapshot: TakeSnapshot  # called only if something is due
    _may_send: MaySend
    probes: InitVar[Sequence[ProbePart]]
    has_ais: InitVar[bool] = False
    _streams: dict[int, Streams] = field(default_factory=dict, init=False)  # by channel

    def __post_init__(self, probes: Sequence[ProbePart], has_ais: bool) -> None:
        self._probes, self._vessels = ProbeSchedule(probes), VesselSchedule(is_fitted=has_ais)

    def open(self, channel: int, stream_hz: float) -> None:
        self._streams[channel] = Streams(stream_hz)

    def forget(self, channel: int) -> None:
        self._streams.pop(channel, None)

    @staticmethod
    def answers(message_id: int) -> bool:
        """Whether this message can be requested."""
        return message_id in BUILDERS or message_id in INDEXED

    def build_all(self, message_id: int, which: float) -> list[Message]:
        """The messages for a request; empty if not available yet. which: its second parameter, an index."""
        now = self._take_snapshot()
        if now is None:
            return []
        if (build_indexed := INDEXED.get(message_id)) is not None:
            return build_indexed(now, which)
        builder = BUILDERS.get(message_id)
        return [] if builder is None else _listed(builder(now))

    def set_interval_us(self, channel: int, message_id: int, interval_us: float, now_s: float) -> bool:
        """SET_MESSAGE_INTERVAL: −1 stops, 0 sets the default rate. False for an unknown message."""
        if message_id not in BUILDERS or not math.isfinite(interval_us):
            return False
        if (streams := self._streams.get(channel)) is not None:
            interval_s = math.inf if interval_us < 0.0 else min(interval_us, _LONGEST_US) * 1e-6
            streams.set_interval(message_id, interval_s or streams.default_s(message_id), now_s)
        return True

    def interval_us(self, channel: int, message_id: int) -> int:
        """GET_MESSAGE_INTERVAL: −1 if not sent, 0 if not supported."""
        if message_id not in BUILDERS:
            return 0
        streams = self._streams.get(channel)
        interval_s = streams.interval_s(message_id) if streams is not None else math.inf
        return -1 if math.isinf(interval_s) else round(interval_s * 1e6)

    def on_request_data_stream(self, message: Message, channel: int, now_s: float) -> None:
        """Deprecated request for the rate of a group."""
        if (streams := self._streams.get(channel)) is not None:
            rate_hz = float(message.req_message_rate) if message.start_stop else 0.0
            streams.set_group(message.req_stream_id, rate_hz, now_s)

    def tick(self, now_s: float) -> None:
        """Send what is due. A message for several channels is built once."""
        built: dict[int, list[Message]] = {}
        now: Snapshot | None = None
        for channel, streams in self._streams.items():
            if not streams.has_due(now_s) or not self._may_send(channel, now_s):
                continue
            now = now or self._take_snapshot()
            if now is None:
                return
            for message_id in streams.due(now_s):
                if message_id not in built:
                    built[message_id] = _listed(BUILDERS[message_id](now))
                for message in built[message_id]:
                    self._outbox.send(channel, message)
        news: list[Message] = []
        if self._probes.has_due(now_s) and (now := now or self._take_snapshot()) is not None:
            news += self._probes.due(now.sensors.probes, now_s)
        if self._vessels.has_due(now_s) and (now := now or self._take_snapshot()) is not None:
            news += self._vessels.due(now.sensors.ais, now_s)
        for message in news:
            for channel, streams in self._streams.items():
                if streams.stream_hz > 0.0 and self._may_send(channel, now_s):
                    self._outbox.send(channel, message)


def _listed(built: Built) -> list[Message]:
    if built is None:
        return []
    return built if isinstance(built, list) else [built]
