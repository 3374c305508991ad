"""What a fault does to each part of the boat.

A part is a function that applies a fault from now on, or None to end it. It has one fault at a time.
"""

import math
from collections.abc import Callable
from typing import Any, Protocol

from sitl.radio.channel import WHOLE, Quality
from sitl.world.computer import Computer
from sitl.world.drive.rudder import Rudder
from sitl.world.faults.catalogue import FaultSetting
from sitl.world.sampling import generator
from sitl.world.sensors.battery_monitor import SimBattery
from sitl.world.sensors.compass import SimCompass
from sitl.world.sensors.depth import SimDepthSounder
from sitl.world.sensors.fault import SensorFault
from sitl.world.sensors.gnss import SimGnss
from sitl.world.sensors.hull_sensor import SimHullSensor
from sitl.world.sensors.rc import SimRc
from sitl.world.sensors.sonar import SimSonar
from sitl.world.simulated_hardware import SimMotors

Part = Callable[[FaultSetting | None, float], None]
FaultySensor = SimGnss | SimCompass | SimSonar | SimBattery | SimRc | SimDepthSounder


class Shaft(Protocol):
    """The gain of a thruster's command, and the weed on its propeller, 0..1."""

    gain: float
    weed: float


def sensor_part(sensor: FaultySensor, seed: int, name: str = "fault") -> Part:
    """A sensor that simulates its faults itself, by the attribute of this name."""

    def apply(fault: FaultSetting | None, now_s: float) -> None:
        value: SensorFault[Any] | None = None
        if fault is not None:
            numbers = generator(seed, f"fault/{fault.what}/{fault.kind}")
            value = SensorFault(fault.kind, fault.amount, math.radians(fault.towards_deg), now_s, numbers)
        setattr(sensor, name, value)

    return apply


class LeakPart:
    """The water probe in the hull. It is wet by a fault or by a parameter."""

    def __init__(self, hull: SimHullSensor) -> None:
        self._hull = hull
        self._kind = ""
        self._is_wet = False

    def set_wet(self, value: float) -> None:
        """Set by the parameter: 1 is water in the hull."""
        self._is_wet = value == 1.0
        self._update()

    def __call__(self, fault: FaultSetting | None, now_s: float) -> None:  # noqa: ARG002
        """Apply a fault."""
        self._kind = "" if fault is None else fault.kind
        self._update()

    def _update(self) -> None:
        self._hull.is_wet = None if self._kind == "off" else bool(self._kind) or self._is_wet


def thermometer_part(hull: SimHullSensor) -> Part:
    """The hull's thermometer, and the heat in the hull."""

    def apply(fault: FaultSetting | None, now_s: float) -> None:
        kind, size = ("", 0.0) if fault is None else (fault.kind, fault.amount)
        hull.hears_heat = kind != "off"
        hull.offset_c = size if kind == "wrong" else 0.0
        hull.set_warming(size / 60.0 if kind == "hot" else 0.0, now_s)

    return apply


def motor_part(shaft: Shaft) -> Part:
    """One motor with its propeller."""

    def apply(fault: FaultSetting | None, now_s: float) -> None:  # noqa: ARG001
        shaft.gain, shaft.weed = 1.0, 0.0
        if fault is None:
            return
        match fault.kind:
            case "off" | "intermittent":
                shaft.gain = 0.0
            case "wrong" | "slow":
                shaft.gain = fault.amount
            case _:
                shaft.weed = fault.amount

    return apply


def rudder_part(rudder: Rudder) -> Part:
    """The rudder's blade, linkage and servo."""

    def apply(fault: FaultSetting | None, now_s: float) -> None:  # noqa: ARG001
        kind, size = ("", 0.0) if fault is None else (fault.kind, fault.amount)
        rudder.fitted = 0.0 if kind == "off" else 1.0
        rudder.is_stuck = kind == "stuck"
        rudder.offset_rad = math.radians(size) if kind == "wrong" else 0.0

    return apply


def computer_parts(computer: Computer, motors: SimMotors) -> dict[str, Part]:
    """The computer's power, speed, clock and disk, and all its links as one radio carries them."""

    def power(fault: FaultSetting | None, now_s: float) -> None:
        if fault is not None:
            computer.lose_power()
            motors.stop()
        elif not computer.has_power:
            computer.begin(now_s)

    def cpu(fault: FaultSetting | None, now_s: float) -> None:  # noqa: ARG001
        computer.load = 0.0 if fault is None else fault.amount

    def clock(fault: FaultSetting | None, now_s: float) -> None:  # noqa: ARG001
        if fault is not None:  # a monotonic clock jumps ahead; only a restart sets it back
            computer.set_clock_offset(computer.clock_offset_s + fault.amount)

    def disk(fault: FaultSetting | None, now_s: float) -> None:  # noqa: ARG001
        computer.disk_is_full = fault is not None

    def link(fault: FaultSetting | None, now_s: float) -> None:  # noqa: ARG001
        computer.link_quality = WHOLE if fault is None else _link_quality(fault)

    return {"link": link, "computer": power, "cpu": cpu, "clock": clock, "disk": disk}


def _link_quality(fault: FaultSetting) -> Quality:
    match fault.kind:
        case "slow":
            return Quality(bandwidth_bytes_s=fault.amount)
        case "delayed":
            return Quality(delay_s=fault.amount)
        case "lossy":
            return Quality(loss=fault.amount)
        case _:
            return Quality(loss=1.0)
