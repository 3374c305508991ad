"""COMMAND_LONG and COMMAND_INT: a table of commands, each answered immediately.

Unknown commands are refused at once, as silence delays a ground station. A command repeated because its
answer was lost is not executed again if that would make a difference.
"""

import math
from collections import deque

from companion.autopilot.sensor_suite import SensorSuite
from companion.calibration.motor_test import MotorTest
from companion.calibration.runner import CalibrationRunner
from companion.core.readings import HeadingReading
from companion.core.status_text import Severity
from companion.hal.interfaces import FaultInjector
from companion.mavlink.dialect import Message, constants, dialect
from companion.services.commands.calibration_runs import CalibrationCommands
from companion.services.commands.command import Command, CommandTable, FollowUps, Result, acknowledgement
from companion.services.commands.compass import CompassCommands
from companion.services.commands.maintenance import MaintenanceCommands
from companion.services.commands.messages import MessageCommands
from companion.services.commands.payload import NOT_TWICE as _PAYLOAD_NOT_TWICE
from companion.services.commands.payload import payload_commands
from companion.services.commands.refusal_log import RefusalLog
from companion.services.commands.vehicle import VehicleCommands
from companion.services.external_pose import ExternalPoseService
from companion.services.outbox import Origin, Outbox
from companion.services.parameters import ParameterService
from companion.services.statustext import StatusTextService
from companion.services.telemetry.service import TelemetryService
from companion.vehicle.payload_control import PayloadControl
from companion.vehicle.vehicle import Vehicle

RESEND_S = 2.0
_REPEAT_S = 15.0  # in which a station repeats what is not answered: four times at most, 3 s apart
_REMEMBERED = 16  # commands
_PROGRESS_S = 1.0

# Not idempotent
_NOT_TWICE = (
    *constants("MAV_CMD_DO", "MOTOR_TEST", "PAUSE_CONTINUE", "SET_MISSION_CURRENT"),
    dialect.MAV_CMD_MISSION_START,
    *_PAYLOAD_NOT_TWICE,
)

_HARMLESS = (dialect.MAV_CMD_DO_SEND_BANNER, dialect.MAV_CMD_RUN_PREARM_CHECKS)


class CommandService:
    """Executes commands and acknowledges each to its sender."""

    def __init__(
        self,
        vehicle: Vehicle,
        telemetry: TelemetryService,
        outbox: Outbox,
        motor_test: MotorTest,
        parameters: ParameterService,
        texts: StatusTextService,
        pose: ExternalPoseService,
        calibration: CalibrationRunner,
        sensors: SensorSuite,
        payload: PayloadControl,
        faults: FaultInjector | None = None,
    ) -> None:
        self._vehicle = vehicle
        self._outbox = outbox
        self._motor_test = motor_test
        self._follow_ups: FollowUps = []
        self._compass = CompassCommands(vehicle, sensors, parameters, texts, outbox)
        self._upkeep = MaintenanceCommands(
            vehicle, motor_test, parameters, texts, self._compass, sensors.gauge
        )
        self._calibration = CalibrationCommands(vehicle, calibration, parameters, texts)
        self._vehicle_commands = VehicleCommands(vehicle, parameters, texts)
        self._questions = MessageCommands(telemetry, self._follow_ups).table
        self._table: CommandTable = {
            **self._questions,
            **self._upkeep.table,
            **self._compass.table,
            **self._calibration.table,
            **self._vehicle_commands.table,
            **payload_commands(payload, texts),
            dialect.MAV_CMD_DO_SET_GLOBAL_ORIGIN: lambda command: _set_origin(pose, command),
        }
        if faults is not None:
            self._table[dialect.MAV_CMD_INJECT_FAILURE] = lambda one: _inject_fault(one, faults, texts)
        self.questions = frozenset((*self._questions, *_HARMLESS))
        """Commands that change nothing."""
        self._refusals = RefusalLog(texts)
        self._accepted: deque[Command] = deque(maxlen=_REMEMBERED)
        self._done: Command | None = None  # the latest non-idempotent command
        self._left_behind: tuple[object, ...] = ()  # state of the vehicle after it
        self._slow: Command | None = None  # the calibration or trial in progress
        self._progress_s = math.inf

    @property
    def restart_due_s(self) -> float:
        """When to restart the program; infinite without a request."""
        return self._upkeep.restart_due_s

    @property
    def is_busy(self) -> bool:
        """Whether a calibration or a motor test is in progress."""
        return self._slow is not None or self._motor_test.is_running or self._compass.is_busy

    def on_set_mode(self, message: Message, origin: Origin) -> None:
        """SET_MODE, deprecated; acknowledged like the command, as ArduPilot does."""
        p = (float(message.base_mode), float(message.custom_mode), 0.0, 0.0)
        self.handle(Command(dialect.MAV_CMD_DO_SET_MODE, p, math.nan, math.nan, 0, origin, 0.0))

    def on_version_request(self, message: Message, origin: Origin, now_s: float) -> None:  # noqa: ARG002
        """AUTOPILOT_VERSION_REQUEST, deprecated; ArduPilot answers with the message alone."""
        asked = (float(dialect.MAVLINK_MSG_ID_AUTOPILOT_VERSION), 0.0, 0.0, 0.0)
        self._questions[dialect.MAV_CMD_REQUEST_MESSAGE](
            Command(dialect.MAV_CMD_REQUEST_MESSAGE, asked, 0.0, 0.0, 0, origin, now_s)
        )
        self._send_what_follows()

    def on_message(self, origin: Origin, now_s: float) -> None:
        """Any message from a station: it is still present."""
        if self._motor_test.is_running:
            self._upkeep.on_message(origin, now_s)

    def forget(self, channel: int) -> None:
        self._upkeep.forget(channel)
        self._compass.forget(channel)

    def handle(self, command: Command) -> None:
        """Execute and acknowledge a command, then send the requested messages."""
        self._execute(command)
        self._send_what_follows()

    def _execute(self, command: Command) -> None:
        carry_out = self._table.get(command.number)
        if carry_out is None:
            self._answer(command, Result.UNSUPPORTED)
            return
        if self._is_resent(command) or self._is_repeated(command):
            self._answer(command, Result.ACCEPTED)
            return
        if command.number not in self._questions and command.number != dialect.MAV_CMD_DO_MOTOR_TEST:
            self._motor_test.stop()
        result = carry_out(command)
        if result == Result.IN_PROGRESS:
            self._slow, self._progress_s = command, command.now_s + _PROGRESS_S
        elif result == Result.CANCELLED:
            slow, self._slow = self._slow or command, None
            self._answer(slow, Result.CANCELLED)
            return
        if result == Result.ACCEPTED and command.number in _NOT_TWICE:
            self._done, self._left_behind = command, self._situation()
        if result == Result.ACCEPTED:
            self._accepted.append(command)
        self._answer(command, result)

    def tick(self, heading: HeadingReading | None, now_s: float) -> None:
        """Continue calibrations and trials. heading: as measured."""
        self._refusals.tick(now_s)
        self._vehicle_commands.tick()
        results = self._upkeep.tick(heading, now_s), self._calibration.tick(), self._compass.tick(now_s)
        result = next((one for one in results if one is not None), None)
        slow = self._slow
        if slow is None:
            return
        if result is not None:
            self._slow = None
            self._answer(slow, result)
        elif now_s >= self._progress_s:
            jobs = self._upkeep, self._compass, self._calibration
            shares = (job.progress_percent(now_s) for job in jobs)
            percent = next((share for share in shares if share is not None), None)
            if percent is not None:
                self._progress_s = now_s + _PROGRESS_S
                self._answer(slow, Result.IN_PROGRESS, percent)

    def _situation(self) -> tuple[object, ...]:
        return self._vehicle.mode, self._vehicle.armed, self._motor_test.is_running

    def _is_resent(self, command: Command) -> bool:
        """Whether this repeats the last command and the vehicle is still in its resulting state."""
        done = self._done
        return (
            done is not None
            and 0.0 <= command.now_s - done.now_s <= RESEND_S
            and command.is_same_as(done)
            and self._situation() == self._left_behind
        )

    def _is_repeated(self, command: Command) -> bool:
        """Whether its sender counts it as a repetition of a command that has been carried out: it would undo
        what another station has commanded since.
        """
        if command.repetition == 0 or command.number in self.questions:
            return False
        # A station has one command of a number on the way, as an answer names no more: if it has sent another
        # of this number since, the first frame of this one was lost
        latest = next((one for one in reversed(self._accepted) if one.shares_answer_with(command)), None)
        return (
            latest is not None
            and command.now_s - latest.now_s <= _REPEAT_S
            and latest.repetition < command.repetition
            and latest.is_same_as(command)
        )

    def _send_what_follows(self) -> None:
        for channel, message in self._follow_ups:
            self._outbox.send(channel, message)
        self._follow_ups.clear()

    def _answer(self, command: Command, result: Result, progress_percent: int = 0) -> None:
        if command.number not in self.questions:
            self._refusals.add(command, result)
        channel, asker = command.origin
        self._outbox.send(channel, acknowledgement(command.number, result, asker, progress_percent))


def _set_origin(pose: ExternalPoseService, command: Command) -> Result:
    place = command.position()
    if place is None:
        return Result.DENIED
    return Result.ACCEPTED if pose.set_origin(place) else Result.FAILED


def _inject_fault(command: Command, injector: FaultInjector, texts: StatusTextService) -> Result:
    """INJECT_FAILURE: makes emulated hardware fail."""
    unit, failure, instance = command.whole(0), command.whole(1), command.whole(2)
    if unit is None or failure is None or instance is None:
        return Result.DENIED
    if (done := injector.inject(unit, failure, instance)) is None:
        return Result.UNSUPPORTED
    texts.notify(Severity.WARNING, f"Fault: {done}")
    return Result.ACCEPTED
