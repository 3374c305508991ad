"""Parts that may be missing: a boat starts without them, and each joins it once it can be opened."""

from collections.abc import Callable, Sequence
from typing import TypeVar

from companion.core.errors import HardwareError
from companion.core.readings import EscReading, GnssFix, ProbeReading, SonarReading
from companion.core.status_text import StatusText
from companion.hal.gnss.receiver import GnssReceiver
from companion.hal.interfaces import (
    PausingPart,
    PayloadOutput,
    Probe,
    PulseCounter,
    ReportingPart,
    Rudder,
    Sensor,
    Sonar,
)
from companion.hal.motors.vesc import VescMotors
from companion.hal.motors.watched_motors import WatchedMotors
from companion.links.interfaces import Closable
from companion.links.retried import Pace, Retried

Part = TypeVar("Part", bound=Closable)
Reading = TypeVar("Reading")


class RetriedPart(Retried[Part]):
    """Tells the part's own messages too."""

    _reporting: ReportingPart | None = None  # the part once it is open, if it is one
    _pausing: PausingPart | None = None

    def attempt(self) -> float:
        """Find out here what it can: an isinstance with a protocol takes as long as a filter's step."""
        wait_s, part = super().attempt(), self.opened
        self._reporting = part if isinstance(part, ReportingPart) else None
        self._pausing = part if isinstance(part, PausingPart) else None
        return wait_s

    def take_texts(self) -> list[StatusText]:
        texts = super().take_texts()
        return texts if self._reporting is None else texts + self._reporting.take_texts()


class RetriedMotors(RetriedPart[WatchedMotors]):
    """Satisfies `Motors`, `MotorCutoff` and `EscTelemetry` of `companion.hal.interfaces`. Commands before the
    opening have no effect; the boat does not arm meanwhile.
    """

    def write(self, left: float, right: float) -> None:
        if self.opened is not None:
            self.opened.write(left, right)

    def stop(self) -> None:
        if self.opened is not None:
            self.opened.stop()

    @property
    def trips(self) -> int:
        return 0 if self.opened is None else self.opened.trips

    def read(self) -> tuple[EscReading, ...] | None:
        motors = None if self.opened is None else self.opened.motors
        return motors.read() if isinstance(motors, VescMotors) else None


class RetriedRudder(RetriedPart[Rudder]):
    """Satisfies `companion.hal.interfaces.Rudder`; commands before the opening have no effect."""

    def write(self, share: float) -> None:
        if self.opened is not None:
            self.opened.write(share)


class RetriedSensor(RetriedPart[Sensor[Reading]]):
    """Satisfies `Sensor`, and `PausingPart` for a part that is one."""

    may_pause = False

    def read(self) -> Reading | None:
        part = self.opened
        if part is None:
            return None
        if self._pausing is not None:
            self._pausing.may_pause = self.may_pause
        return part.read()


class RetriedGnss(RetriedSensor[GnssFix]):
    """Satisfies `Gnss` and `CorrectionInput`."""

    def inject(self, data: bytes) -> bool:
        return isinstance(self.opened, GnssReceiver) and self.opened.inject(data)


class RetriedSonar(RetriedPart[Sonar]):
    """Satisfies `companion.hal.interfaces.Sonar`; has no pings before the opening."""

    _sector: tuple[float, float] | None = None  # that the part has not been told yet

    def read(self) -> Sequence[SonarReading]:
        if self.opened is None:
            return ()
        if self._sector is not None:
            self.opened.set_sector(*self._sector)
            self._sector = None
        return self.opened.read()

    def set_sector(self, port_rad: float, starboard_rad: float) -> None:
        """Sweep between these bearings from the next reading on."""
        self._sector = port_rad, starboard_rad


class _Probes:
    def __init__(self, probes: Sequence[Probe]) -> None:
        self.probes = probes

    def close(self) -> None:
        for probe in self.probes:
            probe.close()


class RetriedProbeGroup(Retried[_Probes]):
    """Probes that open together: those of one line."""

    def __init__(self, name: str, open_it: Callable[[], Sequence[Probe]], pace: Pace) -> None:
        super().__init__(name, lambda: _Probes(open_it()), pace)


class RetriedProbe:
    """Satisfies `companion.hal.interfaces.Probe`: one of a group."""

    def __init__(self, group: RetriedProbeGroup, index: int) -> None:
        self.close = group.close
        self._group = group
        self._index = index

    @property
    def is_open(self) -> bool:
        """Whether the group is."""
        return self._group.is_open

    def read(self) -> ProbeReading | None:
        group = self._group.opened
        return None if group is None else group.probes[self._index].read()


class CountedOutput:
    """A payload's output with the counter of its way, if it has one."""

    def __init__(self, output: PayloadOutput, counter: PulseCounter | None) -> None:
        self.output = output
        self.counter = counter

    def close(self) -> None:
        self.output.close()
        if self.counter is not None:
            self.counter.close()


class RetriedOutput(Retried[CountedOutput]):
    """Satisfies `PayloadOutput` and `PulseCounter` of `companion.hal.interfaces`."""

    def write(self, value: float) -> None:
        """Set it. Raises HardwareError: it is not open, or does not answer."""
        if self.opened is None:
            raise HardwareError(f"{self.name}: {self.fault}")
        self.opened.output.write(value)

    @property
    def count(self) -> int:
        counter = None if self.opened is None else self.opened.counter
        return 0 if counter is None else counter.count
