"""A voyage whose motors are behind a twin of ArduPilot Rover: what becomes of it when Rover goes away."""

import dataclasses
from collections.abc import Callable

import pytest
from autopilot_bench import TICK_S, Bench
from boat_rig import Rig, waypoint

from companion.core.errors import SilentOutputsError
from companion.core.readings import HullReading
from companion.hal.interfaces import Motors

HOLD = 4


class MotorsBehindRover:
    """Satisfies `Motors` and `ArmedOutputs`: each write is a tick of both ends of the line."""

    def __init__(self, water: Motors) -> None:
        self.bench = Bench().ready()
        self._water = water

    def write(self, left: float, right: float) -> None:
        self.bench.demand, self.bench.errors = (left, right), []
        self.bench.run(TICK_S)
        self._water.write(self.bench.rover.left, self.bench.rover.right)
        if self.bench.errors:
            raise SilentOutputsError(self.bench.errors[0], are_off=True)

    def stop(self) -> None:
        self.bench.outputs.write(0.0, 0.0)

    @property
    def fault(self) -> str:
        return self.bench.outputs.fault

    def allow(self, *, may_drive: bool) -> None:
        self.bench.outputs.may_drive = may_drive

    def close(self) -> None:
        pass


class Hull:
    """Satisfies `Hull`."""

    is_wet, now_s = False, 0.0

    def read(self) -> HullReading:
        return HullReading(self.now_s, is_wet=self.is_wet, temperature_c=30.0)

    def close(self) -> None:
        pass


@pytest.fixture
def behind() -> tuple[Rig, MotorsBehindRover]:
    return voyage()


def voyage(**parts: object) -> tuple[Rig, MotorsBehindRover]:
    rig = Rig("open", **parts)  # type: ignore[arg-type]
    motors = MotorsBehindRover(rig.world.hardware.motors)
    rig.hardware = dataclasses.replace(rig.hardware, motors=motors, outputs=motors)
    rig.reboot()
    rig.sail(waypoint(40.0, 0.0), waypoint(40.0, 20.0))
    rig.run(8.0)
    assert rig.world.truth.surge_m_s > 1.5
    return rig, motors


def reboots(bench: Bench) -> Callable[[], None]:
    bench.rover.reboot()
    return lambda: None


def is_cut_off(bench: Bench) -> Callable[[], None]:
    bench.hears = bench.is_heard = False

    def again() -> None:
        bench.hears = bench.is_heard = True

    return again


def is_disarmed(bench: Bench) -> Callable[[], None]:
    bench.rover.is_armed = False

    def again() -> None:
        bench.rover.is_armed = True

    return again


@pytest.mark.parametrize("fails", [reboots, is_cut_off, is_disarmed])
def test_a_voyage_goes_on_when_the_autopilot_is_back(
    behind: tuple[Rig, MotorsBehindRover], fails: Callable[[Bench], Callable[[], None]]
) -> None:
    rig, motors = behind
    again = fails(motors.bench)
    rig.run(1.0)
    assert (motors.bench.rover.left, motors.bench.rover.right) == (0.0, 0.0)
    rig.run(9.0)
    again()
    rig.until(lambda: "Mission complete" in rig.peer.texts, 60.0)
    assert rig.offset_m(40.0, 20.0) < 3.0
    told = " ".join(rig.peer.texts)
    assert "Failsafe" not in told
    assert "motor" not in told  # the pause says nothing of them


def test_a_leak_is_not_kept_back_while_the_autopilot_is_away() -> None:
    hull = Hull()
    rig, motors = voyage(hull=hull)
    again = is_cut_off(motors.bench)
    rig.run(5.0)
    hull.is_wet, hull.now_s = True, rig.now_s
    rig.run(1.0)
    hull.now_s = rig.now_s
    rig.until(lambda: any("Water in the hull" in text for text in rig.peer.texts), 4.0)
    assert rig.mode == "RTL"
    again()
    rig.run(5.0)
    assert motors.bench.rover.left > 0.0


def test_a_voyage_ends_in_hold_and_disarmed_once_the_autopilot_stays_away(
    behind: tuple[Rig, MotorsBehindRover],
) -> None:
    rig, motors = behind
    is_cut_off(motors.bench)
    rig.run(59.0)
    assert (rig.mode, rig.boat.vehicle.armed) == ("AUTO", True)
    rig.run(3.0)
    assert not rig.boat.vehicle.armed
    assert motors.bench.outputs.state.name == "IDLE"


def test_the_boat_does_not_push_against_motors_that_are_away(behind: tuple[Rig, MotorsBehindRover]) -> None:
    rig, motors = behind
    is_cut_off(motors.bench)
    rig.run(2.0)
    assert (rig.boat.command.left, rig.boat.command.right) == (0.0, 0.0)
    assert rig.boat.command.reason == "is silent"
