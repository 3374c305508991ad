"""The boat: the whole data flow, from links and sensors to motors and telemetry, in one step."""

import logging
import math
from collections.abc import Collection, Sequence

from companion.app.safety_net import Fall, SafetyNet
from companion.calibration.motor_test import MotorTest
from companion.calibration.runner import CalibrationRunner
from companion.config.boat_config import BoatConfig
from companion.config.parameter_table import ROWS
from companion.config.parameters import Parameters
from companion.config.thrusters import Thrusters
from companion.control.allocation import motor_pwm
from companion.core.state import STOPPED, MotorCommand, NavState
from companion.core.status_text import Severity
from companion.estimation.estimator import Estimator
from companion.failsafe.guards import HELD_S
from companion.failsafe.inputs import BoardReadings
from companion.guidance.pipeline import GuidancePipeline
from companion.hal.interfaces import Hardware, Port
from companion.log.logbook import Logbook
from companion.log.onboard import OnboardLog
from companion.mavlink.address import Address
from companion.obstacles.planning.avoidance import Stage
from companion.persistence.signing_store import SigningStore
from companion.persistence.storage import Storage
from companion.rc.rc_control import RcControl
from companion.router.channels import Channels
from companion.router.configured_port import ConfiguredPort
from companion.sensors.external import ExternalSensors
from companion.sensors.readings import RcReading
from companion.sensors.suite import SensorSuite
from companion.sensors.wall_time import WallTime
from companion.services.endpoint import Endpoint
from companion.services.telemetry.snapshot import Snapshot
from companion.vehicle.resume import VoyageResume
from companion.vehicle.vehicle import Vehicle

logger = logging.getLogger(__name__)

COMPONENT_ID = 1  # a ground station makes a vehicle only of component 1
TICK_S = 0.02
_BARE = Thrusters()  # a motor gets its thrust share as it is, while the motors are measured
_LINKS_S = 0.1  # how often a tick looks for links that come and go without a descriptor to tell of it


class Boat:
    """Everything on board but the hardware and the clock, which are handed in.

    `step` is called once a tick, `receive` whenever a link has something; both with the seconds since boot.
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
        self.parameters = Parameters(config, ROWS, storage, hardware.parameter_hooks)
        own = Address(self.parameters.config.identity.system_id, COMPONENT_ID)
        self.vehicle = Vehicle(self.parameters.config)
        self.motor_test = MotorTest()
        self.calibration = CalibrationRunner()
        self.rc_control = RcControl()
        self.vehicle.manual_input.rc.is_fitted = hardware.rc is not None
        self.sensors = SensorSuite(hardware, ExternalSensors(config.external))
        self.channels = Channels(ports, own)
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
            external=self.sensors.external,
            gauge=self.sensors.gauge,
            faults=hardware.faults,
            take_snapshot=self.take_snapshot,
        )
        if logbook is not None:
            logbook.onboard = OnboardLog(
                logbook.sink, self.parameters, self.endpoint.mission_items, self.vehicle
            )
        self.channels.wanted = self.endpoint.message_ids
        self.endpoint.outbox.room = self.channels.room_bytes
        self.estimator = Estimator(self.parameters.config.speed, self.parameters.config.estimation)
        self.steering = GuidancePipeline(config, self.vehicle.status_texts)
        self.net = SafetyNet()
        self.resume = VoyageResume(storage, self.vehicle)
        self.load = 0.0  # share of the tick that the last steps took; the runner's to say
        self.free_memory_bytes = 0  # of the computer; the program's to say
        self.command: MotorCommand = STOPPED
        self.nav: NavState | None = None
        self._hardware = hardware
        self._storage = storage
        self._logbook = logbook
        self._wall_time = WallTime(unix_offset_s)
        self._now_s = self._far_m = 0.0
        self._trips = 0  # of the motor cutoff, as far as stations know
        self._links_due_s = 0.0

    def receive(self, now_s: float, ready: Collection[int] | None = None) -> int:
        """Take in new links and what stations have said, pass on what is for others, and answer at once.

        ready: the descriptors that have something to say; None looks everywhere, as every tick does.
        Returns how many frames it took. `channels.has_more` says whether there are more to take.
        """
        try:
            return self._receive(now_s, ready, looks_for_links=True)
        except Exception as error:
            self._catch(error)
            return 0

    def _receive(self, now_s: float, ready: Collection[int] | None, *, looks_for_links: bool) -> int:
        channels = self.channels
        taken, is_news = channels.taken, False
        if looks_for_links:
            for number in channels.accept(ready):
                self.endpoint.open(number, channels.open[number].policy.stream_hz)
                is_news = True
        if self._logbook is not None:
            self._logbook.follow(channels, now_s + self._wall_time.offset_s)
        for number, received in channels.receive(now_s, ready):
            self.endpoint.handle(number, received, now_s)
            is_news = True
        if is_news:
            self._act_on_news()
        if looks_for_links:
            for number in channels.drop_closed():
                self.endpoint.forget(number, now_s)
        return channels.taken - taken

    def _act_on_news(self) -> None:
        """What stations have just changed takes effect, and is told, at once."""
        self.vehicle.config = self.parameters.config
        may_drive = self.vehicle.armed or self.motor_test.is_running
        if not may_drive and (self.command.left or self.command.right):
            self._hardware.motors.stop()  # a disarmed boat does not wait for its next tick
            self.command = STOPPED
        self.steering.request_update()
        self.endpoint.announce_changes()
        self._flush()

    def step(self, now_s: float) -> None:
        """One tick: sense, listen, decide, steer, drive, tell.

        Raises:
            Exception: a fault of ours that does not end; the motors are off, and the boat is disarmed.
        """
        self._now_s = now_s
        try:
            self._step(now_s)
        except Exception as error:
            self._catch(error)
        else:
            if self.net.level:
                self.net.passed()

    def _step(self, now_s: float) -> None:
        self._report_cutoff()
        self._sense(now_s)
        looks_for_links = now_s >= self._links_due_s
        if looks_for_links:
            self._links_due_s = now_s + _LINKS_S
        self._receive(now_s, None, looks_for_links=looks_for_links)
        self.command = self._steer(now_s)
        is_bare = self.calibration.is_bare or self.motor_test.is_running
        setting = _BARE if is_bare else self.parameters.config.thrusters
        self._hardware.motors.write(*motor_pwm(self.command, self.vehicle.status.motors, setting))
        if self._logbook is not None:
            self._logbook.tick(now_s, self.take_snapshot, self.channels)
        self.endpoint.tick(now_s, self._wall_time.own_unix_s(now_s), self.sensors.compass, self.load)
        self.resume.update(self.vehicle, now_s)
        self._flush()

    def _catch(self, error: Exception) -> None:
        """A tick has gone wrong: motors off before anything else, and what was steering begins anew.

        Motors that do not stop disarm the boat; the driver is asked again at every tick from then on.
        """
        outcome, has_stopped = "motors off", True
        try:
            self._hardware.motors.stop()
        except Exception as stuck:
            logger.exception("the motors do not stop")
            outcome, has_stopped = f"motors do not stop: {stuck}", False
        self.command = STOPPED
        self.motor_test.stop()
        self.calibration.stop("fault in the program")
        self.steering.reset()
        fall = self.net.caught(error)
        what = f"Fault in the program: {type(error).__name__}, {outcome}"
        self.vehicle.stop_on_fault(what, disarms=fall is not Fall.HOLD or not has_stopped)
        try:
            self.endpoint.announce_changes()
            self._flush()
        except Exception:
            logger.exception("what has happened cannot be told")
        if fall is Fall.GIVE_UP:
            raise error

    def _report_cutoff(self) -> None:
        """The loop was stalled and runs again: say why the motors were off meanwhile."""
        cutoff = self._hardware.cutoff
        if cutoff is not None and cutoff.trips != self._trips:
            self._trips = cutoff.trips
            timeout_s = self.parameters.config.motors.command_timeout_s
            self.vehicle.notify(Severity.CRITICAL, f"Program stalled: motors cut off after {timeout_s:g} s")

    def _board_readings(self) -> BoardReadings:
        """What the failsafes look at and the vehicle does not know itself."""
        sensors, steering = self.sensors, self.steering
        gives_way = steering.avoidance.stage in (Stage.BACK, Stage.BLOCKED)
        is_held = steering.headway.held_s > HELD_S
        sonar_s = self.vehicle.board.sonar_s
        if sensors.sonar is not None and not steering.perception.is_noisy:
            sonar_s = sensors.sonar.time_s
        log_fault = "" if self._logbook is None else self._logbook.sink.fault
        return BoardReadings(
            left=self.command.left,
            right=self.command.right,
            judges_motors=not (gives_way or is_held or self.calibration.is_running),
            stall=steering.headway.verdict,
            held_s=steering.headway.held_s,
            load=self.load,
            consumed_mah=sensors.consumed_mah,
            heading=sensors.compass,
            hull=sensors.hull,
            sonar_s=sonar_s,
            storage_fault=log_fault or self.resume.fault,
        )

    @property
    def wants_restart(self) -> bool:
        """Whether a station has asked for the program to begin anew."""
        return self._now_s >= self.endpoint.restart_due_s

    def close(self) -> None:
        """Motors off first, then everything else. May be called twice."""
        self._hardware.close()
        self.endpoint.close()
        self.channels.close()
        self.signing.close()
        if self._logbook is not None:
            self._logbook.close()
        self._storage.close()

    def _sense(self, now_s: float) -> None:
        sensors, estimator = self.sensors, self.estimator
        sensors.read(self.parameters.config, now_s, self.command)
        if estimator.frame is None:
            estimator.preset_frame = sensors.external.frame
        elif sensors.external.frame is None:
            sensors.external.frame = estimator.frame
        self.nav = estimator.update(sensors.fix, sensors.heading, now_s, self.command)
        if estimator.far_m or self._far_m:
            self._begin_elsewhere()
        if sensors.pings:
            perception = self.steering.perception
            perception.ingest(sensors.pings, self.nav, self.parameters.config.avoidance, now_s)
            sensors.point_sonar(perception.sector)
        self._wall_time.update(sensors.fix, self.endpoint.unix_offset_s, is_fix_own=sensors.is_fix_own)
        self.vehicle.update_state(self.nav, estimator.frame, sensors.fix, sensors.battery, now_s)
        if sensors.rc is not None:
            self._follow_rc(sensors.rc, now_s)

    def _follow_rc(self, reading: RcReading, now_s: float) -> None:
        vehicle, config = self.vehicle, self.parameters.config
        actions = self.rc_control.update(reading, vehicle.manual_input, vehicle.status, config, now_s)
        if actions.text:
            vehicle.notify(Severity.NOTICE, actions.text)
        for request in actions.requests:
            vehicle.request(request)
        if actions.is_urgent:
            self.steering.request_update()

    def _begin_elsewhere(self) -> None:
        """Every fix lies beyond the local frame: a disarmed boat lays another, an armed one says so."""
        estimator, was_far, far_m = self.estimator, self._far_m > 0.0, self.estimator.far_m
        self._far_m = far_m
        if far_m == 0.0:
            return
        if not self.vehicle.armed:
            if self.sensors.external.frame is estimator.frame:
                self.sensors.external.frame = None
            estimator.reset_origin()
            self.steering.reset()
            self.vehicle.reset_position(far_m)
            self._far_m = 0.0
        elif not was_far:
            text = f"GPS: {far_m / 1e3:.0f} km from where the boat was, not used until disarmed"
            self.vehicle.notify(Severity.WARNING, text)

    def _steer(self, now_s: float) -> MotorCommand:
        steering, config, nav, vehicle = self.steering, self.parameters.config, self.nav, self.vehicle
        if steering.is_due(now_s) or self.calibration.is_running:
            if vehicle.failsafes.is_due(now_s):
                vehicle.board = self._board_readings()
            intent = vehicle.decide()
            if self.calibration.is_running:
                if steering.avoidance.stage is not Stage.CLEAR:
                    self.calibration.stop("an obstacle")
                is_slowed = steering.avoidance.safe_speed.ahead_m_s < math.inf
                intent = self.calibration.update(
                    intent,
                    vehicle.status,
                    nav,
                    vehicle.fence,
                    config,
                    now_s,
                    fix=self.sensors.fix,
                    command=self.command,
                    is_slowed=is_slowed,
                )
            steering.guide(intent, nav, vehicle.status, vehicle.fence, config, now_s)
        if self.motor_test.is_running:
            thrust = self.motor_test.thrust(vehicle.status, now_s)  # which may be the end of it
            return steering.test_motors(
                thrust,
                config,
                TICK_S,
                may_turn=self.motor_test.is_running,
                command_age_s=now_s - self.motor_test.decided_s,
            )
        return steering.drive(nav, vehicle.status, config, now_s, TICK_S)

    def take_snapshot(self) -> Snapshot:
        """Everything there is to tell of the present tick."""
        sensors = self.sensors
        return Snapshot(
            now_s=self._now_s,
            unix_s=self._wall_time.unix_s(self._now_s),
            config=self.parameters.config,
            vehicle=self.vehicle,
            nav=self.nav,
            frame=self.estimator.frame,
            fix=sensors.fix,
            battery=sensors.battery,
            sonar=sensors.sonar,
            demand=self.steering.demand,
            heading_pid=self.steering.helm.heading_pid,
            command=self.command,
            consumed_mah=sensors.consumed_mah,
            battery_percent=sensors.gauge.percent,
            load=self.load,
            speed_pid=self.steering.helm.speed_pid,
            heading=sensors.compass,
            sweep=sensors.sweep,
            perception=self.steering.perception,
            avoidance=self.steering.avoidance,
            free_memory_bytes=self.free_memory_bytes,
        )

    def _flush(self) -> None:
        outbox = self.endpoint.outbox
        if not outbox.is_empty:
            for message, channel in outbox.drain():
                self.channels.send(message, channel)
