"""Everything aboard that takes current and may fail: sensors, motor inputs, computer; and how they fail."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from companion.config.parameters import ParameterHook
from companion.hal.interfaces import Hardware
from sitl.run.simulated_hardware import SimMotors
from sitl.scenarios.scenario import Scenario
from sitl.world.computer import Clocked, Computer
from sitl.world.faults.hull_parameters import HullParameters
from sitl.world.faults.injection import Injection
from sitl.world.faults.parameters import FaultParameters
from sitl.world.faults.parts import (
    ClockPart,
    ComputerPart,
    CpuPart,
    DiskPart,
    GyroPart,
    LeakPart,
    LinkPart,
    MotorPart,
    Part,
    SensorPart,
    Shaft,
    ThermometerPart,
)
from sitl.world.faults.schedule import Faults
from sitl.world.movers import Movers
from sitl.world.sensors import SimBattery, SimCompass, SimGnss, SimHull, SimRc, SimSonar
from sitl.world.shore import Shore

if TYPE_CHECKING:
    from sitl.world.world import Truth


class Electronics:
    """What is between the water and the boat's program."""

    __slots__ = (
        "_battery",
        "_compass",
        "_gnss",
        "_hull",
        "_sonar",
        "computer",
        "faults",
        "hardware",
        "motors",
        "rc",
    )

    def __init__(
        self,
        scenario: Scenario,
        shore: Shore,
        movers: Movers,
        left: Shaft,
        right: Shaft,
        parameter_hooks: Sequence[ParameterHook] = (),
    ) -> None:
        """left and right: what the motors turn. knobs: parameters of the world around."""
        sensors, seed = scenario.sensors, scenario.seed
        self.motors = SimMotors()
        fitted = scenario.vehicle.parts
        self._gnss = SimGnss(sensors.gnss, scenario.frame, seed, shore, fitted.gnss.latency_s)
        self._compass = SimCompass(sensors.compass, seed, fitted.compass.correction_rad)
        self._sonar: SimSonar | None = None
        if sensors.sonar.fitted:
            self._sonar = SimSonar(sensors.sonar, shore, seed, movers or None)
        start = scenario.start
        self.rc = SimRc(sensors.rc, seed, *start) if sensors.rc.fitted else None
        self._battery = SimBattery(scenario.battery.rate_hz, sensors.battery, seed)
        self._hull = SimHull(sensors.hull) if sensors.hull.fitted else None
        drivers: list[Clocked] = [self._gnss, self._compass, self._battery]
        if self._hull is not None:
            drivers.append(self._hull)
        if self._sonar is not None:
            drivers.append(self._sonar)
        if self.rc is not None:
            drivers.append(self.rc)
        self.computer = Computer(drivers)
        parts: dict[str, Part] = {
            "gnss": SensorPart(self._gnss, seed),
            "compass": SensorPart(self._compass, seed),
            "gyro": GyroPart(self._compass, seed),
            "battery": SensorPart(self._battery, seed),
            "motor_left": MotorPart(left),
            "motor_right": MotorPart(right),
            "link": LinkPart(self.computer),
            "computer": ComputerPart(self.computer, self.motors),
            "cpu": CpuPart(self.computer),
            "clock": ClockPart(self.computer),
            "disk": DiskPart(self.computer),
        }
        if self._sonar is not None:
            parts["sonar"] = SensorPart(self._sonar, seed)
        if self.rc is not None:
            parts["rc"] = SensorPart(self.rc, seed)
        hull_hooks: tuple[ParameterHook, ...] = ()
        if self._hull is not None:
            leak = LeakPart(self._hull)
            parts["leak"], parts["thermometer"] = leak, ThermometerPart(self._hull)
            hull_hooks = HullParameters(self._hull, leak, sensors.hull).parameter_hooks
        self.faults = Faults(parts, scenario.faults)
        injection = Injection(self.faults)
        self.hardware = Hardware(
            self.motors,
            self._gnss,
            self._compass,
            self._sonar,
            self._battery,
            faults=injection,
            parameter_hooks=(
                *FaultParameters(self.faults, injection, scenario.frame).parameter_hooks,
                *hull_hooks,
                *parameter_hooks,
            ),
            hull=self._hull,
            rc=self.rc,
        )

    def sense(self, truth: "Truth", wave_m: float = 0.0) -> None:
        """Let what is due fail or be well again, then sample what is due. wave_m: the waves' height."""
        now_s = truth.time_s
        self.faults.now_s = now_s
        if now_s >= self.faults.due_s:
            self.faults.step()
        if now_s >= self._compass.due_s:
            self._compass.sense(
                now_s, truth.heading_rad, truth.yaw_rate_rad_s, truth.current_a, truth.surge_m_s
            )
        if now_s >= self._gnss.due_s:
            self._gnss.sense(now_s, truth.north_m, truth.east_m, truth.north_m_s, truth.east_m_s)
        if self._sonar is not None and now_s >= self._sonar.due_s:
            self._sonar.sense(now_s, truth.north_m, truth.east_m, truth.heading_rad, wave_m)
        if self.rc is not None and now_s >= self.rc.due_s:
            self.rc.sense(now_s, truth.north_m, truth.east_m)
        if self._hull is not None and now_s >= self._hull.due_s:
            self._hull.sense(now_s)
        if now_s >= self._battery.due_s:
            self._battery.sense(now_s, truth.voltage_v, truth.current_a)
