"""The parts of the boat: one function opens each kind, with the driver that the configuration names.

Raises of each: HardwareError, which names the part that does not answer.
"""

from collections.abc import Callable
from contextlib import ExitStack, closing
from pathlib import Path

from msgspec.structs import replace

from companion.config.boat_config import BoatConfig, with_value
from companion.config.parts.payload import CommandPayload, WinchPayload
from companion.core.errors import HardwareError
from companion.hal.battery.battery_sensor import open_battery_monitor
from companion.hal.gnss.gpsd import open_gpsd_gnss
from companion.hal.gnss.nmea import open_nmea_gnss
from companion.hal.gnss.receiver import GnssReceiver
from companion.hal.gnss.ubx import open_ubx_gnss
from companion.hal.heading.antennas import AntennaCompass
from companion.hal.heading.bno055 import open_bno055
from companion.hal.heading.bno085 import open_bno085
from companion.hal.heading.magnetic_compass import open_magnetic_compass
from companion.hal.heading.nmea import open_nmea_compass
from companion.hal.hull import open_hull
from companion.hal.interfaces import (
    Battery,
    Compass,
    DepthSounder,
    Gnss,
    Hardware,
    Hull,
    Motors,
    Probe,
    RcReceiver,
    Rudder,
    Sonar,
)
from companion.hal.motors.bridges import open_bridges
from companion.hal.motors.esc import open_escs
from companion.hal.motors.watched_motors import WatchedMotors
from companion.hal.payload.child_program import CaptureProgram, ChildProgram
from companion.hal.payload.interfaces import PayloadOutput, PayloadParts, Program, PulseCounter
from companion.hal.payload.outputs import open_counter, open_output
from companion.hal.probes.polled import open_analog_probe, open_file_probe
from companion.hal.probes.serial_line import open_serial_probes
from companion.hal.pulses.opening import open_pulse_output
from companion.hal.pulses.rudder_servo import RudderServo
from companion.hal.ranging.mounted_ranger import open_ranger
from companion.hal.rc_receiver import open_rc_receiver
from companion.hal.water.nmea_depth import SharedDepthSounder, open_nmea_depth
from companion.hal.water.ping1d import open_ping1d
from companion.persistence.profile import ProfileFile
from companion.sensors.compass.magnetic_field import FieldCorrector
from companion.sensors.gnss_heading import GnssHeading

Now = Callable[[], float]


class _Absent:
    """A receiver or compass that is not fitted: readings come over MAVLink instead."""

    def read(self) -> None:
        pass

    def close(self) -> None:
        pass


def open_motors(config: BoatConfig, now: Now) -> WatchedMotors:
    """The motors, with their watchdog, which is not started yet."""
    part, has_right = config.parts.motors, config.drive.has_pair
    motors: Motors
    match part.driver:
        case "none":
            raise HardwareError("motors: no driver is configured")
        case "esc":
            motors = open_escs(
                part.signals[: 1 + has_right],
                part.dead_time_s,
                part.arming_s,
                now,
                lambda signal: open_pulse_output(signal, config.parts.pca9685),
            )
        case _:
            motors = open_bridges(part, now, has_right=has_right)
    return WatchedMotors(motors, now, config.motors.command_timeout_s)


def open_rudder(config: BoatConfig) -> Rudder | None:
    """The rudder, amidships."""
    part = config.parts.rudder
    if part.driver == "none":
        return None
    return RudderServo(open_pulse_output(part.signal, config.parts.pca9685), part.signal)


def open_gnss(config: BoatConfig, now: Now) -> Gnss:
    """The GNSS receiver; a silent one where none is fitted."""
    part, compass = config.parts.gnss, config.parts.compass
    heading = None
    if compass.driver == "gnss":
        heading = GnssHeading(part.antenna_bearing_rad, part.baseline_m, part.latency_s, compass.fallback)
    match part.driver:
        case "nmea":
            return open_nmea_gnss(part, now, heading)
        case "ubx":
            return open_ubx_gnss(part, now, heading)
        case "gpsd":
            return open_gpsd_gnss(part, now)
        case "none":
            return _Absent()


def open_compass(
    config: BoatConfig, now: Now, field: FieldCorrector | None = None, gnss: Gnss | None = None
) -> Compass:
    """The heading sensor; a silent one where none is fitted. field: the live correction of a magnetometer.

    gnss: the open receiver, where its antennas are the heading sensor.
    """
    part = config.parts.compass
    match part.driver:
        case "gnss":
            receiver = gnss or open_gnss(config, now)
            if not isinstance(receiver, GnssReceiver) or receiver.heading is None:
                raise HardwareError("parts.compass.driver: parts.gnss.driver is not a receiver with antennas")
            reserve = open_compass(with_value(config, "parts.compass.driver", part.fallback), now, field)
            return AntennaCompass(receiver.heading, reserve, now, None if gnss else receiver)
        case "bno055":
            folder = config.storage.folder
            path = Path(folder).expanduser() / "bno055.profile"
            return open_bno055(part, now, ProfileFile(path) if folder else None)
        case "bno085":
            return open_bno085(part, now)
        case "qmc5883l" | "qmc5883p" | "hmc5883l" | "lis3mdl":
            return open_magnetic_compass(part, now, field or FieldCorrector())
        case "nmea":
            return open_nmea_compass(part, now)
        case "none":
            return _Absent()


def open_sonar(config: BoatConfig, now: Now) -> Sonar | None:
    """The ranger."""
    part = config.parts.sonar
    return None if part.driver == "none" else open_ranger(part, now)


def open_battery(config: BoatConfig, now: Now) -> Battery | None:
    """The battery monitor."""
    part = config.parts.battery
    return None if part.driver == "none" else open_battery_monitor(part, now)


def open_hull_sensor(config: BoatConfig, now: Now) -> Hull | None:
    """The sensors inside the hull."""
    part = config.parts.hull
    return None if part.driver == "none" else open_hull(part, now)


def open_depth(config: BoatConfig, now: Now, gnss: Gnss | None = None) -> DepthSounder | None:
    """The depth sounder. gnss: the open receiver, whose port it may share."""
    part = config.parts.depth
    match part.driver:
        case "ping1d":
            return open_ping1d(part, now)
        case "gnss" if isinstance(gnss, GnssReceiver):
            return SharedDepthSounder(gnss, part)
        case "gnss":
            port, baud = config.parts.gnss.port, config.parts.gnss.baud or 9600
            return open_nmea_depth(replace(part, port=port, baud=baud), now)
        case "nmea":
            return open_nmea_depth(part, now)
        case "none":
            return None


def open_probes(config: BoatConfig, now: Now) -> tuple[Probe, ...]:
    """The probes, in the order of the configuration."""
    opened: dict[str, Probe] = {}
    with ExitStack() as undo:
        for part in config.probe:
            if part.name in opened:
                continue
            if part.driver == "serial":
                together = [one for one in config.probe if one.driver == "serial" and one.port == part.port]
                for one, probe in zip(together, open_serial_probes(together, now), strict=True):
                    opened[one.name] = probe
            else:
                opening = open_analog_probe if part.driver == "ads1115" else open_file_probe
                opened[part.name] = opening(part, now)
            undo.callback(opened[part.name].close)
        undo.pop_all()
    return tuple(opened[part.name] for part in config.probe)


def open_rc(config: BoatConfig, now: Now) -> RcReceiver | None:
    """The RC receiver."""
    return None if config.rc.driver == "none" else open_rc_receiver(config.rc, now)


def open_payload(config: BoatConfig) -> PayloadParts:
    """The payload, every output in its safe state, and the command that takes images."""
    outputs: dict[int, PayloadOutput] = {}
    counters: dict[int, PulseCounter] = {}
    programs: dict[int, Program] = {}
    capture = CaptureProgram(config.camera) if config.camera.capture else None
    with ExitStack() as undo:
        for index, setting in enumerate(config.payload):
            if isinstance(setting, CommandPayload):
                programs[index] = ChildProgram(setting.title, setting.run, setting.timeout_s, setting.folder)
                continue
            outputs[index] = undo.enter_context(closing(open_output(setting, config.parts.pca9685)))
            if isinstance(setting, WinchPayload) and (counter := open_counter(setting)) is not None:
                counters[index] = undo.enter_context(closing(counter))
        undo.pop_all()
    return PayloadParts(outputs, counters, programs, capture)


def open_hardware(config: BoatConfig, now: Now) -> Hardware:
    """Open every part that the configuration names; the motors first, so that they are off from the start.

    Raises:
        HardwareError: names the part that does not answer; those already open are closed again.
    """
    with ExitStack() as undo:
        motors = undo.enter_context(closing(open_motors(config, now)))
        motors.start()
        if (rudder := open_rudder(config)) is not None:
            undo.callback(rudder.close)
        gnss = undo.enter_context(closing(open_gnss(config, now)))
        field = FieldCorrector() if config.parts.compass.is_magnetometer else None
        compass = undo.enter_context(closing(open_compass(config, now, field, gnss)))
        if (sonar := open_sonar(config, now)) is not None:
            undo.callback(sonar.close)
        if (battery := open_battery(config, now)) is not None:
            undo.callback(battery.close)
        if (hull := open_hull_sensor(config, now)) is not None:
            undo.callback(hull.close)
        if (depth := open_depth(config, now, gnss)) is not None:
            undo.callback(depth.close)
        probes = open_probes(config, now)
        for probe in probes:
            undo.callback(probe.close)
        payload = undo.enter_context(closing(open_payload(config)))
        rc = open_rc(config, now)
        undo.pop_all()
    return Hardware(
        motors,
        gnss,
        compass,
        sonar,
        battery,
        hull=hull,
        rc=rc,
        cutoff=motors,
        field=field,
        rudder=rudder,
        payload=payload,
        corrections=gnss if isinstance(gnss, GnssReceiver) else None,
        depth=depth,
        probes=probes,
    )
