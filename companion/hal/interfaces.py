"""What the boat needs of its hardware, as small Protocols.

The real drivers beside this file and the emulator's simulated ones satisfy the same interfaces; they are
handed to `Boat` by a composition root. No call here blocks: a driver that must wait for its part keeps a
reader thread of its own and hands over the latest reading, stamped with the boat's clock.
"""

from collections.abc import Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from typing import Protocol

from companion.config.parameters import ParameterHook
from companion.sensors.readings import (
    BatteryReading,
    GnssFix,
    HeadingReading,
    HullReading,
    RcReading,
    SonarReading,
)

__all__ = [
    "Battery",
    "BatteryReading",
    "Compass",
    "FaultInjector",
    "Gnss",
    "GnssFix",
    "Hardware",
    "HeadingReading",
    "Hull",
    "HullReading",
    "Link",
    "MotorCutoff",
    "Motors",
    "Port",
    "RcReading",
    "RcReceiver",
    "Sonar",
    "SonarReading",
]


class Motors(Protocol):
    """Two thrusters. Values are shares of full drive, −1 (full astern) to 1 (full ahead)."""

    def write(self, left: float, right: float) -> None:
        """Drive both motors; a value that is not finite stops both."""

    def stop(self) -> None:
        """Cut both motors now."""

    def close(self) -> None:
        """Stop first, then let the part go. May be called twice."""


class MotorCutoff(Protocol):
    """Stops motors that have had no command for too long, whatever the boat's program does."""

    @property
    def trips(self) -> int:
        """How often it has stopped them."""


class Gnss(Protocol):
    """Position over ground."""

    def read(self) -> GnssFix | None:
        """The latest fix, None before the first; the same fix again until a new one has come."""

    def close(self) -> None:
        """Let the part go. May be called twice."""


class Compass(Protocol):
    """Heading."""

    def read(self) -> HeadingReading | None:
        """The latest reading, None before the first."""

    def close(self) -> None:
        """Let the part go. May be called twice."""


class Sonar(Protocol):
    """Ultrasonic ranger, swept or fixed."""

    def read(self) -> Sequence[SonarReading]:
        """The pings since the last call, oldest first."""

    def set_sector(self, port_rad: float, starboard_rad: float) -> None:
        """Sweep between these bearings from the bow from now on, as far as the part goes; a fixed one does
        not."""

    def close(self) -> None:
        """Let the part go. May be called twice."""


class Battery(Protocol):
    """Battery monitor."""

    def read(self) -> BatteryReading | None:
        """The latest reading, None before the first."""

    def close(self) -> None:
        """Let the part go. May be called twice."""


class Hull(Protocol):
    """What is inside the hull: water, heat."""

    def read(self) -> HullReading | None:
        """The latest reading, None before the first."""

    def close(self) -> None:
        """Let the part go. May be called twice."""


class RcReceiver(Protocol):
    """The receiver of a radio control transmitter. A reading's age is how long ago its frame has come."""

    def read(self) -> RcReading | None:
        """The latest frame, None before the first; the same one again until a new one has come."""

    def close(self) -> None:
        """Let the part go. May be called twice."""


class Link(Protocol):
    """One pipe of bytes to one station (or one radio). Never blocks, never raises once it is open.

    A datagram link hands over whole datagrams; a stream link hands over whatever has come.
    """

    @property
    def name(self) -> str:
        """For people and logs, such as `tcp:127.0.0.1:52114`."""

    @property
    def host(self) -> str:
        """The far side's numeric address, empty where there is none (a serial line, memory)."""

    @property
    def is_datagram(self) -> bool:
        """Whether one received chunk is one datagram."""

    @property
    def is_closed(self) -> bool:
        """True once the far side is gone for good; the boat then forgets the link."""

    def receive(self) -> list[bytes]:
        """All chunks that have arrived, oldest first; empty when there are none."""

    def send(self, data: bytes) -> bool:
        """Send one frame whole, or drop it whole and say False (queue full, nobody there)."""

    def fileno(self) -> int:
        """A descriptor to wait on for arriving bytes, −1 when there is none."""

    def close(self) -> None:
        """Close. May be called twice."""


class Port(Protocol):
    """Something links come out of: a listening socket, or a single device."""

    @property
    def name(self) -> str:
        """As in the configuration, such as `tcpin:0.0.0.0:5760`."""

    def accept(self) -> list[Link]:
        """Links that came into being since the last call. Never blocks, never raises."""

    def fileno(self) -> int:
        """A descriptor to wait on for new links, −1 when there is none."""

    def close(self) -> None:
        """Close, with every link that came out of it. May be called twice."""


class FaultInjector(Protocol):
    """Hardware that can be broken on purpose, to see what the boat makes of it."""

    def inject(self, unit: int, failure: int, instance: int) -> str | None:
        """Let a part fail, or be well again with failure 0; the numbers are MAVLink's FAILURE_UNIT and
        FAILURE_TYPE, instance 0 is all of a kind. What was done, in words; None if that cannot be done."""


@dataclass(frozen=True, slots=True)
class Hardware:
    """Everything a boat is built from. Sonar, battery monitor, hull sensor and RC receiver may be missing.

    faults and knobs are for hardware that is more than it seems: what can break it, and parameters that it
    brings along.
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

    def close(self) -> None:
        """Stop the motors first, then let every part go, also when one of them raises."""
        with ExitStack() as rest:
            for part in (self.rc, self.hull, self.battery, self.sonar, self.compass, self.gnss, self.motors):
                if part is not None:
                    rest.callback(part.close)  # called last in, first out
