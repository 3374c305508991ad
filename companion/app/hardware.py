"""All parts of the boat, the motors first. A part that cannot be opened joins the boat later."""

from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass, field
from functools import partial
from typing import Any, Protocol, TypeVar

from companion.app import parts
from companion.app.parts import Now
from companion.config.boat_config import BoatConfig
from companion.config.payload import CommandPayload, WinchPayload
from companion.hal.gnss.receiver import GnssReceiver
from companion.hal.heading.antennas import AntennaCompass
from companion.hal.interfaces import Compass, EscTelemetry, Gnss, Hardware, PayloadParts, Sensor, Sonar
from companion.hal.motors.esc_line import EscBattery
from companion.hal.motors.watched_motors import WatchedMotors
from companion.hal.nmea_sensor import SharedDepthSounder
from companion.hal.payload.child_program import CaptureProgram, ChildProgram
from companion.hal.retried_parts import (
    RetriedGnss,
    RetriedMotors,
    RetriedOutput,
    RetriedProbe,
    RetriedProbeGroup,
    RetriedRudder,
    RetriedSensor,
    RetriedSonar,
)
from companion.links.retried import PACE, Pace, Retried, await_first
from companion.sensors.compass.magnetic_field import FieldCorrector
from companion.sensors.gnss_heading import GnssHeading

_Part = TypeVar("_Part", bound=Retried[Any])
_Reading = TypeVar("_Reading")


class Begin(Protocol):
    """Starts the attempts to open a part; returns the part."""

    def __call__(self, part: _Part, /) -> _Part: ...


def open_hardware(config: BoatConfig, now: Now, pace: Pace = PACE) -> Hardware:
    """Begin to open every configured part; those that answer are open on return.

    After a ConfigError, a part that can never open so, all are closed again.
    """
    with ExitStack() as undo:
        assembly = _Assembly(config, now, pace, undo)
        hardware = assembly.open()
        undo.pop_all()
    return hardware


@dataclass(eq=False)
class _Assembly:
    """Begins the attempts, and joins the parts that share something."""

    _config: BoatConfig
    _now: Now
    _pace: Pace
    _undo: ExitStack
    _begun: list[Retried[Any]] = field(default_factory=list, init=False)

    def open(self) -> Hardware:
        """The motors first, so that they are off from the start."""
        config, fitted = self._config, self._config.parts
        outputs = None
        if fitted.autopilot_part.url:
            outputs = parts.behind_autopilot(config, self._now)
            self._undo.callback(outputs.close)
            self._begun.append(outputs.port)
        motors = self._begin(RetriedMotors("Motors", self._open_motors, self._pace))
        self._await()
        rudder = None
        if fitted.rudder.driver != "none":
            rudder = self._begin(
                RetriedRudder("Rudder", lambda: parts.open_rudder(config, self._now), self._pace)
            )
        escs = self._escs(motors)
        heading = parts.antenna_heading(config)
        shared = SharedDepthSounder(fitted.depth) if fitted.depth.driver == "gnss" else None
        gnss = self._begin(RetriedGnss("GNSS receiver", lambda: self._open_gnss(heading, shared), self._pace))
        field = FieldCorrector() if fitted.compass.is_magnetometer else None
        hardware = Hardware(
            motors,
            gnss,
            self._compass(field, heading),
            self._ranger("Sonar", fitted.sonar.driver, parts.open_sonar),
            EscBattery(escs, 1 + config.drive.has_pair)
            if fitted.battery.driver == "esc"
            else self._sensor("Battery monitor", fitted.battery.driver, parts.open_battery),
            hull=self._sensor("Hull sensor", fitted.hull.driver, parts.open_hull_sensor),
            rc=self._sensor("RC receiver", config.rc.driver, parts.open_rc),
            cutoff=motors,
            field=field,
            rudder=rudder,
            payload=begin_payload(config, self._begin, self._pace),
            corrections=gnss if fitted.gnss.driver in ("nmea", "ubx") else None,
            depth=shared or self._sensor("Depth sounder", fitted.depth.driver, parts.open_depth),
            ais=self._sensor("AIS receiver", fitted.ais.driver, parts.open_ais),
            probes=begin_probes(config, self._now, self._begin, self._pace),
            escs=escs,
            lidar=self._ranger("Lidar", fitted.lidar.driver, parts.open_lidar),
            outputs=outputs,
            autopilot=outputs if fitted.autopilot_part.component else None,
            retried=tuple(self._begun),
        )
        self._await()
        return hardware

    def _begin(self, part: _Part) -> _Part:
        self._undo.callback(part.close)
        self._begun.append(part)
        part.start()
        return part

    def _await(self) -> None:
        await_first(self._begun, self._pace)

    def _sensor(
        self, name: str, driver: str, open_part: Callable[[BoatConfig, Now], Sensor[_Reading]]
    ) -> RetriedSensor[_Reading] | None:
        if driver == "none":
            return None
        return self._begin(RetriedSensor(name, lambda: open_part(self._config, self._now), self._pace))

    def _ranger(
        self, name: str, driver: str, open_part: Callable[[BoatConfig, Now], Sonar]
    ) -> RetriedSonar | None:
        if driver == "none":
            return None
        return self._begin(RetriedSonar(name, lambda: open_part(self._config, self._now), self._pace))

    def _open_motors(self) -> WatchedMotors:
        motors = parts.open_motors(self._config, self._now)
        motors.start()
        return motors

    def _escs(self, motors: RetriedMotors) -> tuple[EscTelemetry, ...]:
        part = self._config.parts.motors
        if part.driver == "vesc":
            return (motors,)
        opening = (
            (name, partial(parts.open_esc, self._config, self._now, side))
            for side, name in enumerate(part.ports(has_right=self._config.drive.has_pair))
        )
        return tuple(self._begin(RetriedSensor(f"ESC of {name}", one, self._pace)) for name, one in opening)

    def _open_gnss(self, heading: GnssHeading | None, shared: SharedDepthSounder | None) -> Gnss:
        receiver = parts.open_gnss(self._config, self._now, heading)
        if shared is not None and isinstance(receiver, GnssReceiver):
            shared.listen_to(receiver)
        return receiver

    def _compass(self, field: FieldCorrector | None, heading: GnssHeading | None) -> Compass:
        """heading: of the receiver's antennas, if they are used; the part is then in reserve."""
        bare = parts.bare_compass(self._config)
        compass = self._begin(
            RetriedSensor("Compass", lambda: parts.open_compass(bare, self._now, field), self._pace)
        )
        return compass if heading is None else AntennaCompass(heading, compass, self._now)


def begin_probes(config: BoatConfig, now: Now, begin: Begin, pace: Pace = PACE) -> tuple[RetriedProbe, ...]:
    """The probes, in the order of the configuration. begin: starts the attempts to open."""
    probes: dict[str, RetriedProbe] = {}
    for group in parts.probe_groups(config):
        names = [part.name for part in group]
        opening = partial(parts.open_probe_group, group, now)
        opened = begin(RetriedProbeGroup(f"probe {', '.join(names)}", opening, pace))
        probes |= {name: RetriedProbe(opened, index) for index, name in enumerate(names)}
    return tuple(probes[part.name] for part in config.probe)


def begin_payload(config: BoatConfig, begin: Begin, pace: Pace = PACE) -> PayloadParts:
    """The payload, and the command that takes images. begin: starts the attempts to open."""
    outputs: dict[int, RetriedOutput] = {}
    counters: dict[int, RetriedOutput] = {}
    programs: dict[int, ChildProgram] = {}
    for index, one in enumerate(config.payload):
        if isinstance(one, CommandPayload):
            programs[index] = ChildProgram(one.title, one.run, one.timeout_s, one.folder)
            continue
        opening = partial(parts.open_payload_output, one, config.parts.pca9685)
        outputs[index] = begin(RetriedOutput(one.title, opening, pace))
        if isinstance(one, WinchPayload) and one.count_pin is not None:
            counters[index] = outputs[index]
    capture = CaptureProgram(config.camera) if config.camera.capture else None
    return PayloadParts(outputs, counters, programs, capture)
