"""The boat's payload: carries out actions and safe states, tick by tick.

Theory of operation. Each table of the configuration is a unit: an output with its plan of timed writes, or
a program of the owner's. An action becomes a plan; a new one on the same unit replaces it. Safe states are
plans, too: at the start, at disarming, and at the loss of the operator. Those for the end of the program are
written by the outputs when they close.
"""

import math
from collections.abc import Iterable, Iterator
from typing import NamedTuple

from companion.config.payload import (
    CommandPayload,
    GripperPayload,
    PayloadSetting,
    RelayPayload,
    ServoPayload,
    WinchPayload,
)
from companion.core.status_text import Severity, StatusText
from companion.hal.interfaces import OwnersProgram, PayloadParts
from companion.payload.actions import (
    MoveGripper,
    MoveWinch,
    RepeatRelay,
    RepeatServo,
    RunCommand,
    SetLights,
    SetRelay,
    SetServo,
    UnitAction,
    WinchMotion,
)
from companion.payload.actuator import Actuator, TimedWrite, Winch, alternate
from companion.payload.fitted import addresses

_ON, _OFF = 1.0, 0.0
_KEEP = "keep"


class Written(NamedTuple):
    """A value that an output has been given."""

    title: str
    value: float


class Unit(NamedTuple):
    """A payload with its output."""

    setting: PayloadSetting
    actuator: Actuator


class OwnerCommand(NamedTuple):
    """A program of the owner's."""

    setting: CommandPayload
    program: OwnersProgram


class Payloads:
    """The opened units and commands, which carry out actions."""

    def __init__(self, settings: Iterable[PayloadSetting] = (), parts: PayloadParts | None = None) -> None:
        parts = parts or PayloadParts()
        self.units: list[Unit] = []
        self.commands: list[OwnerCommand] = []
        for index, setting in enumerate(settings):
            if isinstance(setting, CommandPayload):
                self.commands.append(OwnerCommand(setting, parts.programs[index]))
            elif isinstance(setting, WinchPayload):
                winch = Winch(setting, parts.outputs[index], parts.counters.get(index))
                self.units.append(Unit(setting, winch))
            else:
                max_on_s = setting.max_on_s if isinstance(setting, RelayPayload) else 0.0
                self.units.append(Unit(setting, Actuator(parts.outputs[index], max_on_s)))
        self._values = [math.nan] * len(self.units)  # as last reported
        self._faults = [""] * len(self.units)
        self._status_texts: list[StatusText] = []
        self._written: list[Written] = []
        self._has_started = self._was_armed = self._was_lost = False

    def perform(self, action: UnitAction, now_s: float) -> str:
        """Begin an action that `FittedPayload` has accepted. Returns why it cannot be done now, or empty."""
        if isinstance(action, RunCommand):
            return self._run(action)
        for setting, actuator in self.units:
            if not addresses(action, setting):
                continue
            if isinstance(actuator, Winch) and isinstance(action, MoveWinch):
                actuator.move(action, now_s)
            else:
                actuator.run(_plan(setting, actuator.value, action), now_s)
            self._notify(Severity.INFO, f"{_capital(setting.title)}: {_told(action)}")
        self._note_writes()
        return ""

    def tick(self, now_s: float, *, is_armed: bool, is_operator_lost: bool) -> None:
        """Go on with all plans, and enter safe states."""
        if not self._has_started:
            self._has_started = True
            self._enter("start", now_s)
        if self._was_armed and not is_armed:
            self._enter("on_disarm", now_s)
        if is_operator_lost and not self._was_lost:
            self._enter("on_link_loss", now_s)
        self._was_armed, self._was_lost = is_armed, is_operator_lost
        for unit in self.units:
            unit.actuator.tick(now_s)
            if isinstance(unit.actuator, Winch) and unit.actuator.stall_text:
                self._notify(Severity.WARNING, f"{_capital(unit.setting.title)}: {unit.actuator.stall_text}")
                unit.actuator.stall_text = ""
        self._note_writes()
        for command in self.commands:
            if (end := command.program.poll()) is not None:
                severity = Severity.WARNING if end else Severity.INFO
                self._notify(severity, f"{_capital(command.setting.title)}: {end or 'done'}")

    def take_status_texts(self) -> list[StatusText]:
        """Messages since the last call."""
        status_texts, self._status_texts = self._status_texts, []
        return status_texts

    def take_written(self) -> list[Written]:
        """Values written since the last call."""
        written, self._written = self._written, []
        return written

    # For telemetry

    def servo_us(self) -> Iterator[tuple[int, int]]:
        """Servo channels and their pulse widths."""
        for setting, actuator in self.units:
            if isinstance(setting, ServoPayload):
                yield setting.number, 0 if math.isnan(actuator.value) else round(actuator.value)

    def relays(self) -> tuple[int, int]:
        """Bits of the relays that are on, and of those that exist."""
        is_on = exists = 0
        for setting, actuator in self.units:
            if isinstance(setting, RelayPayload):
                exists |= 1 << setting.number
                is_on |= (actuator.value == _ON) << setting.number
        return is_on, exists

    @property
    def winch(self) -> Winch | None:
        """The first winch, None without."""
        return next((one.actuator for one in self.units if isinstance(one.actuator, Winch)), None)

    def _run(self, action: RunCommand) -> str:
        for setting, program in self.commands:
            if setting.number == action.number:
                if program.is_running:
                    return f"{setting.title}: still running"
                program.start()
                self._notify(Severity.INFO, f"{_capital(setting.title)}: started")
        return ""

    def _enter(self, moment: str, now_s: float) -> None:
        """Enter the safe states of a moment."""
        for setting, actuator in self.units:
            if isinstance(actuator, Winch):
                actuator.stop(now_s)
            elif (value := _safe_value(setting, getattr(setting, moment))) is not None:
                actuator.run([TimedWrite(value)], now_s)

    def _note_writes(self) -> None:
        """Compare all outputs with what was reported."""
        for index, (setting, actuator) in enumerate(self.units):
            if actuator.value != self._values[index] and not math.isnan(actuator.value):
                self._values[index] = actuator.value
                self._written.append(Written(setting.title, actuator.value))
            if actuator.fault != self._faults[index]:
                if not (self._faults[index] and actuator.fault):
                    severity = Severity.ERROR if actuator.fault else Severity.NOTICE
                    what = actuator.fault or "answers again"
                    self._notify(severity, f"{_capital(setting.title)}: {what}")
                self._faults[index] = actuator.fault

    def _notify(self, severity: int, text: str) -> None:
        self._status_texts.append(StatusText(severity, text))


def _plan(setting: PayloadSetting, value: float, action: UnitAction) -> Iterable[TimedWrite]:
    """The writes of an action. value: the present one."""
    match action:
        case SetServo(_, width_us):
            return [TimedWrite(width_us)]
        case RepeatServo(_, width_us, count, period_s) if isinstance(setting, ServoPayload):
            return alternate(width_us, setting.signal.trim_us, count, period_s)
        case SetRelay(_, is_on) | SetLights(is_on):
            return [TimedWrite(_ON if is_on else _OFF)]
        case RepeatRelay(_, count, period_s):
            was = _ON if value == _ON else _OFF
            return alternate(_ON - was, was, count, period_s)
        case MoveGripper(_, closes):
            value = _safe_value(setting, "closed" if closes else "open") or _OFF
            return [TimedWrite(value)]
    return ()


def _safe_value(setting: PayloadSetting, state: str | int) -> float | None:
    """A configured state as a value of the output; None to keep the present one."""
    if isinstance(state, int):
        return float(state)
    if state == _KEEP:
        return None
    if isinstance(setting, GripperPayload):
        if setting.pin is not None:
            return _ON if state == "closed" else _OFF
        return float(setting.closed_us if state == "closed" else setting.open_us)
    return _ON if state == "on" else _OFF


def _told(action: UnitAction) -> str:
    """An action for the operator."""
    match action:
        case SetServo(_, width_us):
            return f"{width_us} us"
        case RepeatServo(_, width_us, count, period_s):
            return f"{width_us} us, {count} times, every {period_s:g} s"
        case SetRelay(_, is_on) | SetLights(is_on):
            return "on" if is_on else "off"
        case RepeatRelay(_, count, period_s):
            return f"{count} times, every {period_s:g} s"
        case MoveGripper(_, closes):
            return "closed" if closes else "open"
        case MoveWinch(_, WinchMotion.LENGTH, length_m):
            return f"{'out' if length_m >= 0.0 else 'in'} {abs(length_m):g} m"
        case MoveWinch(_, WinchMotion.RATE, _, rate_m_s):
            return f"{rate_m_s:g} m/s"
        case MoveWinch(_, motion):
            return motion.name.lower()
        case RunCommand():
            return "started"


def _capital(title: str) -> str:
    return title[:1].upper() + title[1:]
