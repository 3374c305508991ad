"""The electronics aboard: sensors, motor inputs and computer, and their faults."""

from collections.abc import Sequence

from companion.config.parameters import ParameterHook
from companion.hal.interfaces import Hardware
from sitl.world.computer import Clocked, Computer
from sitl.world.drive.rudder import Rudder
from sitl.world.drive.thruster import Thruster
from sitl.world.environment.bottom import Bathymetry
from sitl.world.environment.waves import Waves
from sitl.world.faults.injection import Injection
from sitl.world.faults.parts import (
    FaultySensor,
    LeakPart,
    Part,
    computer_parts,
    motor_part,
    rudder_part,
    sensor_part,
    thermometer_part,
)
from sitl.world.faults.schedule import Faults
from sitl.world.movers import Movers
from sitl.world.parameters import fault_hooks, hull_hooks
from sitl.world.payload import SimPayload
from sitl.world.scenario import Scenario
from sitl.world.sensors.ais import SimAis
from sitl.world.sensors.battery_monitor import SimBattery
from sitl.world.sensors.compass import SimCompass
from sitl.world.sensors.depth import SimDepthSounder
from sitl.world.sensors.escs import SimEscs
from sitl.world.sensors.gnss import SimGnss
from sitl.world.sensors.hull_sensor import SimHullSensor
from sitl.world.sensors.rc import SimRc
from sitl.world.sensors.sonar import SimSonar
from sitl.world.shore import Shore
from sitl.world.simulated_hardware import SimMotors, SimRudder
from sitl.world.truth import Truth


class Electronics:
    """The hardware of the boat's program, with its faults."""

    def __init__(
        self,
        scenario: Scenario,
        shore: Shore,
        movers: Movers,
        left: Thruster,
        right: Thruster,
        parameter_hooks: Sequence[ParameterHook] = (),
        rudder: Rudder | None = None,
    ) -> None:
        """left and right: the thrusters. parameter_hooks: further simulation parameters."""
        sensors, seed = scenario.sensors, scenario.seed
        self.motors = SimMotors()
        self.rudder = None if rudder is None else SimRudder()
        fitted = scenario.vehicle.parts
        self._gnss = SimGnss(sensors.gnss, scenario.frame, seed, shore, fitted.gnss.latency_s)
        self._compass = SimCompass(sensors.compass, seed, fitted.compass.correction_rad)
        self.sonar: SimSonar | None = None
        if sensors.sonar.fitted:
            self.sonar = SimSonar(sensors.sonar, shore, seed, movers or None)
        start = scenario.start
        self.rc = SimRc(sensors.rc, seed, *start) if sensors.rc.fitted else None
        self.payload = SimPayload(scenario.vehicle)
        self._battery = SimBattery(scenario.battery.rate_hz, sensors.battery, seed)
        self._hull = SimHullSensor(sensors.hull) if sensors.hull.fitted else None
        self._depth: SimDepthSounder | None = None
        if sensors.depth.fitted:
            bottom = Bathymetry(scenario.chart, scenario.environment)
            self._depth = SimDepthSounder(sensors.depth, bottom, seed, fitted.depth.min_confidence)
        self._ais = SimAis(sensors.ais, scenario.frame, movers, seed) if sensors.ais.fitted else None
        shafts = (left, right)[: 1 + scenario.vehicle.drive.has_pair]
        self._escs = SimEscs(fitted.motors, shafts, seed) if fitted.motors.protocol != "none" else None
        fitted_sensors: dict[str, FaultySensor | None] = {
            "gnss": self._gnss, "compass": self._compass, "battery": self._battery, "sonar": self.sonar,
            "rc": self.rc, "depth": self._depth,
        }  # fmt: skip
        drivers: list[Clocked | None] = [*fitted_sensors.values(), self._hull, self._ais, self._escs]
        self.computer = Computer([one for one in drivers if one is not None])
        parts: dict[str, Part] = {
            **{name: sensor_part(one, seed) for name, one in fitted_sensors.items() if one is not None},
            "gyro": sensor_part(self._compass, seed, "gyro_fault"),
            "motor_left": motor_part(left),
            "motor_right": motor_part(right),
            **computer_parts(self.computer, self.motors),
        }
        if rudder is not None:
            parts["rudder"] = rudder_part(rudder)
        own_hooks: list[ParameterHook] = []
        if self._hull is not None:
            leak = LeakPart(self._hull)
            parts["leak"], parts["thermometer"] = leak, thermometer_part(self._hull)
            own_hooks += hull_hooks(self._hull, leak, sensors.hull)
        self.faults = Faults(parts, scenario.faults)
        injection = Injection(self.faults)
        self.hardware = Hardware(
            self.motors,
            self._gnss,
            self._compass,
            self.sonar,
            self._battery,
            faults=injection,
            parameter_hooks=(
                *fault_hooks(self.faults, injection, scenario.frame),
                *own_hooks,
                *parameter_hooks,
            ),
            hull=self._hull,
            depth=self._depth,
            ais=self._ais,
            rc=self.rc,
            rudder=self.rudder,
            payload=self.payload.parts,
            field=self._compass.corrector,
            escs=() if self._escs is None else (self._escs,),
        )

    def sample(self, truth: Truth, waves: Waves) -> None:
        """Apply faults that are due, then sample sensors that are due."""
        now_s = truth.time_s
        self.faults.now_s = now_s
        self.payload.step(now_s)
        if now_s >= self.faults.due_s:
            self.faults.step()
        if now_s >= self._compass.due_s:
            self._compass.sample(
                now_s,
                truth.heading_rad,
                truth.yaw_rate_rad_s,
                truth.current_a,
                truth.surge_m_s,
                (waves.roll_rad, waves.pitch_rad),
            )
        if now_s >= self._gnss.due_s:
            self._gnss.sample(now_s, truth.north_m, truth.east_m, truth.north_m_s, truth.east_m_s)
        if self.sonar is not None and now_s >= self.sonar.due_s:
            self.sonar.sample(now_s, truth.north_m, truth.east_m, truth.heading_rad, waves)
        if self.rc is not None and now_s >= self.rc.due_s:
            self.rc.sample(now_s, truth.north_m, truth.east_m)
        if self._hull is not None and now_s >= self._hull.due_s:
            self._hull.sample(now_s)
        if self._depth is not None and now_s >= self._depth.due_s:
            self._depth.sample(now_s, truth.north_m, truth.east_m, truth.heading_rad, waves)
        if self._ais is not None and now_s >= self._ais.due_s:
            self._ais.sample(now_s)
        if self._escs is not None and now_s >= self._escs.due_s:
            self._escs.sample(now_s, truth.voltage_v)
        if now_s >= self._battery.due_s:
            self._battery.sample(now_s, truth.voltage_v, truth.current_a)
