"""Hardware interfaces of the boat, as small Protocols.

The drivers in this folder and the emulator satisfy them; a composition root passes them to `Boat`. No call
blocks: a driver that must wait keeps a thread and returns the latest reading, stamped with the boat's clock.
"""

from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field, fields
from typing import Any, Protocol, TypeVar, runtime_checkable

from companion.config.parameters import ParameterHook
from companion.core import readings
from companion.core.status_text import StatusText
from companion.links.interfaces import Closable
from companion.links.retried import Retried
from companion.mavlink.address import Address
from companion.mavlink.dialect import Message
from companion.sensors.compass.magnetic_field import FieldCorrector


class PayloadOutput(Closable, Protocol):
    """One output of the payload. Closing sets the state for the end of the program first."""

    def write(self, value: float) -> None:
        """Set it. A servo: pulse width in µs, 0 without pulses. A pin: 1 on, 0 off. A winch: share of full
        speed, positive out. Never blocks. Raises HardwareError: the output does not answer.
        """


class PulseCounter(Closable, Protocol):
    """Counts the pulses of a switch, such as a winch's."""

    @property
    def count(self) -> int:
        """Pulses since it was opened."""


class OwnersProgram(Closable, Protocol):
    """A program outside the boat's own, which is started by it, and ended and awaited when closed."""

    def start(self) -> str:
        """Start it; no effect while it runs. Never blocks.

        Returns the path of the file that it makes; empty if none.
        """

    def poll(self) -> str | None:
        """How a run has ended, told once: empty if well, otherwise what went wrong."""

    @property
    def is_running(self) -> bool:
        """Whether a run has not ended yet."""

    def end(self) -> None:
        """Begin to end it, without waiting."""


class Capture(OwnersProgram, Protocol):
    """A program that takes an image."""

    def space_mb(self) -> tuple[float, float]:
        """Size of the medium and free space on it, 0 and 0 if unknown, as last measured."""


@dataclass(frozen=True, slots=True)
class PayloadParts:
    """The opened payload, by the index of its `[[payload]]` table. capture: takes an image."""

    outputs: Mapping[int, PayloadOutput] = field(default_factory=dict)
    counters: Mapping[int, PulseCounter] = field(default_factory=dict)
    programs: Mapping[int, OwnersProgram] = field(default_factory=dict)
    capture: Capture | None = None

    def close(self) -> None:
        """Release all of them, even if one raises. May be called twice."""
        with ExitStack() as rest:
            parts: list[Closable] = [*self.outputs.values(), *self.counters.values()]
            for part in (*parts, *self.programs.values()):
                rest.callback(part.close)
            if self.capture is not None:
                rest.callback(self.capture.close)
            for program in self.programs.values():
                program.end()


Reading_co = TypeVar("Reading_co", covariant=True)


class Motors(Closable, Protocol):
    """Two thrusters, stopped when closed. Values are shares of full drive, −1 (astern) to 1 (ahead)."""

    def write(self, left: float, right: float) -> None:
        """Drive both motors; a non-finite value stops both."""

    def stop(self) -> None:
        """Stop both motors now."""


class Rudder(Closable, Protocol):
    """A rudder, set by a servo."""

    def write(self, share: float) -> None:
        """Turn to a share of the full angle, −1 to 1, positive to starboard; centred if it is not finite."""


class PulseOutput(Closable, Protocol):
    """The signal of one servo or ESC; without pulses once closed."""

    def write_us(self, width_us: float) -> None:
        """Send pulses of this width, limited to the part's range; one that is not finite is its trim."""

    def off(self) -> None:
        """Send no more pulses until the next width."""


class ArmedOutputs(Closable, Protocol):
    """Motors and rudder behind another program's arming. fault: why they cannot be driven, or empty."""

    @property
    def fault(self) -> str: ...

    def allow(self, *, may_drive: bool) -> None:
        """Arm or disarm them, as the boat is. Called every tick."""


class MavlinkPart(Closable, Protocol):
    """A part with a MAVLink line of its own that stations may use."""

    @property
    def is_heard(self) -> bool:
        """Whether it is not silent."""

    def send(self, message: Message, sender: Address) -> None:
        """Pass on a station's message, with the part as its target. Dropped where there is no room."""

    def take_messages(self) -> list[Message]:
        """What it has sent since the last call, oldest first."""


class MotorCutoff(Protocol):
    """Stops motors without a recent command, independently of the control loop."""

    @property
    def trips(self) -> int:
        """How often the motors were cut off."""


class Sensor(Closable, Protocol[Reading_co]):
    """A part that measures."""

    def read(self) -> Reading_co | None:
        """The latest reading, repeated until a new one arrives; None before the first."""


class CorrectionInput(Protocol):
    """A GNSS receiver that takes differential corrections."""

    def inject(self, data: bytes) -> bool:
        """Send a whole RTCM 3 frame to the receiver; False if its line is busy."""


@runtime_checkable
class ReportingPart(Protocol):
    """A part with messages to the operator, such as a failed set-up or a lost antenna."""

    def take_texts(self) -> list[StatusText]:
        """The messages since the last call, oldest first."""


@runtime_checkable
class PausingPart(Protocol):
    """A part that wants to miss some readings, to save its calibration. may_pause: it may do so now."""

    may_pause: bool


Gnss = Sensor[readings.GnssFix]
Compass = Sensor[readings.HeadingReading]
Battery = Sensor[readings.BatteryReading]
Hull = Sensor[readings.HullReading]
DepthSounder = Sensor[readings.DepthReading]
Ais = Sensor[readings.AisReading]
Probe = Sensor[readings.ProbeReading]
EscTelemetry = Sensor[tuple[readings.EscReading, ...]]
RcReceiver = Sensor[readings.RcReading]
"""A reading is stamped with the arrival of its frame."""


class Sonar(Closable, Protocol):
    """A ranger, swept or fixed, or a scanning lidar."""

    def read(self) -> Sequence[readings.SonarReading]:
        """The pings since the last call, oldest first."""

    def set_sector(self, port_rad: float, starboard_rad: float) -> None:
        """Sweep between these bearings from the bow, as far as the part reaches; no effect on a fixed one."""


class FaultInjector(Protocol):
    """Hardware that can be made to fail for tests."""

    def inject(self, unit: int, failure: int, instance: int) -> str | None:
        """Make a part fail, or recover with failure 0; the numbers are MAVLink's FAILURE_UNIT and
        FAILURE_TYPE, instance 0 is all of a kind. Returns what was done, or None if not possible.
        """


@dataclass(frozen=True, slots=True)
class Hardware:
    """All hardware of a boat. Motors, GNSS receiver and compass are needed, the rest is optional.

    faults and parameter_hooks are for emulated hardware: fault injection, and additional parameters. retried:
    the parts, of all kinds, that are opened once they answer.
    """

    motors: Motors
    gnss: Gnss
    compass: Compass
    sonar: Sonar | None = None
    battery: Battery | None = None
    faults: FaultInjector | None = None
    parameter_hooks: tuple[ParameterHook, ...] = ()
    hull: Hull | None = None
    rc: RcReceiver | None = None
    cutoff: MotorCutoff | None = None
    rudder: Rudder | None = None
    depth: DepthSounder | None = None
    ais: Ais | None = None
    lidar: Sonar | None = None
    probes: tuple[Probe, ...] = ()  # in the order of the configuration
    escs: tuple[EscTelemetry, ...] = ()  # a line each, the left one first
    field: FieldCorrector | None = None  # of the compass, if it is a bare magnetometer
    payload: PayloadParts | None = None
    corrections: CorrectionInput | None = None
    outputs: ArmedOutputs | None = None  # what arms motors and rudder besides the boat
    autopilot: MavlinkPart | None = None  # that stations may reach
    retried: tuple[Retried[Any], ...] = ()

    @property
    def reporting_parts(self) -> list[ReportingPart]:
        """The parts with messages to the operator."""
        parts = (*(getattr(self, field.name) for field in fields(self)), *self.retried)
        return list(dict.fromkeys(part for part in parts if isinstance(part, ReportingPart)))

    @property
    def output_fault(self) -> str:
        """Why motors or rudder cannot be driven; empty if they can."""
        parts: tuple[object, ...] = (self.motors, self.rudder)
        closed = next((one.fault for one in parts if isinstance(one, Retried) and one.fault), "")
        return closed or (self.outputs.fault if self.outputs is not None else "")

    def close(self) -> None:
        """Stop the motors, then release all parts, even if one raises."""
        with ExitStack() as rest:
            names = dict.fromkeys(("motors", "rudder", *(one.name for one in fields(self))))
            for part in reversed([*(getattr(self, name) for name in names), *self.probes, *self.escs]):
                if isinstance(part, Closable):
                    rest.callback(part.close)  # called in reverse order
