"""The boat's MAVLink endpoint: dispatches messages to services.

The wire is untrusted: unknown or misaddressed messages are counted and dropped, and an exception in a handler
is logged once per kind and never reaches the control loop.
"""

import logging
from collections.abc import Callable, Mapping

from companion.autopilot.sensor_suite import SensorSuite
from companion.calibration.motor_test import MotorTest
from companion.calibration.runner import CalibrationRunner
from companion.config.parameters import Parameters
from companion.core.readings import HeadingReading
from companion.core.storage import FolderStorage, Storage
from companion.hal.interfaces import CorrectionInput, FaultInjector, MavlinkPart
from companion.log.logbook import Logbook
from companion.mavlink.address import ALL, Address, concerns
from companion.mavlink.codec import Received
from companion.mavlink.dialect import Message, dialect, message_ids
from companion.mavlink.items import MissionItem, MissionType
from companion.persistence.signing_store import SigningStore
from companion.router.channel import Channel
from companion.services.access import AccessService
from companion.services.address_check import AddressCheck
from companion.services.camera.component import CameraComponent
from companion.services.commands.command import command_of
from companion.services.commands.dispatcher import CommandService
from companion.services.components import Component, Components
from companion.services.corrections import CorrectionService
from companion.services.external_pose import ExternalPoseService
from companion.services.ftp.mounts import build_tree, open_worker
from companion.services.ftp.service import FtpService
from companion.services.guided import GuidedService
from companion.services.logs import LOG_MESSAGES, LogService
from companion.services.manual_control import ManualControlService
from companion.services.missions.service import MISSION_MESSAGES, MissionService
from companion.services.other_vehicles import OtherVehicleService
from companion.services.outbox import Origin, Outbox
from companion.services.parameters import ParameterService
from companion.services.roles import Role, Roles
from companion.services.routed_autopilot import RoutedAutopilot
from companion.services.signing import SigningService
from companion.services.statustext import StatusTextService
from companion.services.telemetry.available_modes import AvailableModesService
from companion.services.telemetry.heartbeat import HeartbeatService
from companion.services.telemetry.service import MaySend, TakeSnapshot, TelemetryService
from companion.services.time_sync import TimeService
from companion.vehicle.payload_control import PayloadControl
from companion.vehicle.vehicle import Vehicle

logger = logging.getLogger(__name__)

_PERIOD_S = 0.1  # of the services with nothing under way

_STEERING = message_ids(
    *("COMMAND_LONG", "COMMAND_INT", "SET_ATTITUDE_TARGET"),
    *("SET_POSITION_TARGET_GLOBAL_INT", "SET_POSITION_TARGET_LOCAL_NED"),
)
_REPOSITION = dialect.MAV_CMD_DO_REPOSITION

Handler = Callable[[Message, Origin, float], None]


class Endpoint:
    """All services of component 1 and of the boat's further components, with their outbox."""

    def __init__(
        self,
        own: Address,
        vehicle: Vehicle,
        parameters: Parameters,
        storage: Storage,
        may_send: MaySend,
        logbook: Logbook | None = None,
        *,
        signing: SigningStore,
        channels: Mapping[int, Channel],
        motor_test: MotorTest,
        calibration: CalibrationRunner,
        sensors: SensorSuite,
        take_snapshot: TakeSnapshot,
        payload: PayloadControl,
        corrections: CorrectionInput | None = None,
        faults: FaultInjector | None = None,
        autopilot: MavlinkPart | None = None,
    ) -> None:
        """may_send: room for telemetry on a channel; answers are always sent. take_snapshot: of the boat."""
        self.outbox = Outbox()
        self.ignored = 0  # messages without a service
        self.faults = 0  # messages whose handling went wrong: a defect of ours, see the log
        self._logged: set[str] = set()
        self._ticked_s = self._due_s = 0.0
        self._own = own
        self._vehicle = vehicle
        self._parameters = parameters
        self.texts = StatusTextService(self.outbox)
        if logbook is not None:
            self.texts.listener = logbook.note
        self._heartbeat = HeartbeatService(vehicle, self.outbox, motor_test)
        self._telemetry = TelemetryService(
            self.outbox, take_snapshot, may_send, parameters.config.probe, sensors.is_ais_fitted
        )
        self._time = TimeService(self.outbox)
        self._addresses = AddressCheck(channels, self.outbox, self.texts)
        self._pose = ExternalPoseService(
            sensors.external, vehicle, parameters, self.outbox, self.texts, self._time.to_own_clock
        )
        self._listings = ParameterService(parameters, self.outbox, self.texts, vehicle.data_losses)
        self._commands = CommandService(
            vehicle,
            self._telemetry,
            self.outbox,
            motor_test,
            self._listings,
            self.texts,
            self._pose,
            calibration,
            sensors,
            payload,
            faults,
        )
        self._access = AccessService(
            parameters, self._listings, self._commands.questions, self.outbox, self.texts
        )
        components: list[Component] = []
        if (camera := parameters.config.camera).is_fitted:
            components.append(
                CameraComponent(camera.component, payload, self.outbox, self.texts, take_snapshot)
            )
        if autopilot is not None:
            routed = parameters.config.parts.autopilot_part.component
            components.append(RoutedAutopilot(routed, autopilot, vehicle, self.outbox))
        self._components = Components(own, components)
        self._missions = MissionService(
            own, vehicle, parameters.config, storage, self.outbox, self.texts, payload.fitted
        )
        self._manual = ManualControlService(vehicle, self.texts)
        self._guided = GuidedService(vehicle, self.texts)
        self._other_vehicles = OtherVehicleService(vehicle)
        self._modes = AvailableModesService(vehicle, self.outbox)
        self.roles = Roles()
        folder = storage.folder if isinstance(storage, FolderStorage) else None
        tree = build_tree(parameters, self._listings, folder, parameters.config.storage.files_mb)
        self._files = FtpService(own, self.outbox, tree, open_worker(folder))
        self._logs = LogService(own, vehicle, self.outbox, self.texts, logbook)
        self._signing = SigningService(own, vehicle, signing, channels, self.texts)
        self.corrections = CorrectionService(corrections, self.texts)
        self._handlers = self._dispatch_table()

    def _dispatch_table(self) -> dict[int, Handler]:
        listings, telemetry, commands = self._listings, self._telemetry, self._commands
        return {
            dialect.MAVLINK_MSG_ID_HEARTBEAT: self._on_heartbeat,
            dialect.MAVLINK_MSG_ID_COMMAND_LONG: lambda m, o, t: commands.handle(command_of(m, o, t)),
            dialect.MAVLINK_MSG_ID_COMMAND_INT: lambda m, o, t: commands.handle(command_of(m, o, t)),
            dialect.MAVLINK_MSG_ID_AUTOPILOT_VERSION_REQUEST: commands.on_version_request,
            dialect.MAVLINK_MSG_ID_TIMESYNC: self._time.on_timesync,
            dialect.MAVLINK_MSG_ID_PING: self._on_ping,
            dialect.MAVLINK_MSG_ID_SYSTEM_TIME: self._on_system_time,
            dialect.MAVLINK_MSG_ID_GPS_INJECT_DATA: self.corrections.on_inject_data,
            dialect.MAVLINK_MSG_ID_GPS_RTCM_DATA: self.corrections.on_rtcm_data,
            **self._pose.table,
            dialect.MAVLINK_MSG_ID_SET_MODE: lambda m, o, t: commands.on_set_mode(m, o),
            dialect.MAVLINK_MSG_ID_PARAM_REQUEST_LIST: self._on_request_list,
            dialect.MAVLINK_MSG_ID_PARAM_REQUEST_READ: lambda m, o, t: listings.on_request_read(m, o),
            dialect.MAVLINK_MSG_ID_PARAM_SET: lambda m, o, t: listings.on_set(m, o),
            dialect.MAVLINK_MSG_ID_REQUEST_DATA_STREAM: (
                lambda m, o, t: telemetry.on_request_data_stream(m, o.channel, t)
            ),
            dialect.MAVLINK_MSG_ID_FILE_TRANSFER_PROTOCOL: self._files.handle,
            dialect.MAVLINK_MSG_ID_MANUAL_CONTROL: self._manual.on_manual_control,
            dialect.MAVLINK_MSG_ID_RC_CHANNELS_OVERRIDE: self._manual.on_rc_override,
            dialect.MAVLINK_MSG_ID_SET_POSITION_TARGET_GLOBAL_INT: self._guided.on_global_target,
            dialect.MAVLINK_MSG_ID_SET_POSITION_TARGET_LOCAL_NED: self._guided.on_local_target,
            dialect.MAVLINK_MSG_ID_SET_ATTITUDE_TARGET: self._guided.on_attitude_target,
            dialect.MAVLINK_MSG_ID_FOLLOW_TARGET: lambda m, o, t: self._other_vehicles.on_follow_target(m, o),
            dialect.MAVLINK_MSG_ID_GLOBAL_POSITION_INT: (
                lambda m, o, t: self._other_vehicles.on_global_position(m, o)
            ),
            dialect.MAVLINK_MSG_ID_SETUP_SIGNING: self._signing.on_setup,
            **dict.fromkeys(MISSION_MESSAGES, self._missions.handle),
            **dict.fromkeys(LOG_MESSAGES, self._logs.handle),
        }

    @property
    def message_ids(self) -> frozenset[int]:
        """The handled messages; others are not unpacked."""
        return self._components.handled.union(self._handlers)

    def open(self, channel: int, stream_hz: float | None = None) -> None:
        """A channel has opened: send a heartbeat and start telemetry.

        stream_hz: rate of this link, if configured.
        """
        self._signing.open(channel)
        default_hz = self._parameters.config.mavlink.stream_hz
        self._telemetry.open(channel, default_hz if stream_hz is None else stream_hz)
        self._listings.open(channel)
        self.outbox.send(channel, self._heartbeat.message())
        self._components.open(channel)

    def forget(self, channel: int, now_s: float) -> None:
        """A channel has closed."""
        self._missions.forget(channel, now_s)
        for service in (
            self._signing, self._addresses, self._telemetry, self._listings, self._files, self._manual,
            self._commands, self._logs,
        ):  # fmt: skip
            service.forget(channel)

    @property
    def restart_due_s(self) -> float:
        """When to restart the program at a station's request; infinite without one."""
        return self._commands.restart_due_s

    @property
    def unix_offset_s(self) -> float | None:
        """Unix time less the boat's time, from a station."""
        return self._time.unix_offset_s

    def mission_items(self) -> tuple[MissionItem, ...]:
        return self._missions.items(MissionType.MISSION)

    def close(self) -> None:
        self._files.close()

    def handle(self, channel: int, received: Received, now_s: float) -> None:
        """Dispatch one message. Never raises."""
        message, sender = received.message, received.sender
        handler = self._handlers.get(message.get_msgId())
        component = self._components.addressed(message)
        is_ours = component is not None or (handler is not None and self._is_for_us(message))
        if sender == self._own or not is_ours:
            self.ignored += 1
            return
        origin = Origin(channel, sender)
        self._due_s = now_s
        try:
            self._commands.on_message(origin, now_s)
            if self._access.refuses(message, origin, now_s):
                return
            if component is not None:
                component.handle(message, origin, now_s)
                return
            if handler is not None:
                handler(message, origin, now_s)
            if message.get_msgId() in _STEERING:
                self._note_planner(message, sender, now_s)
        except Exception:
            self._count_fault(message.get_type())

    def tick(self, now_s: float, unix_s: float, heading: HeadingReading | None, load: float) -> None:
        """Periodic work: services with nothing under way every _PERIOD_S, or with news. Never raises.

        unix_s: Unix time known to the boat itself, 0 if unknown. heading: as measured. load: share of the
        tick used.
        """
        try:
            self._tick(now_s, unix_s, heading, load)
        except Exception:
            self._count_fault("tick")

    def _count_fault(self, where: str) -> None:
        self.faults += 1
        if where not in self._logged:
            self._logged.add(where)
            logger.exception("fault %d, in handling %s; further ones are only counted", self.faults, where)

    def _tick(self, now_s: float, unix_s: float, heading: HeadingReading | None, load: float) -> None:
        if now_s >= self._due_s or self._vehicle.status_texts or self._vehicle.progress.reached:
            self._tick_services(now_s, unix_s, heading, load)
        self._components.tick(now_s)
        if self._vehicle.status_texts:
            self.texts.send(self._vehicle.take_status_texts())
        self._telemetry.tick(now_s)

    def _tick_services(
        self, now_s: float, unix_s: float, heading: HeadingReading | None, load: float
    ) -> None:
        self._signing.tick(now_s, unix_s)  # after boot, nothing is sent before timestamps are reserved
        self._heartbeat.tick(now_s)
        self._missions.tick(now_s)
        self._commands.tick(heading, now_s)
        self._listings.tick()
        self._files.tick(now_s)
        self._logs.tick(now_s, load)
        self._modes.tick(now_s)
        self._time.tick(now_s)
        self.corrections.tick(now_s)
        self.texts.tick(now_s - self._ticked_s)
        self._ticked_s = now_s
        is_busy = any(
            service.is_busy
            for service in (self._missions, self._commands, self._listings, self._files, self._logs)
        )
        self._due_s = now_s if is_busy else now_s + _PERIOD_S

    def _note_planner(self, message: Message, sender: Address, now_s: float) -> None:
        """A planner in control triggers a failsafe when it falls silent."""
        vehicle = self._vehicle
        is_order = getattr(message, "command", _REPOSITION) == _REPOSITION
        if is_order and self.roles.of(sender) is Role.PLANNER and vehicle.is_guided:
            vehicle.failsafes.planner.steers(now_s)

    def announce_changes(self) -> None:
        """Send changes by the last message at once."""
        self._heartbeat.announce_change()
        self._modes.announce_change()
        self.texts.send(self._vehicle.take_status_texts())

    def _is_for_us(self, message: Message) -> bool:
        target_system = getattr(message, "target_system", getattr(message, "target", 0))
        return concerns(self._own, target_system, getattr(message, "target_component", 0))

    def _on_heartbeat(self, message: Message, origin: Origin, now_s: float) -> None:
        # Only the operator's heartbeat resets the operator failsafe
        chosen = self._parameters.config.identity.operator_system_id
        role = self.roles.update(message, origin.address, chosen)
        if role is Role.OPERATOR:
            self._vehicle.failsafes.operator_heard_s = now_s
        elif role is Role.PLANNER:
            self._vehicle.failsafes.planner.heard(now_s)
        self._addresses.on_heartbeat(origin, self._heartbeat, now_s)

    def _on_request_list(self, message: Message, origin: Origin, now_s: float) -> None:
        self._listings.on_request_list(origin)
        if message.target_component == ALL:
            self._components.handle(message, origin, now_s)

    def _on_ping(self, message: Message, origin: Origin, now_s: float) -> None:  # noqa: ARG002
        self._time.on_ping(message, origin)
        self._addresses.on_ping(message, origin)

    def _on_system_time(self, message: Message, origin: Origin, now_s: float) -> None:
        # Not from other vehicles, which broadcast their time
        if self.roles.of(origin.address) in (Role.OPERATOR, Role.PLANNER):
            self._time.on_system_time(message, now_s)
