"""The boat: the whole data flow, from links and sensors to motors and telemetry, in one step."""

import logging
import math
from collections.abc import Collection, Sequence
from contextlib import ExitStack

from companion.autopilot.motor_output import Fall, MotorOutput, SafetyNet
from companion.autopilot.pipeline import GuidancePipeline
from companion.autopilot.sensor_suite import OriginMonitor, SensorSuite
from companion.autopilot.snapshot import Snapshot, board_readings
from companion.calibration.motor_test import MotorTest
from companion.calibration.runner import CalibrationRunner
from companion.config.actuators import Thrusters
from companion.config.boat_config import BoatConfig
from companion.config.parameter_table import ROWS
from companion.config.parameters import Parameters
from companion.core.errors import HardwareError, SilentOutputsError
from companion.core.state import MotorCommand, NavState
from companion.core.status_text import Severity
from companion.core.storage import Storage
from companion.estimation.estimator import Estimator
from companion.hal.interfaces import Hardware, ReportingPart
from companion.links.interfaces import Port
from companion.log.logbook import Logbook
from companion.log.onboard import OnboardLog
from companion.mavlink.address import Address
from companion.obstacles.perception.vessels import vessels_near
from companion.obstacles.planning.planner import Stage
from companion.persistence.signing_store import SigningStore
from companion.rc.rc_control import RcControl
from companion.router.channels import Channels
from companion.router.policy import ConfiguredPort
from companion.sensors.compass.magnetic_field import compass_hooks
from companion.sensors.external import ExternalSensors
from companion.sensors.wall_time import WallTime
from companion.services.endpoint import Endpoint
from companion.services.station_links import StationLinks
from companion.vehicle.payload_control import PayloadControl
from companion.vehicle.resume import VoyageResume
from companion.vehicle.vehicle import Vehicle

logger = logging.getLogger(__name__)

COMPONENT_ID = 1  # ground stations accept only component 1 as a vehicle
TICK_S = 0.02
LEAP_S = 1.0  # between two ticks; shorter than the timeout of any failsafe
SETTLE_S = 1.5  # heartbeats come each second, all readings sooner
_BARE = Thrusters()  # without trim, while the motors are measured
_SLOW_S = 0.1  # between looks at links without a descriptor, and at texts and faults of parts


class Boat:
    """Everything on board except hardware and clock, which are passed in.

    `step` is called every tick, `receive` whenever a link has data; both with the seconds since boot.
    """

    def __init__(
        self,
        config: BoatConfig,
        hardware: Hardware,
        ports: Sequence[Port],
        storage: Storage,
        unix_offset_s: float = 0.0,
        logbook: Logbook | None = None,
    ) -> None:
        hooks = [] if hardware.field is None else compass_hooks(hardware.field)
        self.parameters = Parameters(config, ROWS, storage, (*hardware.parameter_hooks, *hooks))
        self.address = own = Address(self.parameters.config.identity.system_id, COMPONENT_ID)
        self.vehicle = Vehicle(self.parameters.config)
        self.motors = MotorOutput(hardware)
        self.motor_test = MotorTest()
        self.calibration = CalibrationRunner()
        self.payload = PayloadControl(self.parameters.config, hardware.payload, self.vehicle)
        self.rc_control = RcControl()
        self.vehicle.manual_input.rc.is_fitted = hardware.rc is not None
        self.sensors = SensorSuite(hardware, ExternalSensors(config.external))
        self.channels = Channels(ports, own, self.parameters.config.components)
        self.vehicle.compass_fault = self.sensors.compass_fault
        self.vehicle.has_battery_monitor = self.sensors.has_battery_monitor
        if self.sensors.uses_earth_field(self.parameters.config.parts.compass):
            self.sensors.earth.load()
        self.signing = SigningStore(storage, unix_offset_s)
        for port in ports:
            if isinstance(port, ConfiguredPort) and port.policy.setting.signing != "off":
                self.signing.signatory(port.policy.setting.key_file)
        self.endpoint = Endpoint(
            own,
            self.vehicle,
            self.parameters,
            storage,
            self.channels.may_send,
            logbook,
            signing=self.signing,
            channels=self.channels.open,
            motor_test=self.motor_test,
            calibration=self.calibration,
            corrections=hardware.corrections,
            sensors=self.sensors,
            faults=hardware.faults,
            take_snapshot=self.take_snapshot,
            payload=self.payload,
            autopilot=hardware.autopilot,
        )
        if logbook is not None:
            logbook.onboard = OnboardLog(
                logbook.sink, self.parameters, self.endpoint.mission_items, self.vehicle, self.payload
            )
        self._links = StationLinks(self.channels, self.endpoint, logbook)
        self.channels.wanted = self.endpoint.message_ids
        self.endpoint.outbox.room = self.channels.room_bytes
        figures = self.parameters.config
        self.estimator = Estimator(figures.speed, figures.estimation, figures.drive, figures.handling)
        self._compass_correction = None if hardware.field is None else hardware.field.correction
        self._origin = OriginMonitor(self.estimator, self.sensors.external)
        self.guidance = GuidancePipeline(config, self.vehicle.status_texts, self.vehicle.voyage)
        self.net = SafetyNet()
        self.resume = VoyageResume(storage, self.vehicle)
        self.load = 0.0  # share of the tick that the last steps took; set by the runner
        self.free_memory_bytes = 0  # of the computer; set by the program
        self.nav: NavState | None = None
        self._hardware = hardware
        reporting = (port for port in ports if isinstance(port, ReportingPart))
        self._reporting = [*hardware.reporting_parts, *reporting]
        self._storage = storage
        self._logbook = logbook
        self._wall_time = WallTime(unix_offset_s)
        self._now_s = 0.0
        self._slow_due_s = 0.0

    def receive(self, now_s: float, ready: Collection[int] | None = None) -> int:
        """Accept links, handle messages, forward those for others, and answer at once.

        ready: the descriptors with data; None checks all. Returns the number of frames taken;
        `channels.has_more` says whether there are more.
        """
        try:
            return self._receive(now_s, ready, accepts_links=True)
        except Exception as error:
            self._catch(error)
            return 0

    def _receive(self, now_s: float, ready: Collection[int] | None, *, accepts_links: bool) -> int:
        taken, unix_s = self.channels.taken, now_s + self._wall_time.offset_s
        if self._links.receive(now_s, unix_s, ready, accepts_links=accepts_links):
            self._act_on_news()
        if accepts_links:
            self._links.drop_closed(now_s)
        return self.channels.taken - taken

    def may_drive(self) -> bool:
        """Whether the motors may turn: armed, or in a motor test."""
        return self.vehicle.armed or self.motor_test.is_running

    def _act_on_news(self) -> None:
        """Apply and announce at once what stations have changed."""
        self.vehicle.config = self.parameters.config
        if not self.may_drive() and (self.command.left or self.command.right):
            self.motors.stop()  # a disarmed boat does not wait for its next tick
        self.guidance.request_update()
        self.endpoint.announce_changes()
        self._links.flush()

    def step(self, now_s: float) -> None:
        """One tick: sense, receive, decide, steer, drive, send.

        Raises:
            Exception: a fault that persists; the motors are off, and the boat is disarmed.
        """
        leap_s, self._now_s = now_s - self._now_s if self._now_s else 0.0, now_s
        try:
            if leap_s > LEAP_S:
                self._note_leap(leap_s, now_s)
            self._step(now_s)
        except Exception as error:
            self._catch(error)
        else:
            self.net.passed()

    def _note_leap(self, leap_s: float, now_s: float) -> None:
        """Nothing was read meanwhile: what is silent shows once all have had the time to report again."""
        self.vehicle.notify(Severity.WARNING, f"Clock leapt by {leap_s:.1f} s, or the program hung")
        self.vehicle.failsafes.postpone(now_s + SETTLE_S)

    def _step(self, now_s: float) -> None:
        self.vehicle.config = self.parameters.config  # a mission or a calibration may have changed it
        if text := self.motors.trip_text(self.parameters.config.motors.command_timeout_s):
            self.vehicle.notify(Severity.CRITICAL, text)
        self._sense(now_s)
        is_slow_due = now_s >= self._slow_due_s
        if is_slow_due:
            self._slow_due_s = now_s + _SLOW_S
            for part in self._reporting:
                for severity, told in part.take_texts():
                    self.vehicle.notify(severity, told)
        self._receive(now_s, None, accepts_links=is_slow_due)
        command = self._steer(now_s)
        is_bare = self.calibration.is_bare or self.motor_test.is_running
        setting = _BARE if is_bare else self.parameters.config.thrusters
        if (outputs := self._hardware.outputs) is not None:
            outputs.allow(may_drive=self.may_drive())
            if outputs.fault and self.vehicle.armed:  # the motors are off, and its sensors may be away, too
                self.vehicle.failsafes.suspend(now_s + SETTLE_S)
        try:
            self.motors.write(command, self.vehicle.recovery.motor_check.motors, setting)
            if is_slow_due:  # once the motors have answered
                self.vehicle.output_fault = self._hardware.output_fault
        except SilentOutputsError as error:
            self.vehicle.output_fault = str(error)
            self._catch(error)
        self.payload.tick(now_s)
        if self._logbook is not None:
            self._logbook.tick(now_s, self.take_snapshot, self.channels)
        self.endpoint.tick(now_s, self._wall_time.own_unix_s(now_s), self.sensors.compass, self.load)
        self.resume.update(self.vehicle, now_s)
        self._links.flush()

    def _catch(self, error: Exception) -> None:
        """A fault in a tick: motors off first, then HOLD. Motors that do not stop disarm the boat."""
        outcome = self.motors.stop_after_fault()
        if text := self.motors.stuck_text(self._now_s):
            self.vehicle.notify(Severity.CRITICAL, text)
        self.motor_test.stop()
        self.calibration.stop("fault in the program")
        self.guidance.reset()
        fall = self.net.caught(error)
        what = (
            str(error)
            if isinstance(error, HardwareError)
            else f"Fault in the program: {type(error).__name__}"
        )
        self.vehicle.stop_on_fault(
            f"{what}, {outcome}", disarms=fall is not Fall.HOLD or bool(self.motors.stuck)
        )
        try:
            self.endpoint.announce_changes()
            self._links.flush()
        except Exception:
            logger.exception("the fault cannot be announced")
        if fall is Fall.GIVE_UP:
            raise error

    @property
    def command(self) -> MotorCommand:
        """What the motors are given."""
        return self.motors.command

    @property
    def wants_restart(self) -> bool:
        """Whether a station has requested a restart of the program."""
        return self._now_s >= self.endpoint.restart_due_s

    def close(self) -> None:
        """Motors off first, then the rest, even if a part raises. May be called twice."""
        hardware, log = self._hardware, () if self._logbook is None else (self._logbook,)
        with ExitStack() as rest:  # the last one first
            for part in (self._storage, *log, self.signing, self.channels, self.endpoint, hardware):
                rest.callback(part.close)

    def _sense(self, now_s: float) -> None:
        sensors, estimator = self.sensors, self.estimator
        sensors.read(self.parameters.config, now_s, self.command)
        sensors.locate(self.parameters.config.parts.compass, self._wall_time.unix_s(now_s))
        for severity, text in sensors.notices:
            self.vehicle.notify(severity, text)
        self._origin.share_frame()
        correction = None if sensors.field is None else sensors.field.correction
        if correction is not self._compass_correction:
            self._compass_correction = correction
            estimator.heading.forget_offset()
        self.nav = estimator.update(sensors.fix, sensors.heading, now_s, self.command)
        if far_m := self._origin.check(self.vehicle.armed, self.vehicle.notify):
            self.vehicle.reset_position(far_m)
            self.guidance.reset()
        if sensors.pings:
            perception = self.guidance.perception
            perception.ingest(sensors.pings, self.nav, self.parameters.config.avoidance, now_s)
            sensors.point_sonar(perception.sector)
        self._wall_time.update(sensors.fix, self.endpoint.unix_offset_s, is_fix_own=sensors.is_fix_own)
        self.vehicle.update_state(self.nav, estimator.frame, sensors.fix, sensors.battery, now_s)
        self._follow_rc(now_s)

    def _follow_rc(self, now_s: float) -> None:
        vehicle, config = self.vehicle, self.parameters.config
        actions = self.rc_control.update(
            self.sensors.rc, vehicle.manual_input, vehicle.mode, vehicle.armed, config, now_s
        )
        if actions.text:
            vehicle.notify(Severity.NOTICE, actions.text)
        for request in actions.requests:
            vehicle.request(request)
        if actions.is_urgent:
            self.guidance.request_update()

    def _steer(self, now_s: float) -> MotorCommand:
        guidance, config, nav, vehicle = self.guidance, self.parameters.config, self.nav, self.vehicle
        if guidance.is_due(now_s) or self.calibration.is_running:
            frame, ais = self.estimator.frame, self.sensors.ais
            guidance.perception.vessels = vessels_near(ais, frame, nav, config, now_s)
            if vehicle.failsafes.is_due(now_s):
                log_fault = "" if self._logbook is None else self._logbook.sink.fault
                vehicle.board = board_readings(
                    vehicle.board,
                    self.sensors,
                    guidance,
                    self.command,
                    is_calibrating=self.calibration.is_running,
                    is_armed=vehicle.armed,
                    min_depth_m=config.failsafe.min_depth_m,
                    load=self.load,
                    storage_fault=log_fault or self.resume.fault,
                )
            intent = vehicle.decide()
            if self.calibration.is_running:
                if guidance.avoidance.stage is not Stage.CLEAR:
                    self.calibration.stop("an obstacle")
                intent = self.calibration.update(
                    intent,
                    vehicle.status,
                    nav,
                    vehicle.fence,
                    config,
                    now_s,
                    fix=self.sensors.fix,
                    command=self.command,
                    is_slowed=guidance.avoidance.limit.ahead_m_s < math.inf,
                )
            guidance.guide(intent, nav, vehicle.status, vehicle.fence, config, now_s)
        if self.motor_test.is_running:
            thrust = self.motor_test.thrust(vehicle.status, now_s)  # may end the test
            return guidance.test_motors(
                thrust,
                config,
                TICK_S,
                may_turn=self.motor_test.is_running,
                command_age_s=now_s - self.motor_test.decided_s,
            )
        return guidance.drive(nav, vehicle.status, config, now_s, TICK_S)

    def take_snapshot(self) -> Snapshot:
        """The state of the present tick, for telemetry and log."""
        return Snapshot(
            self._now_s,
            self._wall_time.unix_s(self._now_s),
            self.parameters.config,
            self.vehicle,
            self.estimator,
            self.sensors,
            self.guidance,
            self.command,
            self.load,
            self.free_memory_bytes,
            self.payload,
            self.parameters.rows,
        )
