"""Motors and rudder through ArduPilot Rover: its arming, its mode MANUAL, and overrides of its two sticks.

IDLE       the boat is disarmed. Overrides are neutral unless somebody else has armed the autopilot.
RAISING    the boat is armed: the autopilot is asked for MANUAL and to arm, and asked again when it was
           silent, has rebooted, or its own failsafe (system status CRITICAL) has ended MANUAL.
DRIVING    it is armed in MANUAL: overrides carry the boat's demand.
LEFT       a person, or another of its rules, has disarmed it or chosen another mode. It is not overridden: a
           transmitter can steer. The boat goes on once it is armed in MANUAL again.

When the boat's program or the line fails, Rover's radio failsafe makes the motors neutral after half a second
without an override (Rover/radio.cpp). With a receiver the transmitter's sticks count after RC_OVERRIDE_TIME.
"""

import math
from collections import deque
from collections.abc import Callable
from enum import Enum, auto
from typing import Final

from companion.config.boat_config import BoatConfig
from companion.core.errors import SilentOutputsError
from companion.core.status_text import Severity, StatusText
from companion.core.units import clamp
from companion.hal.autopilot.mixing import Stick, pair_shares, sticks
from companion.hal.autopilot.parameters import RoverParameters
from companion.hal.autopilot.readings import AutopilotReadings
from companion.mavlink.address import Address
from companion.mavlink.dialect import Message, build_message, dialect

OVERRIDE_S: Final = 0.04  # ten in a RC_OVERRIDE_TIME of 0.4 s
_ECHOES: Final = 25  # overrides within a second
_ECHO_S: Final = 0.5  # RC_CHANNELS comes twenty times a second
_SETTLED_S: Final = 0.6  # of neutral before arming: the radio failsafe ends within half a second
_AGAIN_S: Final = 0.5  # between two requests; heartbeats come five times a second
_REFUSED_S: Final = 4.0  # without being armed: a request in every half second was refused
_DISARMING_S: Final = 5.0
_FORCE: Final = 21196.0  # MAV_CMD_COMPONENT_ARM_DISARM: disarm also with turning motors
_MANUAL: Final = 0  # Rover's mode
_IGNORED: Final = (*(0xFFFF,) * 8, *(0,) * 10)  # of channels 1 to 18: not overridden
REASONS: Final = ("PreArm: ", "Arm: ")  # of a text why it cannot be armed
_WHY_S: Final = 10.0  # between two questions why it cannot be armed
_WORDS_S: Final = 11.0  # after its answer: then it has other reasons
_ROVERS: Final = (dialect.MAV_TYPE_GROUND_ROVER, dialect.MAV_TYPE_SURFACE_BOAT)


class State(Enum):
    IDLE = auto()
    RAISING = auto()
    DRIVING = auto()
    LEFT = auto()


class RoverOutputs:
    """Decides what to send. may_drive: set by the boat. fault: why the motors cannot turn."""

    def __init__(self, config: BoatConfig, readings: AutopilotReadings) -> None:
        self.may_drive = False
        self._is_used = config.parts.motors.driver == "autopilot"
        self.fault = "not heard yet" if self._is_used else ""
        self.texts: deque[StatusText] = deque(maxlen=8)
        self.state = State.IDLE
        self.has_rudder = config.drive.layout == "rudder"
        self.parameters = RoverParameters(
            config.parts.autopilot_part.own_system_id, has_rudder=self.has_rudder
        )
        self._is_compass = config.parts.compass.driver == "autopilot"
        self._readings = readings
        self._resume_s = config.parts.autopilot_part.resume_s
        self._drive, self._rudder = (0.0, 0.0), 0.0
        self._heartbeat: Message | None = None
        self._is_ready = False  # its own checks before arming pass
        self._has_sticks = True
        self._words, self._words_s = "", -math.inf  # its latest reason
        self._sticks: tuple[Stick, Stick] | None = None
        self._sent: deque[tuple[int, int]] = deque(maxlen=_ECHOES)  # pulses of steering and throttle
        self._echo_s = -math.inf  # when it last had one of them as its sticks
        self._neutral_s = math.inf  # since when overrides have been sent
        self._override_s = self._request_s = self._raising_s = self._disarm_until_s = -math.inf
        self._why_s = -math.inf
        self._has_driven = self._is_told = self._gave_up = False
        self.table: dict[int, Callable[[Message, float], None]] = {
            dialect.MAVLINK_MSG_ID_HEARTBEAT: self._on_heartbeat,
            dialect.MAVLINK_MSG_ID_PARAM_VALUE: self.parameters.ingest,
            dialect.MAVLINK_MSG_ID_RC_CHANNELS: self._on_channels,
            dialect.MAVLINK_MSG_ID_STATUSTEXT: self._on_text,
            dialect.MAVLINK_MSG_ID_SYS_STATUS: self._on_health,
        }

    def write(self, left: float, right: float) -> None:
        """The boat's demand. Raises SilentOutputsError: the outputs have been away for too long."""
        is_finite = math.isfinite(left) and math.isfinite(right)
        self._drive = (clamp(left, -1.0, 1.0), clamp(right, -1.0, 1.0)) if is_finite else (0.0, 0.0)
        if self._gave_up:
            raise SilentOutputsError(f"autopilot: {self.fault}", are_off=True)

    def write_rudder(self, share: float) -> None:
        self._rudder = clamp(share, -1.0, 1.0) if math.isfinite(share) else 0.0

    def _on_heartbeat(self, message: Message, now_s: float) -> None:  # noqa: ARG002
        self._heartbeat = message

    def _on_health(self, message: Message, now_s: float) -> None:
        enabled = message.onboard_control_sensors_enabled
        lacks = enabled & ~message.onboard_control_sensors_health
        has_heading = not self._is_compass or self._readings.has_heading(now_s)
        self._is_ready = has_heading and not lacks & dialect.MAV_SYS_STATUS_PREARM_CHECK
        # In its radio failsafe it repeats the last sticks
        self._has_sticks = not lacks & dialect.MAV_SYS_STATUS_SENSOR_RC_RECEIVER

    def _on_channels(self, message: Message, now_s: float) -> None:
        """Its sticks: the boat's overrides, unless these do not reach it."""
        if self._sticks is not None:
            pulses = tuple(getattr(message, f"chan{stick.channel}_raw") for stick in self._sticks)
            if pulses in self._sent:
                self._echo_s = now_s

    def _on_text(self, message: Message, now_s: float) -> None:
        """Keep a reason for not arming: it is told with the boat's own."""
        text = str(message.text).rstrip("\0")
        if text.startswith(REASONS):
            self._words, self._words_s = text.partition(": ")[2], now_s

    def restart(self) -> None:
        """It has rebooted."""
        self.parameters.forget()
        self._heartbeat, self._is_ready, self._words = None, False, ""
        self._neutral_s = math.inf

    @property
    def _is_armed(self) -> bool:
        beat = self._heartbeat
        return beat is not None and bool(beat.base_mode & dialect.MAV_MODE_FLAG_SAFETY_ARMED)

    @property
    def _is_manual(self) -> bool:
        return self._heartbeat is not None and self._heartbeat.custom_mode == _MANUAL

    def tick(self, peer: Address | None, is_heard: bool, now_s: float) -> list[Message]:
        """What to send now. peer: the autopilot, once heard; is_heard: it is not silent."""
        if not self._is_used:
            return []
        barred = self._barred(peer, is_heard)
        self._follow(is_heard and not barred, now_s)
        self.fault = barred or self._refusal(now_s)
        self._tell()
        if peer is None or not (self._is_rover or self._sticks):
            return []
        asked = self.parameters.ask(peer, now_s)
        out = [] if asked is None else [asked]
        if self._sticks is None:
            return out
        if is_heard and not barred:
            out += self._requests(peer, now_s)
        is_others = self._is_armed and self.state in (State.IDLE, State.LEFT) and now_s > self._disarm_until_s
        if is_others:
            self._neutral_s = math.inf
        elif now_s - self._override_s >= OVERRIDE_S - 1e-6:
            self._override_s, self._neutral_s = now_s, min(self._neutral_s, now_s)
            out.append(self._override(peer, *self._sticks))
        return out

    @property
    def _is_rover(self) -> bool:
        beat = self._heartbeat
        return (
            beat is not None
            and beat.autopilot == dialect.MAV_AUTOPILOT_ARDUPILOTMEGA
            and beat.type in _ROVERS
        )

    def _barred(self, peer: Address | None, is_heard: bool) -> str:
        """What keeps it from driving at all."""
        if peer is None:
            return "not heard yet"
        if not is_heard:
            self._heartbeat, self._is_ready = None, False  # it may have rebooted meanwhile
            return "is silent"
        if self._heartbeat is None:
            return "has not told its state yet"
        if not self._is_rover:
            return "is not ArduPilot Rover, which alone drives motors"
        if not self.parameters.is_complete:
            self._sticks = None
            return "its parameters are being read"
        if faults := self.parameters.faults():
            return faults[0]
        self._sticks = sticks(self.parameters.values)
        return ""

    def _follow(self, is_fit: bool, now_s: float) -> None:
        """The next state."""
        is_up = is_fit and self._is_armed and self._is_manual
        is_obeyed = self._has_sticks and now_s - self._echo_s <= _ECHO_S
        if not self.may_drive:
            if self.state in (State.RAISING, State.DRIVING):
                self._disarm_until_s, self._request_s = now_s + _DISARMING_S, -math.inf
            self.state = State.IDLE
            self._has_driven = self._gave_up = False
        elif is_up and is_obeyed:
            self.state, self._has_driven = State.DRIVING, True
        elif self.state is State.DRIVING and is_fit and not (is_up or self._is_critical):
            self.state, self._raising_s = State.LEFT, now_s
        elif self.state in (State.IDLE, State.DRIVING):
            self.state, self._raising_s = State.RAISING, now_s
        elif self.state is State.LEFT and (is_up or not is_fit):
            self.state = State.RAISING
        if self.state in (State.RAISING, State.LEFT):
            patience_s = self._resume_s if self._has_driven else _REFUSED_S
            self._gave_up = now_s - self._raising_s > patience_s

    @property
    def _is_critical(self) -> bool:
        return self._heartbeat is not None and self._heartbeat.system_status == dialect.MAV_STATE_CRITICAL

    def _refusal(self, now_s: float) -> str:
        """What keeps it from driving now; empty once it drives, or is ready to be armed."""
        words = self._words if now_s - self._words_s <= _WORDS_S else ""
        if self.state is State.DRIVING or (self.state is State.IDLE and (self._is_ready or self._is_armed)):
            return ""
        if self.state is State.LEFT:
            return "was disarmed" if self._is_manual else "has left MANUAL"
        if self._is_armed and self._is_manual:
            return "ignores the boat's channels"
        return words or "is not ready to arm"

    def _tell(self) -> None:
        """The loss of driving motors, and their return."""
        is_lost = self._has_driven and self.state is not State.DRIVING
        if is_lost and not self._is_told:
            self.texts.append(StatusText(Severity.CRITICAL, f"Motors off: autopilot {self.fault}"))
        elif self._is_told and self.state is State.DRIVING:
            self.texts.append(StatusText(Severity.WARNING, "Autopilot drives the motors again"))
        self._is_told = is_lost

    def _requests(self, peer: Address, now_s: float) -> list[Message]:
        """For MANUAL and arming, or for disarming."""
        is_disarming = self._is_armed and now_s <= self._disarm_until_s and self.state is State.IDLE
        is_raising = self.state is State.RAISING and (self._is_ready or not self._has_driven)
        if not (is_disarming or is_raising or self._is_ready) and now_s - self._why_s >= _WHY_S:
            self._why_s = now_s
            return [command(peer, dialect.MAV_CMD_RUN_PREARM_CHECKS)]
        if not (is_disarming or is_raising) or now_s - self._request_s < _AGAIN_S:
            return []
        self._request_s = now_s
        if is_disarming:
            return [command(peer, dialect.MAV_CMD_COMPONENT_ARM_DISARM, 0.0, _FORCE)]
        if not self._is_manual:
            own_mode = float(dialect.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED)
            return [command(peer, dialect.MAV_CMD_DO_SET_MODE, own_mode, float(_MANUAL))]
        if not self._is_armed and now_s - self._neutral_s >= _SETTLED_S:
            return [command(peer, dialect.MAV_CMD_COMPONENT_ARM_DISARM, 1.0)]
        return []

    def _override(self, peer: Address, steering: Stick, throttle: Stick) -> Message:
        turn = ahead = 0.0
        if self.state is State.DRIVING:
            left, right = self._drive
            turn, ahead = (self._rudder, left) if self.has_rudder else pair_shares(left, right)
        pulses = {steering.channel: steering.pulse_us(turn), throttle.channel: throttle.pulse_us(ahead)}
        self._sent.append((pulses[steering.channel], pulses[throttle.channel]))
        channels = {f"chan{n}_raw": pulses.get(n, ignored) for n, ignored in enumerate(_IGNORED, 1)}
        return build_message(
            "RC_CHANNELS_OVERRIDE", target_system=peer.system, target_component=peer.component, **channels
        )


def command(peer: Address, number: int, *params: float) -> Message:
    values = {f"param{index}": value for index, value in enumerate(params, 1)}
    return build_message(
        "COMMAND_LONG", target_system=peer.system, target_component=peer.component, command=number, **values
    )
