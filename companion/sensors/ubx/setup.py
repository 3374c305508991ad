"""Finds a u-blox receiver's baud rate, configures it, and starts over when it falls silent. No I/O.

    SEARCH ── MON-VER ──► PORT (legacy) ──► BAUD ── MON-VER at the new rate ──► STEPS ──► RUNNING
      ▲  └─ sentences, but no answer ──► LISTENING                                          │
      └────────────────────────────── silence ─────────────────────────────────────────────┘

A receiver without a connected RX pin never answers: what it sends is then used as it is (LISTENING).
"""

import math
from enum import Enum
from typing import Final

from companion.core.status_text import Severity, StatusText
from companion.sensors.ubx.configuration import (
    KEYS_FROM,
    PVT_FROM,
    UART1,
    UART2,
    USB,
    BaudSearch,
    Interface,
    LinePort,
    UbxStep,
    line_port,
    port_step,
    rate_on_line,
    steps,
    value_step,
)
from companion.sensors.ubx.frames import ACK_ACK, ACK_NAK, CFG_PRT, MON_VER, NAV_PVT, UbxFrame, encode
from companion.sensors.ubx.messages import Version, version

_POLL_S: Final = 0.5
_DWELL_S: Final = 1.2  # at each rate: a receiver sends at least once a second
# An answer waits behind the NMEA output of at most 1 s, which a crowded line at 9600 baud sends in 2 s.
_ANSWER_S: Final = 4.0
_ASK_AGAIN_S: Final = 30.0  # while listening
_SETTLE_S: Final = 0.3  # from the command to the new baud rate; its 37 bytes take 0.1 s at 4800 baud
_VERIFY_S: Final = 2.5
_MOST_BAUD_FAILURES: Final = 2  # the first one may have been a power dip
_ACK_S: Final = 1.0  # UBX-CFG messages are acknowledged within one second (UBX-13003221, section 32.10)
_TRIES: Final = 3
_SILENT_S: Final = 2.0  # without output,
_SILENT_PERIODS: Final = 5.0  # or for this many periods
_REPEAT_S: Final = 60.0  # of the same message to the operator


class Phase(Enum):
    """What the set-up is doing."""

    SEARCH = "search"
    PORT = "port"
    BAUD = "baud rate"
    STEPS = "steps"
    RUNNING = "running"
    LISTENING = "listening"


class UbxSetup:
    """phase; baud: the rate to which the line must be set, None where it has none; version: None before."""

    def __init__(
        self, target_baud: int | None, rate_hz: float, *, wants_baseline: bool = False, is_usb: bool = False
    ) -> None:
        """target_baud: None for a line without a baud rate. is_usb: the receiver's own USB port."""
        self.phase = Phase.SEARCH
        self.baud = target_baud
        self.version: Version | None = None
        self._target_baud, self._wants_baseline = target_baud, wants_baseline
        self._wanted_hz = self._rate_hz = rate_hz
        self._interfaces = (USB, UART1, UART2) if is_usb else (UART1, USB, UART2)
        self._interface = self._good_interface = self._interfaces_tried = 0
        self._search_rates = BaudSearch(target_baud, target_baud)
        self._since_s = self._sent_s = self._heard_s = self._output_s = -math.inf
        self._tries = 0
        self._port: LinePort | None = None
        self._steps: list[UbxStep] = []
        self._was_running = False
        self._baud_failures = 0
        self._told_s: dict[str, float] = {}
        self._outbox: list[bytes] = []
        self._texts: list[StatusText] = []

    def take_outbox(self) -> list[bytes]:
        """Frames to send since the last call."""
        taken, self._outbox = self._outbox, []
        return taken

    def take_texts(self) -> list[StatusText]:
        taken, self._texts = self._texts, []
        return taken

    @property
    def may_inject(self) -> bool:
        """Whether the line is at the receiver's baud rate and free for corrections."""
        return self.phase in (Phase.RUNNING, Phase.LISTENING)

    def tick(self, now_s: float) -> None:
        """Polls, time-outs and repetitions."""
        match self.phase:
            case Phase.SEARCH:
                self._search(now_s)
            case Phase.PORT:
                self._repeat(now_s, encode(CFG_PRT))
            case Phase.BAUD:
                self._verify_baud(now_s)
            case Phase.STEPS:
                self._repeat(now_s, self._steps[0].frame)
            case Phase.RUNNING:
                self._watch(now_s)
            case Phase.LISTENING:
                if now_s - self._heard_s > _ANSWER_S:
                    self.restart(now_s)
                elif now_s - self._sent_s >= _ASK_AGAIN_S:
                    self._poll_version(now_s)

    def on_sentence(self, now_s: float) -> None:
        """A valid NMEA sentence has arrived."""
        self._heard_s = now_s
        if self._protocol < PVT_FROM:
            self._on_output(now_s)

    def on_frame(self, frame: UbxFrame, now_s: float) -> None:
        """A frame has arrived."""
        self._heard_s = now_s
        if frame.kind == NAV_PVT:
            self._on_output(now_s)
        elif frame.kind == MON_VER:
            self._on_version(version(frame.payload), now_s)
        elif frame.kind == CFG_PRT and self.phase is Phase.PORT:
            self._on_port(frame.payload, now_s)
        elif frame.kind in (ACK_ACK, ACK_NAK) and self.phase is Phase.STEPS:
            self._on_acknowledgement(frame, now_s)

    def _search(self, now_s: float) -> None:
        if self._since_s == -math.inf:
            self._search_rates = BaudSearch(self.baud, self._target_baud)
            self._since_s = now_s
        elif self._heard_s >= self._since_s:
            if now_s - self._since_s >= _ANSWER_S:
                self._listen(now_s, "does not answer")
                return
        elif now_s - self._since_s >= _DWELL_S:
            self.baud = self._search_rates.next()
            if self._search_rates.is_round:
                self._tell(now_s, Severity.WARNING, "GNSS: silent at every baud rate, check wiring")
            self._since_s = now_s
        if now_s - self._sent_s >= _POLL_S or self._sent_s < self._since_s:
            self._poll_version(now_s)

    def _poll_version(self, now_s: float) -> None:
        self._outbox.append(encode(MON_VER))
        self._sent_s = now_s

    def _on_version(self, found: Version, now_s: float) -> None:
        if self.phase is Phase.BAUD:
            if self.baud == self._target_baud:
                self._begin_steps(now_s)
            return
        if self.phase not in (Phase.SEARCH, Phase.LISTENING):
            return
        self.version = found
        self._interface, self._interfaces_tried = self._good_interface, 0
        if found.protocol < KEYS_FROM:
            self._enter(Phase.PORT, now_s)
        elif (key := self._current_interface.baud) is not None and (baud := self._other_baud) is not None:
            self._change_baud(value_step("baud rate", {key: baud}), now_s)
        else:
            self._begin_steps(now_s)

    @property
    def _current_interface(self) -> Interface:
        return self._interfaces[self._interface]

    @property
    def _other_baud(self) -> int | None:
        """The baud rate to change to; None to keep the present one."""
        is_wanted = self.baud != self._target_baud and self._baud_failures < _MOST_BAUD_FAILURES
        return self._target_baud if is_wanted else None

    @property
    def _protocol(self) -> float:
        return 0.0 if self.version is None else self.version.protocol

    def _on_port(self, payload: bytes, now_s: float) -> None:
        port = self._port = line_port(payload)
        if port is None:
            return
        if port.is_uart and (baud := self._other_baud) is not None:
            self._change_baud(port_step(port, baud, self._protocol), now_s)
        else:
            self._begin_steps(now_s)

    def _change_baud(self, step: UbxStep, now_s: float) -> None:
        self._outbox.append(step.frame)
        self._enter(Phase.BAUD, now_s)

    def _verify_baud(self, now_s: float) -> None:
        if now_s - self._since_s < _SETTLE_S:
            return
        if self.baud != self._target_baud:
            self.baud = self._target_baud
            self._poll_version(now_s)
        elif now_s - self._since_s >= _VERIFY_S:
            self._tell(now_s, Severity.WARNING, f"GNSS: receiver silent at {self.baud} baud")
            self._baud_failures += 1
            self.restart(now_s)
        elif now_s - self._sent_s >= _POLL_S:
            self._poll_version(now_s)

    def _begin_steps(self, now_s: float) -> None:
        protocol, wants_baseline = self._protocol, self._wants_baseline
        self._rate_hz = rate_on_line(self._wanted_hz, self.baud, protocol, wants_baseline)
        self._steps = steps(protocol, self._current_interface, self._rate_hz, wants_baseline)
        if (port := self._port) is not None and protocol < KEYS_FROM:
            baud = port.baud if self.baud is None else self.baud
            self._steps.insert(0, port_step(port, baud, protocol))
            if protocol >= PVT_FROM:
                self._steps.append(port_step(port, baud, protocol, ends_nmea=True))
        self._enter(Phase.STEPS, now_s)

    def _repeat(self, now_s: float, frame: bytes) -> None:
        """Send a frame until it is answered, then give up."""
        if now_s - self._sent_s < _ACK_S and self._tries:
            return
        if self._tries < _TRIES:
            self._tries += 1
            self._sent_s = now_s
            self._outbox.append(frame)
        elif self.phase is Phase.PORT:
            self._begin_steps(now_s)
        else:
            self._tell(now_s, Severity.WARNING, f"GNSS: no acknowledgement: {self._steps[0].what}")
            if now_s - self._heard_s > _SILENT_S:
                self.restart(now_s)
            else:
                self._next_step(now_s, is_set=False)

    def _on_acknowledgement(self, frame: UbxFrame, now_s: float) -> None:
        step = self._steps[0]
        if frame.payload != step.kind.to_bytes(2, "big") or not self._tries:
            return
        is_refused = frame.kind == ACK_NAK
        if is_refused and step.is_required:
            self._tell(now_s, Severity.WARNING, f"GNSS: receiver refused: {step.what}")
        self._next_step(now_s, is_set=not is_refused)

    def _next_step(self, now_s: float, is_set: bool) -> None:
        step = self._steps.pop(0)
        self._tries = 0
        if step.is_required and not is_set:
            self._steps = [one for one in self._steps if not one.ends_nmea]
        if not self._steps:
            self._run(now_s)

    def _run(self, now_s: float) -> None:
        self._enter(Phase.RUNNING, now_s)
        self._output_s = -math.inf

    def _on_output(self, now_s: float) -> None:
        if self.phase is Phase.RUNNING and self._output_s == -math.inf and self.version is not None:
            again = " again" if self._was_running else ""
            line = "" if self.baud is None else f", {self.baud} baud"
            text = f"GNSS: {self.version.module} set up{again}: {self._rate_hz:g} Hz{line}"
            self._texts.append(StatusText(Severity.INFO, text))
            self._was_running = True
            self._good_interface, self._baud_failures = self._interface, 0
            self._told_s.clear()
        self._output_s = now_s

    def _watch(self, now_s: float) -> None:
        patience_s = max(_SILENT_S, _SILENT_PERIODS / self._rate_hz)
        if now_s - max(self._output_s, self._since_s) <= patience_s:
            return
        if self._output_s > -math.inf:
            self._tell(now_s, Severity.WARNING, "GNSS: receiver silent, setting it up again")
            self.restart(now_s)
        elif self._protocol >= KEYS_FROM and self._try_next_interface():
            self._begin_steps(now_s)
        else:
            self._listen(now_s, "sends no NAV-PVT")

    def _try_next_interface(self) -> bool:
        """The line may be connected to another port of the receiver. Returns False after the last one."""
        self._interfaces_tried += 1
        self._interface = (self._interface + 1) % len(self._interfaces)
        return self._interfaces_tried < len(self._interfaces)

    def _listen(self, now_s: float, why: str) -> None:
        self._tell(now_s, Severity.WARNING, f"GNSS: receiver {why}: using its own settings")
        self._enter(Phase.LISTENING, now_s)
        self._sent_s = now_s

    def restart(self, now_s: float) -> None:
        """The receiver may have lost its settings."""
        self._enter(Phase.SEARCH, now_s)
        self._since_s = -math.inf

    def _enter(self, phase: Phase, now_s: float) -> None:
        self.phase = phase
        self._since_s, self._tries = now_s, 0

    def _tell(self, now_s: float, severity: int, text: str) -> None:
        if now_s - self._told_s.get(text, -math.inf) >= _REPEAT_S:
            self._told_s[text] = now_s
            self._texts.append(StatusText(severity, text))
