"""Parts that join the boat after its start."""

import dataclasses
from collections.abc import Sequence

import pytest
from boat_rig import FAILED, OK, Rig
from twins.lines import HandClock

from companion.core.errors import HardwareError
from companion.core.readings import HullReading, SonarReading
from companion.core.status_text import Severity, StatusText
from companion.hal.interfaces import Hardware
from companion.hal.motors.watched_motors import WatchedMotors
from companion.hal.retried_parts import (
    CountedOutput,
    RetriedMotors,
    RetriedOutput,
    RetriedRudder,
    RetriedSensor,
    RetriedSonar,
)

PRE_ARM_S = 6.0  # until the boat tells why it does not arm


class Part:
    """Any part, with a record of what it was told."""

    may_pause = False

    def __init__(self) -> None:
        self.told: list[object] = []

    def write(self, *values: float) -> None:
        self.told.append(values)

    def stop(self) -> None:
        self.told.append("stop")

    def set_sector(self, *bearings_rad: float) -> None:
        self.told.append(bearings_rad)

    def close(self) -> None:
        self.told.append("close")

    def take_texts(self) -> list[StatusText]:
        return [StatusText(Severity.NOTICE, "set up again")]


class Socket:
    """Where a part is plugged in, or not."""

    def __init__(self, part: object = None) -> None:
        self.part = part

    def open(self) -> object:
        if self.part is None:
            raise HardwareError("L298N: the pins cannot be opened")
        return self.part


def test_motors_that_are_missing_refuse_to_arm_even_by_force_and_arm_once_they_are_there() -> None:
    socket, clock = Socket(), HandClock()
    motors = RetriedMotors("Motors", socket.open)  # type: ignore[arg-type]
    rig = Rig(motors=motors, cutoff=motors)
    motors.attempt()
    rig.run(PRE_ARM_S)
    assert rig.peer.texts.count("Motors: L298N: the pins cannot be opened") == 1
    assert "PreArm: Motors: L298N: the pins cannot be opened" in rig.peer.texts
    for is_forced in (False, True):
        rig.peer.forget()
        assert rig.arm(force=is_forced) == FAILED
        assert "Arm: Motors: L298N: the pins cannot be opened" in rig.peer.texts
    assert rig.ask(209, 1.0, 0.0, 20.0, 1.0) == FAILED  # DO_MOTOR_TEST
    assert "Motor test: L298N: the pins cannot be opened" in rig.peer.texts
    part = Part()
    socket.part = WatchedMotors(part, clock, 0.5)
    motors.attempt()
    rig.run(1.0)
    assert "Motors: opened" in rig.peer.texts
    assert set(part.told) == {(0.0, 0.0)}
    assert rig.arm() == OK


def test_commands_to_motors_and_rudder_before_the_opening_have_no_effect() -> None:
    motors = RetriedMotors("Motors", Socket().open)  # type: ignore[arg-type]
    motors.write(1.0, 1.0)
    motors.stop()
    assert motors.trips == 0
    socket = Socket()
    rudder = RetriedRudder("Rudder", socket.open)  # type: ignore[arg-type]
    rudder.write(1.0)
    part = socket.part = Part()
    rudder.attempt()
    rudder.write(0.5)
    assert part.told == [(0.5,)]
    rudder.close()
    motors.close()


def test_a_sensor_gives_its_readings_and_texts_once_it_is_there() -> None:
    class Hull(Part):
        def read(self) -> HullReading:
            return HullReading(0.0, is_wet=False, temperature_c=40.0)

    socket = Socket()
    sensor = RetriedSensor[HullReading]("Hull sensor", socket.open)  # type: ignore[arg-type]
    sensor.attempt()
    sensor.may_pause = True
    assert sensor.read() is None
    assert len(sensor.take_texts()) == 1
    part = socket.part = Hull()
    sensor.attempt()
    assert sensor.read() == part.read()
    assert part.may_pause
    assert [one.text for one in sensor.take_texts()] == ["Hull sensor: opened", "set up again"]


def test_a_sonar_learns_the_sector_that_it_missed() -> None:
    class Ranger(Part):
        def read(self) -> Sequence[SonarReading]:
            return [SonarReading(0.0, 0.0, 2.0)]

    socket = Socket()
    sonar = RetriedSonar("Sonar", socket.open)  # type: ignore[arg-type]
    sonar.set_sector(-0.5, 0.5)
    assert sonar.read() == ()
    part = socket.part = Ranger()
    sonar.attempt()
    assert sonar.read() == part.read()
    sonar.read()
    assert part.told == [(-0.5, 0.5)]


def test_an_output_that_is_missing_says_so_when_it_is_used() -> None:
    socket = Socket()
    output = RetriedOutput("relay 1", socket.open)  # type: ignore[arg-type]
    output.attempt()
    with pytest.raises(HardwareError, match="relay 1: L298N"):
        output.write(1.0)
    assert output.count == 0
    part = Part()
    socket.part = CountedOutput(part, None)
    output.attempt()
    output.write(1.0)
    output.close()
    assert part.told == [(1.0,), "close"]
    assert output.count == 0


def test_every_part_is_closed_and_the_motors_before_all_others() -> None:
    order: list[str] = []

    class Named:
        def __init__(self, name: str) -> None:
            self.name = name

        def close(self) -> None:
            order.append(self.name)

    several = {"parameter_hooks", "retried", "probes", "escs"}
    names = [one.name for one in dataclasses.fields(Hardware) if one.name not in several]
    more = {"probes": (Named("probe"),), "escs": (Named("esc"),)}
    hardware = Hardware(**{name: Named(name) for name in names}, **more)  # type: ignore[arg-type]
    hardware.close()
    assert order[:2] == ["motors", "rudder"]
    assert sorted(order) == sorted([*names, "probe", "esc"])
