"""The parts of the boat: one function opens each kind that is fitted, with the configuration's driver.

Raises of each: HardwareError, which names the part that does not answer.
"""

from collections.abc import Callable, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING

from msgspec.structs import replace

from companion.config.actuators import Pca9685Part
from companion.config.boat_config import BoatConfig, with_value
from companion.config.payload import PayloadSetting, WinchPayload
from companion.config.sensors import ProbePart
from companion.core.errors import HardwareError
from companion.core.generations import ProfileFile
from companion.hal import interfaces as parts
from companion.hal.battery import open_battery_monitor
from companion.hal.gnss.gpsd import open_gpsd_gnss
from companion.hal.gnss.receiver import GnssReceiver, open_nmea_gnss
from companion.hal.gnss.ubx import open_ubx_gnss
from companion.hal.heading.antennas import AntennaCompass
from companion.hal.heading.bno055 import open_bno055
from companion.hal.heading.bno085 import open_bno085
from companion.hal.heading.magnetic_compass import open_magnetic_compass
from companion.hal.hull import open_hull
from companion.hal.motors.bridges import open_bridges
from companion.hal.motors.esc import open_escs
from companion.hal.motors.esc_line import EscBattery, open_esc_line
from companion.hal.motors.vesc import open_vescs
from companion.hal.motors.watched_motors import WatchedMotors
from companion.hal.nmea_sensor import open_ais as open_ais_receiver
from companion.hal.nmea_sensor import open_nmea_compass, open_nmea_depth
from companion.hal.payload.outputs import open_counter, open_output
from companion.hal.ping1d import open_ping1d
from companion.hal.probes import open_analog_probe, open_file_probe, open_serial_probes
from companion.hal.pulses.opening import RudderServo, open_pulse_output
from companion.hal.ranging.mounted_ranger import open_ranger
from companion.hal.rc_receiver import open_rc_receiver
from companion.hal.retried_parts import CountedOutput
from companion.sensors.compass.magnetic_field import FieldCorrector
from companion.sensors.gnss_heading import GnssHeading

if TYPE_CHECKING:
    from companion.hal.autopilot.line import AutopilotLine

Now = Callable[[], float]


def behind_autopilot(config: BoatConfig, now: Now) -> "AutopilotLine":
    """The autopilot's line, which its parts share. Raises ConfigError: the url is invalid."""
    from companion.hal.autopilot.line import open_autopilot  # noqa: PLC0415 — only where there is one

    return open_autopilot(config, now)


class _Absent:
    """A receiver or compass that is not fitted: readings come over MAVLink instead."""

    def read(self) -> None:
        pass

    def close(self) -> None:
        pass


def open_motors(config: BoatConfig, now: Now) -> WatchedMotors:
    """The motors, with their watchdog, which is not started yet."""
    part, has_right = config.parts.motors, config.drive.has_pair
    motors: parts.Motors
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
        case "vesc":
            motors = open_vescs(part, now, has_right=has_right)
        case "autopilot":
            motors = behind_autopilot(config, now).motors()
        case _:
            motors = open_bridges(part, now, has_right=has_right)
    return WatchedMotors(motors, now, config.motors.command_timeout_s)


def open_rudder(config: BoatConfig, now: Now) -> parts.Rudder:
    """The rudder's servo, which begins amidships."""
    part = config.parts.rudder
    if part.driver == "autopilot":
        return behind_autopilot(config, now).rudder()
    return RudderServo(open_pulse_output(part.signal, config.parts.pca9685), part.signal)


def antenna_heading(config: BoatConfig) -> GnssHeading | None:
    """The heading by the receiver's two antennas, where these are the heading sensor."""
    part, compass = config.parts.gnss, config.parts.compass
    if compass.driver != "gnss":
        return None
    return GnssHeading(
        part.antenna_bearing_rad, part.baseline_m, part.latency_s, compass.fallback, compass.silence_s
    )


def open_gnss(config: BoatConfig, now: Now, heading: GnssHeading | None = None) -> parts.Gnss:
    """The GNSS receiver; a silent one where none is fitted. heading: of its antennas; default: a new one."""
    part = config.parts.gnss
    heading = heading or antenna_heading(config)
    match part.driver:
        case "nmea":
            return open_nmea_gnss(part, now, heading)
        case "ubx":
            return open_ubx_gnss(part, now, heading)
        case "gpsd":
            return open_gpsd_gnss(part, now)
        case "autopilot":
            return behind_autopilot(config, now).sensor(lambda readings: readings.fix)
        case "none":
            return _Absent()


def open_compass(config: BoatConfig, now: Now, field: FieldCorrector | None = None) -> parts.Compass:
    """The heading sensor; a silent one where none is fitted. field: the live correction of a magnetometer."""
    part = config.parts.compass
    match part.driver:
        case "gnss":
            receiver = open_gnss(config, now)
            if not isinstance(receiver, GnssReceiver) or receiver.heading is None:
                raise HardwareError("parts.compass.driver: parts.gnss.driver is not a receiver with antennas")
            reserve = open_compass(bare_compass(config), now, field)
            return AntennaCompass(receiver.heading, reserve, now, receiver)
        case "bno055":
            folder = config.storage.folder
            path = Path(folder).expanduser() / "bno055.profile"
            return open_bno055(part, now, ProfileFile(path) if folder else None)
        case "bno085":
            return open_bno085(part, now)
        case "nmea":
            return open_nmea_compass(part, now)
        case "autopilot":
            return behind_autopilot(config, now).sensor(lambda readings: readings.heading)
        case "none":
            return _Absent()
        case _:  # a magnetometer
            return open_magnetic_compass(part, now, field or FieldCorrector())


def bare_compass(config: BoatConfig) -> BoatConfig:
    """Without the antennas: the configuration of the compass in reserve, or of the only one."""
    return with_value(config, "parts.compass.driver", config.parts.compass.part_driver)


def open_sonar(config: BoatConfig, now: Now) -> parts.Sonar:
    """The ranger with its servo, which begins to ping."""
    if config.parts.sonar.driver == "autopilot":
        return behind_autopilot(config, now).sonar()
    return open_ranger(config.parts.sonar, now)


def open_esc(config: BoatConfig, now: Now, side: int = 0) -> parts.EscTelemetry:
    """The port of a speed controller that reports. side: 0 left, 1 right."""
    return open_esc_line(config.parts.motors, side, now).start()


def open_lidar(config: BoatConfig, now: Now) -> parts.Sonar:
    from companion.hal.ranging.scanning_lidar import open_lidar  # noqa: PLC0415 (only where one is fitted)

    return open_lidar(config.parts.lidar, now)


def open_battery(config: BoatConfig, now: Now) -> parts.Battery:
    if config.parts.battery.driver == "esc":
        has_right = config.drive.has_pair
        ports = config.parts.motors.ports(has_right=has_right)
        return EscBattery([open_esc(config, now, side) for side in range(len(ports))], 1 + has_right)
    if config.parts.battery.driver == "autopilot":
        return behind_autopilot(config, now).sensor(lambda readings: readings.battery)
    return open_battery_monitor(config.parts.battery, now)


def open_hull_sensor(config: BoatConfig, now: Now) -> parts.Hull:
    return open_hull(config.parts.hull, now)


def open_depth(config: BoatConfig, now: Now) -> parts.DepthSounder:
    """The depth sounder; one on the line of the GNSS receiver has that line to itself."""
    part = config.parts.depth
    match part.driver:
        case "ping1d":
            return open_ping1d(part, now)
        case "autopilot":
            return behind_autopilot(config, now).sensor(lambda readings: readings.depth)
        case "gnss":
            port, baud = config.parts.gnss.port, config.parts.gnss.baud or 9600
            return open_nmea_depth(replace(part, port=port, baud=baud), now)
        case _:
            return open_nmea_depth(part, now)


def open_ais(config: BoatConfig, now: Now) -> parts.Ais:
    return open_ais_receiver(config.parts.ais, now)


def probe_groups(config: BoatConfig) -> list[tuple[ProbePart, ...]]:
    """The probes that open together: those of one serial line, and each other one alone."""
    groups: dict[str, list[ProbePart]] = {}
    for part in config.probe:
        groups.setdefault(part.port if part.driver == "serial" else f"[{part.name}]", []).append(part)
    return [tuple(group) for group in groups.values()]


def open_probe_group(group: Sequence[ProbePart], now: Now) -> tuple[parts.Probe, ...]:
    """The probes of a group, in its order."""
    match group[0].driver:
        case "serial":
            return open_serial_probes(group, now)
        case "ads1115":
            return (open_analog_probe(group[0], now),)
        case "file":
            return (open_file_probe(group[0], now),)


def open_rc(config: BoatConfig, now: Now) -> parts.RcReceiver:
    if config.rc.driver == "autopilot":
        return behind_autopilot(config, now).sensor(lambda readings: readings.rc)
    return open_rc_receiver(config.rc, now)


def open_payload_output(setting: PayloadSetting, chip: Pca9685Part) -> CountedOutput:
    """A payload's output in its safe state, with the counter of a winch."""
    output = open_output(setting, chip)
    with ExitStack() as undo:
        undo.callback(output.close)
        counter = open_counter(setting) if isinstance(setting, WinchPayload) else None
        undo.pop_all()
    return CountedOutput(output, counter)
