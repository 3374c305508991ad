"""The onboard log: from arming until a while after disarming.

A tick encodes what is due into a block in memory. Blocks go to the sink, which never waits; lost ones are
counted in the log.
"""

import logging
import struct
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import chain, islice
from typing import Final, TypeGuard, TypeVar

from companion.autopilot.snapshot import Snapshot
from companion.config.boat_config import BoatConfig
from companion.config.parameters import Parameters
from companion.core.geo import LocalFrame
from companion.core.state import NavState
from companion.core.status_text import Severity, StatusText
from companion.core.tick_count import TickCount
from companion.log import events, samples
from companion.log import records as r
from companion.log.events import EventWatch
from companion.log.samples import time_us
from companion.log.sink import Sink
from companion.mavlink.items import MissionItem
from companion.router.channels import Channels
from companion.vehicle.mission.steps import Mission
from companion.vehicle.payload_control import PayloadControl
from companion.vehicle.vehicle import Vehicle

logger = logging.getLogger(__name__)

_BLOCK_BYTES: Final = 4096
_FLUSH_S: Final = 1.0  # limit of the loss by a power cut, besides what the sink has not flushed
_BACKLOG_RECORDS: Final = 50  # parameters and items per motion sample
_LINES_BEFORE: Final = 20  # status texts from before the log
_SLACK_S: Final = 1e-6
_REPORT_HZ: Final = 5.0  # of the estimator's inside: a usual receiver's rate
_MB: Final = 1e6

TakeSnapshot = Callable[[], Snapshot]
T = TypeVar("T")


class OnboardLog:
    """Writes logs one after the other. Never raises or waits."""

    def __init__(
        self,
        sink: Sink,
        parameters: Parameters,
        items: Callable[[], Sequence[MissionItem]],
        vehicle: Vehicle,
        payload: PayloadControl | None = None,
    ) -> None:
        """items: the stored mission."""
        self.is_writing = False
        self.dropped = 0  # records not taken by the sink
        self.faults = 0  # ticks that could not be encoded: our defects, see the program's log
        self.timing: TickCount | None = None  # of the real-time loop, if any
        self._sink = sink
        self._parameters = parameters
        self._items = items
        self._vehicle = vehicle
        self._payload = payload
        self._status_texts: list[StatusText] = []
        self._early_texts: deque[tuple[int, str]] = deque(maxlen=_LINES_BEFORE)
        self._has_failed = False  # no new attempt until the next arming
        self._end_s = -1.0
        self._block: list[bytes] = []
        self._block_bytes = 0
        self._now_s = 0.0
        self._restart()

    def _restart(self) -> None:
        self._watch = EventWatch()
        self._backlog: Iterator[bytes] = iter(())
        self._due_s = self._motion_due_s = self._report_due_s = self._status_due_s = self._flush_due_s = -1.0
        self._log_bytes = self._blocks = 0
        self._config: BoatConfig | None = None
        self._mission: Mission = ()
        self._logged: dict[str, object] = {}  # the latest reading of each part
        self._late = self._ticks = 0

    def note(self, notice: StatusText) -> None:
        """Log a status text, stamped with the latest tick."""
        if self.is_writing:
            self._add(samples.text(self._now_us, notice.text))
        else:
            self._early_texts.append((self._now_us, notice.text))

    def take_status_texts(self) -> Sequence[StatusText]:
        """Messages to the operator since the last call."""
        status_texts, self._status_texts = self._status_texts, []
        return status_texts

    def tick(self, now_s: float, take_snapshot: TakeSnapshot, channels: Channels) -> None:
        """Log what is due. take_snapshot: the state of the boat, called at a tenth of the ticks or fewer."""
        try:
            self._tick(now_s, take_snapshot, channels)
        except (struct.error, OverflowError, ValueError):
            self.faults += 1
            if self.faults == 1:
                logger.exception("a log record cannot be encoded; further ones are only counted")

    @property
    def _now_us(self) -> int:
        return time_us(self._now_s)

    def close(self) -> None:
        if self.is_writing:
            self._end(0.0)

    def _tick(self, now_s: float, take_snapshot: TakeSnapshot, channels: Channels) -> None:
        setting, vehicle = self._parameters.config.log, self._vehicle
        self._now_s = now_s
        if vehicle.armed:
            self._end_s = now_s + setting.after_disarm_s
        elif now_s >= self._end_s and not setting.disarmed:
            self._has_failed = False
            if self.is_writing:
                self._end(take_snapshot().unix_s)
            return
        if not self.is_writing:
            if self._has_failed or not setting.onboard:
                return
            self._begin()
        if self._watch.has_news(vehicle):
            self._add(self._watch.changes(take_snapshot(), self._items))
        if self._payload is not None and self._payload.has_news:
            self._add(samples.payload(take_snapshot()))
        if now_s >= self._due_s:
            self._do_due(take_snapshot(), channels)

    def _do_due(self, now: Snapshot, channels: Channels) -> None:
        """Sample, continue the backlog, and write full blocks."""
        if self._sink.fault:
            self._fail(self._sink.fault)
            return
        now_s, setting = now.now_s, now.config.log
        if now_s + _SLACK_S >= self._motion_due_s:
            self._motion_due_s = _next(self._motion_due_s, now_s, setting.motion_hz)
            self._sample(now)
            self._add(islice(self._backlog, _BACKLOG_RECORDS))
        if now_s + _SLACK_S >= self._status_due_s:
            self._status_due_s = _next(self._status_due_s, now_s, setting.status_hz)
            self._add(self._status(now, channels))
        self._due_s = min(self._motion_due_s, self._status_due_s) - _SLACK_S
        if self._block_bytes >= _BLOCK_BYTES or now_s >= self._flush_due_s:
            self._hand_over(now.unix_s)
            self._flush_due_s = now_s + _FLUSH_S
            if self._log_bytes > 0.5 * setting.quota_mb * _MB:
                self._end(now.unix_s)  # the next tick begins another, so that old ones can be removed

    def _begin(self) -> None:
        self._restart()
        if not self._sink.begin():
            self._fail("the write queue is full")
            return
        self.is_writing = True
        self._block, self._block_bytes = [r.HEADER], len(r.HEADER)
        self._add(events.introduction(self._now_us))
        for us, line in self._early_texts:
            self._add(samples.text(us, line))
        self._early_texts.clear()
        self._backlog = events.parameters(self._now_us, self._parameters)

    def _end(self, unix_s: float) -> None:
        self._add(self._backlog)
        self._hand_over(unix_s)
        self._sink.end()
        self.is_writing = False

    def _fail(self, why: str) -> None:
        self.is_writing = False
        self._has_failed = True
        self._block, self._block_bytes = [], 0
        self._sink.end()
        self._status_texts.append(StatusText(Severity.WARNING, f"Log stopped: {why}"))

    def _sample(self, now: Snapshot) -> None:
        self._add(self._watch.slow_changes(now))
        self._add(samples.motion(now))
        sensors = now.sensors
        if sensors.fix is not None and self._is_new(sensors.fix.time_s, "fix"):
            self._add(samples.gnss(sensors.fix))
        if self._is_new(sensors.heading, "heading"):
            self._add((samples.heading(sensors.heading),))
        if self._is_new(sensors.sonar, "sonar"):
            self._add(samples.sonar(sensors.sonar))
        for esc in sensors.escs.readings:
            if esc is not None and self._is_new(esc.time_s, f"ESC {esc.side}"):
                self._add((samples.esc(esc),))
        if now.now_s + _SLACK_S >= self._report_due_s and (report := now.estimator.report) is not None:
            self._report_due_s = _next(self._report_due_s, now.now_s, _REPORT_HZ)
            self._add(samples.estimator(self._now_us, report, now.config.estimation.compass_gate_rad))
        if now.vehicle.nav is not None and now.vehicle.frame is not None:
            self._add(self._water(now, now.vehicle.nav, now.vehicle.frame))
        heard = now.vehicle.manual_input.rc.latest
        if self._is_new(heard, "transmitter"):
            self._add(samples.radio(heard))

    def _is_new(self, reading: T | None, part: str) -> TypeGuard[T]:
        """Whether there is a reading that is not logged yet; it then counts as logged."""
        if reading is None or reading == self._logged.get(part):
            return False
        self._logged[part] = reading
        return True

    def _water(self, now: Snapshot, nav: NavState, frame: LocalFrame) -> Iterator[bytes]:
        """New soundings and values of probes, with the position."""
        sounding = now.sensors.depth
        if self._is_new(sounding, "depth"):
            yield samples.depth(sounding, nav, frame)
        for reading in now.sensors.probes:
            if self._is_new(reading.time_s, f"probe {reading.name}"):
                yield samples.probe(reading, nav, frame)

    def _status(self, now: Snapshot, channels: Channels) -> Iterator[bytes]:
        us = self._now_us
        battery = now.sensors.battery
        if self._is_new(battery, "battery"):
            yield samples.battery(battery, now.sensors.consumed_mah, now.config.battery.capacity_mah)
        for number, channel in channels.open.items():
            counted = channel.counters
            yield r.MAV.pack(
                us, number & 0xFF, counted.frames_out & 0xFFFF, counted.frames_in & 0xFFFF,
                counted.lost + counted.bad_frames & 0xFFFF, 0, 0, channel.queue.dropped & 0xFFFF,
            )  # fmt: skip
        if (timing := self.timing) is not None:
            late, ticks = timing.late - self._late, timing.run - self._ticks
            self._late, self._ticks = timing.late, timing.run
            yield r.PM.pack(
                us, min(round(ticks * now.config.log.status_hz), 0xFFFF), late & 0xFFFF, ticks & 0xFFFF,
                min(round(timing.worst_s * 1e6), 0xFFFFFFFF), 0, round(min(now.load, 60.0) * 1e3),
                0, 0, 0, 0, 0, 0, 0,
            )  # fmt: skip
        room = min(self._sink.room_bytes, 0xFFFFFFFF)
        yield r.DSF.pack(
            us, self.dropped & 0xFFFFFFFF, self._blocks & 0xFFFF, self._log_bytes, room, room, room
        )
        self._log_changed_lists(now)

    def _log_changed_lists(self, now: Snapshot) -> None:
        """Add changed parameters or a changed mission to the backlog."""
        before, self._config = self._config, now.config
        if before is not None and before is not now.config:
            changed = events.changed_parameters(self._now_us, self._parameters, before, now.config)
            self._backlog = chain(self._backlog, tuple(changed))
        if now.vehicle.progress.mission is not self._mission:
            self._mission = now.vehicle.progress.mission
            self._backlog = chain(self._backlog, events.mission(self._now_us, self._items()))

    def _add(self, records: Iterable[bytes]) -> None:
        for record in records:
            self._block.append(record)
            self._block_bytes += len(record)

    def _hand_over(self, unix_s: float) -> None:
        block, count = b"".join(self._block), len(self._block)
        self._block, self._block_bytes = [], 0
        if not block:
            return
        if self._sink.write(block, unix_s):
            self._blocks += 1
            self._log_bytes += len(block)
        elif self._blocks == 0:
            # a log without its definitions is useless
            self._fail(self._sink.fault or "the write queue is full")
        else:
            self.dropped += count


def _next(due_s: float, now_s: float, rate_hz: float) -> float:
    """The next due time; missed samples are skipped."""
    due_s += 1.0 / rate_hz
    return due_s if due_s > now_s else now_s + 1.0 / rate_hz
