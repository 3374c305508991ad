"""What a fault does to each part of the boat. A part has one fault at a time, or None when it is well."""

import math
from typing import Any, Protocol

from sitl.radio.channel import WHOLE, Quality
from sitl.run.simulated_hardware import SimMotors
from sitl.world.computer import Computer
from sitl.world.faults.catalogue import FaultSetting
from sitl.world.sensors import (
    SensorFault,
    SimBattery,
    SimCompass,
    SimGnss,
    SimHull,
    SimRc,
    SimSonar,
    generator,
)


class Part(Protocol):
    """Something that can fail."""

    def suffer(self, fault: FaultSetting | None, now_s: float) -> None:
        """Have this fault from now on, or none."""


class Shaft(Protocol):
    """A thruster, as far as faults reach it: the gain of its command, and how much weed hangs on it, 0..1."""

    gain: float
    weed: float


class SensorPart:
    """A sensor whose own file knows what a fault does to it."""

    def __init__(self, sensor: SimGnss | SimCompass | SimSonar | SimBattery | SimRc, seed: int) -> None:
        self._sensor: Any = sensor
        self._seed = seed

    def suffer(self, fault: FaultSetting | None, now_s: float) -> None:
        """Have this fault from now on, or none."""
        self._sensor.fault = sensor_fault(fault, now_s, self._seed)


class GyroPart:
    """The gyro that sits with the compass and fails apart from it."""

    def __init__(self, compass: SimCompass, seed: int) -> None:
        self._compass = compass
        self._seed = seed

    def suffer(self, fault: FaultSetting | None, now_s: float) -> None:
        """Have this fault from now on, or none."""
        self._compass.gyro_fault = sensor_fault(fault, now_s, self._seed)


def sensor_fault(fault: FaultSetting | None, now_s: float, seed: int) -> "SensorFault[Any] | None":
    """A fault as sensors know it, with random numbers of its own."""
    if fault is None:
        return None
    numbers = generator(seed, f"fault/{fault.what}/{fault.kind}")
    return SensorFault(fault.kind, fault.amount, math.radians(fault.towards_deg), now_s, numbers)


class LeakPart:
    """The hull's probe for water. is_wet: what it says when it is well, as a parameter may have it."""

    def __init__(self, hull: SimHull) -> None:
        self._hull = hull
        self._fault: FaultSetting | None = None
        self._is_wet = False

    def soak(self, is_wet: bool) -> None:
        """From now on there is water in the hull, or none."""
        self._is_wet = is_wet
        self._say()

    def suffer(self, fault: FaultSetting | None, now_s: float) -> None:  # noqa: ARG002
        """Have this fault from now on, or none."""
        self._fault = fault
        self._say()

    def _say(self) -> None:
        kind = "" if self._fault is None else self._fault.kind
        self._hull.is_wet = None if kind == "off" else bool(kind) or self._is_wet


class ThermometerPart:
    """The hull's thermometer, and how hot it gets in there."""

    def __init__(self, hull: SimHull) -> None:
        self._hull = hull

    def suffer(self, fault: FaultSetting | None, now_s: float) -> None:
        """Have this fault from now on, or none."""
        kind, size = ("", 0.0) if fault is None else (fault.kind, fault.amount)
        self._hull.hears_heat = kind != "off"
        self._hull.offset_c = size if kind == "wrong" else 0.0
        self._hull.warm(size / 60.0 if kind == "hot" else 0.0, now_s)


class MotorPart:
    """One motor with its propeller."""

    def __init__(self, shaft: Shaft) -> None:
        self._shaft = shaft

    def suffer(self, fault: FaultSetting | None, now_s: float) -> None:  # noqa: ARG002
        """Have this fault from now on, or none."""
        gain, weed = 1.0, 0.0
        if fault is not None:
            match fault.kind:
                case "off" | "intermittent":
                    gain = 0.0
                case "wrong" | "slow":
                    gain = fault.amount
                case _:
                    weed = fault.amount
        self._shaft.gain, self._shaft.weed = gain, weed


class ComputerPart:
    """The computer's power. Without it the motors stop; with it back, the program begins."""

    def __init__(self, computer: Computer, motors: SimMotors) -> None:
        self._computer = computer
        self._motors = motors

    def suffer(self, fault: FaultSetting | None, now_s: float) -> None:
        """Lose power, or have it again."""
        if fault is not None:
            self._computer.lose_power()
            self._motors.stop()
        elif not self._computer.has_power:
            self._computer.begin(now_s)


class CpuPart:
    """The computer's speed."""

    def __init__(self, computer: Computer) -> None:
        self._computer = computer

    def suffer(self, fault: FaultSetting | None, now_s: float) -> None:  # noqa: ARG002
        """Be too slow for the program, or fast enough."""
        self._computer.load = 0.0 if fault is None else fault.amount


class ClockPart:
    """The computer's clock. It is monotonic: it may leap ahead, and nothing sets it back but a new start."""

    def __init__(self, computer: Computer) -> None:
        self._computer = computer

    def suffer(self, fault: FaultSetting | None, now_s: float) -> None:  # noqa: ARG002
        """Leap ahead."""
        if fault is not None:
            self._computer.set_clock_offset(self._computer.clock_offset_s + fault.amount)


class DiskPart:
    """The medium that the boat stores on."""

    def __init__(self, computer: Computer) -> None:
        self._computer = computer

    def suffer(self, fault: FaultSetting | None, now_s: float) -> None:  # noqa: ARG002
        """Be full, or have room again."""
        self._computer.disk_is_full = fault is not None


class LinkPart:
    """All links of the boat at once, as one radio carries them."""

    def __init__(self, computer: Computer) -> None:
        self._computer = computer

    def suffer(self, fault: FaultSetting | None, now_s: float) -> None:  # noqa: ARG002
        """Carry as badly as the fault says, on top of what the scenario's links do."""
        quality = WHOLE
        if fault is not None:
            match fault.kind:
                case "slow":
                    quality = Quality(bandwidth_bytes_s=fault.amount)
                case "delayed":
                    quality = Quality(delay_s=fault.amount)
                case "lossy":
                    quality = Quality(loss=fault.amount)
                case _:
                    quality = Quality(loss=1.0)
        self._computer.link_quality = quality
