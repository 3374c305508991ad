"""Checks of the configured parts, one after the other, with their live readings."""

import math
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack, closing
from functools import partial
from pathlib import Path
from shutil import which
from typing import Any, Final, Protocol

from companion.app import parts
from companion.app.doctor.findings import Examined, Finding, Verdict, failed, fine, skipped, warning
from companion.app.runner import Clock
from companion.app.status_file import running_boat
from companion.config.boat_config import BoatConfig
from companion.config.parameter_table import ROWS
from companion.config.parameters import PARAMETER_FILE, Parameters
from companion.config.payload import CommandPayload
from companion.config.sensors import ProbePart
from companion.core import readings
from companion.core.errors import BoatError
from companion.core.generations import find_newest
from companion.core.storage import MemoryStorage
from companion.core.units import wrap_two_pi
from companion.hal.interfaces import ReportingPart
from companion.obstacles.perception.occupancy import SWEEP_S
from companion.sensors.compass.magnetic_field import BY_CURRENT, NO_MOTORS, FieldCorrector, compass_hooks
from companion.sensors.fuel_gauge import cells_fault

# For a first reading: a BNO055 starts in 0.7 s, a receiver without a fix speaks every second
_PATIENCE_S = 10.0
_POLL_S = 0.1
_AUTOPILOT_S = 20.0  # for some forty parameters, ten a second


class LivePart(Protocol):
    """What every open part can do."""

    def read(self) -> Any: ...  # noqa: ANN401 — each kind has a reading of its own
    def close(self) -> None: ...


Open = Callable[[BoatConfig, Callable[[], float]], LivePart]

# By the part's section: below `parts`, or of the file
PARTS: Final[Mapping[str, Open]] = {
    "gnss": parts.open_gnss,
    "compass": parts.open_compass,
    "sonar": parts.open_sonar,
    "lidar": parts.open_lidar,
    "battery": parts.open_battery,
    "hull": parts.open_hull_sensor,
    "depth": parts.open_depth,
    "ais": parts.open_ais,
    "rc": parts.open_rc,
}


def check_part(
    name: str, open_part: Open, config: BoatConfig, clock: Clock, driver: str = "", count: int = 1
) -> Finding:
    """Open a part, wait for its first reading, and close it. count: of the speed controllers on the line."""
    driver = driver or (getattr(config.parts, name, None) or getattr(config, name)).driver
    if driver == "none":
        return skipped(name, "not fitted")
    try:
        part = open_part(config, clock.now_s)
    except BoatError as error:
        return failed(name, str(error))
    give_up_s = clock.now_s() + _PATIENCE_S
    with closing(part):
        reading = part.read()
        while _is_missing(reading, count) and clock.now_s() < give_up_s:
            clock.sleep(_POLL_S)
            reading = part.read()
        if isinstance(reading, list) and reading:  # of a ranger: the whole sweep
            clock.sleep(SWEEP_S)
            reading = [*reading, *part.read()]
        texts = [one.text for one in part.take_texts()] if isinstance(part, ReportingPart) else []
    said = "".join(f"; {text}" for text in texts)
    if reading is None or reading == []:
        text = f"{driver}: no reading within {_PATIENCE_S:g} s{said}"
        if name == "ais":  # away from ships and base stations there is nothing to hear
            return warning(name, text, "usual away from ships; else check its supply, port and baud rate")
        return failed(name, text, "check its supply, wires, port and baud rate")
    verdict, words = in_words(reading, config)
    if _is_missing(reading, count):
        text = f"{driver}: {words}, and the right one does not answer over CAN{said}"
        return failed(name, text, "check parts.motors.can_id, its supply and CAN's wires")
    return Finding(name, verdict, f"{driver}: {words}{said}")


def _is_missing(reading: object, count: int) -> bool:
    return reading is None or (isinstance(reading, Sequence) and len(reading) < count)


def check_probes(config: BoatConfig, clock: Clock) -> list[Finding]:
    return [
        check_part(f"probe {one.name}", partial(_open_probe, one), config, clock, one.driver)
        for one in config.probe
    ]


def _open_probe(part: ProbePart, config: BoatConfig, now: Callable[[], float]) -> LivePart:  # noqa: ARG001
    return parts.open_probe_group((part,), now)[0]


def check_escs(config: BoatConfig, clock: Clock) -> list[Finding]:
    """The speed controllers that report; those of KISS only send while they are powered and set to."""
    part, has_right = config.parts.motors, config.drive.has_pair
    ports = part.ports(has_right=has_right)
    count = 1 + (has_right and len(ports) == 1)
    return [
        check_part(f"{side} ESC", partial(parts.open_esc, side=number), config, clock, part.protocol, count)
        for number, side in enumerate(("left", "right")[: len(ports)])
    ]


def check_autopilot(config: BoatConfig, clock: Clock) -> list[Finding]:
    """The parameters of an autopilot that drives the motors; nothing without one."""
    if config.parts.motors.driver != "autopilot":
        return []
    with closing(parts.behind_autopilot(config, clock.now_s)) as line:
        give_up_s, parameters = clock.now_s() + _AUTOPILOT_S, line.link.outputs.parameters
        while not parameters.is_complete and clock.now_s() < give_up_s:
            clock.sleep(_POLL_S)
        if not parameters.is_complete:
            said = "".join(f"; {one.text}" for one in line.take_texts())
            return [failed("autopilot", line.fault + said, "check its supply, wires, port and baud rate")]
    cure = "set it with a ground station; the boat writes no parameter"
    found = [failed("autopilot", text, cure) for text in parameters.faults()]
    found += [warning("autopilot", text, cure) for text in parameters.faults(is_needed=False)]
    return found or [fine("autopilot", "its parameters are as the boat needs them")]


def check_payload(config: BoatConfig) -> Finding:
    """Open the payload's outputs, which puts them in their safe state, and look for the owner's programs."""
    if not config.payload:
        return skipped("payload", "not fitted")
    missing = [
        one.run[0] for one in config.payload if isinstance(one, CommandPayload) and not which(one.run[0])
    ]
    if missing:
        return failed("payload", f"no such programs: {', '.join(missing)}")
    try:
        with ExitStack() as opened:
            for one in config.payload:
                if not isinstance(one, CommandPayload):
                    opened.enter_context(closing(parts.open_payload_output(one, config.parts.pca9685)))
    except BoatError as error:
        return failed("payload", str(error))
    return fine("payload", ", ".join(one.title for one in config.payload))


def part_findings(examined: Examined, clock: Clock) -> list[Finding]:
    """All parts except the motors."""
    if (boat := running_boat(examined.config, examined.target.root)) is not None:
        missing = [failed(name, fault) for name, fault in boat.missing.items()]
        text = "the running boat uses " + ("the others" if missing else "them")
        return [*missing, skipped("parts", text, "sudo systemctl stop mavboat")]
    found = [check_part(name, open_part, examined.config, clock) for name, open_part in PARTS.items()]
    found += [*check_escs(examined.config, clock), *check_compass_calibration(examined)]
    found += check_autopilot(examined.config, clock)
    return [*found, *check_probes(examined.config, clock), check_payload(examined.config)]


def check_compass_calibration(examined: Examined) -> list[Finding]:
    """Nothing for parts that calibrate themselves."""
    config = examined.config
    if not config.parts.compass.is_magnetometer or not config.storage.folder:
        return []
    storage, corrector = MemoryStorage(), FieldCorrector()
    path = examined.path(str(Path(config.storage.folder).expanduser() / PARAMETER_FILE))
    try:
        storage.save(PARAMETER_FILE, find_newest(path).generation.content)
    except OSError as error:
        return [warning("compass calibration", f"{path}: {error.strerror}")]
    Parameters(config, ROWS, storage, compass_hooks(corrector))
    correction = corrector.correction
    if not correction.is_calibrated:
        cure = "turn the boat with boat-companion calibrate-compass, or from QGroundControl's compass page"
        return [warning("compass calibration", "none: only MANUAL and HOLD arm", cure)]
    offsets = ", ".join(f"{one:.0f}" for one in correction.offset)
    source = "current" if correction.motor_source == BY_CURRENT else "throttle"
    motors = "not measured" if correction.motor_source == NO_MOTORS else f"by {source}"
    return [fine("compass calibration", f"offsets {offsets} mG; motors' field {motors}")]


Words = tuple[Verdict, str]
_FIX_NAMES = ("no receiver", "no fix", "2-D fix", "3-D fix", "DGNSS fix", "RTK float", "RTK fixed")


def in_words(reading: object, config: BoatConfig) -> Words:
    """A part's reading, by its type; one of another type as it prints itself."""
    match reading:
        case readings.GnssFix():
            return _fix_in_words(reading, config)
        case readings.HeadingReading():
            return Verdict.FINE, _heading_in_words(reading)
        case readings.BatteryReading():
            return _battery_in_words(reading, config)
        case tuple():
            return _escs_in_words(reading)
        case readings.HullReading():
            wet = {None: "no leak switch", False: "dry", True: "WATER"}[reading.is_wet]
            text = wet if reading.temperature_c is None else f"{wet}, {reading.temperature_c:.0f} °C"
            return Verdict.FAILED if reading.is_wet else Verdict.FINE, text
        case readings.DepthReading():
            return _depth_in_words(reading)
        case readings.AisReading():
            return Verdict.FINE, f"hears stations; vessels with a position: {len(reading.vessels)}"
        case readings.ProbeReading():
            return Verdict.FINE, f"{reading.value:.6g} {reading.unit}".rstrip()
        case readings.RcReading(is_failsafe=True):
            return Verdict.WARNING, "receiver answers, transmitter off"
        case readings.RcReading():
            text = f"channels {' '.join(str(width) for width in reading.channels_us[:8])} µs"
            return Verdict.FINE, text if reading.rssi_dbm is None else f"{text}, {reading.rssi_dbm:.0f} dBm"
        case list():
            return Verdict.FINE, _pings_in_words(reading)
        case _:
            return Verdict.FINE, str(reading)


def degrees(angle_rad: float) -> str:
    """An angle for people."""
    return f"{math.degrees(angle_rad):.0f}°"


def _fix_in_words(fix: readings.GnssFix, config: BoatConfig) -> Words:
    name = _FIX_NAMES[min(fix.fix_type, len(_FIX_NAMES) - 1)]
    text = f"{name}, {fix.satellites} satellites"
    if fix.fix_type >= 2:
        text += f", HDOP {fix.hdop:.1f}, {fix.position.lat_deg:.6f} {fix.position.lon_deg:.6f}"
        if fix.horizontal_accuracy_m is not None:
            text += f" ±{fix.horizontal_accuracy_m:.2g} m"
    good = fix.fix_type >= config.arming.min_fix_type and fix.hdop <= config.arming.max_hdop
    return (Verdict.FINE, text) if good else (Verdict.WARNING, f"{text}; not enough to arm")


def _heading_in_words(reading: readings.HeadingReading) -> str:
    north = "magnetic" if reading.is_magnetic else "true"
    text = f"heading {degrees(wrap_two_pi(reading.heading_rad))} {north}"
    if reading.yaw_rate_rad_s is not None:
        text += f", turning {math.degrees(reading.yaw_rate_rad_s):+.1f}°/s"
    if reading.roll_rad is not None and reading.pitch_rad is not None:
        text += f", roll {degrees(reading.roll_rad)}, pitch {degrees(reading.pitch_rad)}"
    if reading.field_mg is not None:
        text += f", field {math.hypot(*reading.field_mg):.0f} mG"
    return text


def _battery_in_words(reading: readings.BatteryReading, config: BoatConfig) -> Words:
    text = f"{reading.voltage_v:.2f} V"
    text += ", current not measured" if reading.current_a is None else f", {reading.current_a:.2f} A"
    if reading.voltage_v < config.arming.battery_min_v:
        return Verdict.WARNING, f"{text}; below arming.battery_min_v = {config.arming.battery_min_v:g} V"
    if fault := cells_fault(reading.voltage_v, config.battery.cells):
        return Verdict.WARNING, f"{text}; {fault}"
    return Verdict.FINE, text


def _escs_in_words(escs: tuple[readings.EscReading, ...]) -> Words:
    texts = [
        f"{('left', 'right')[one.side]} {one.voltage_v:.2f} V, {one.current_a:.2f} A, "
        f"{one.temperature_c:.0f} °C{one.fault and f', {one.fault}'}"
        for one in escs
    ]
    return Verdict.WARNING if any(one.fault for one in escs) else Verdict.FINE, "; ".join(texts)


def _depth_in_words(reading: readings.DepthReading) -> Words:
    if reading.depth_m is None or reading.water_m is None:
        return Verdict.WARNING, "the sounder answers, no bottom found"
    text = f"{reading.depth_m:.2f} m below the transducer, water {reading.water_m:.2f} m"
    return Verdict.FINE, text if reading.temperature_c is None else f"{text}, {reading.temperature_c:.1f} °C"


def _pings_in_words(pings: Sequence[readings.SonarReading]) -> str:
    echoes = [(ping.range_m, ping.bearing_rad) for ping in pings if ping.range_m is not None]
    if not echoes:
        return f"{len(pings)} pings, no echo within {max(ping.max_range_m for ping in pings):.1f} m"
    range_m, bearing_rad = min(echoes)
    side = "to starboard" if bearing_rad > 0.0 else "to port"
    where = "ahead" if abs(bearing_rad) < math.radians(1.0) else f"{degrees(abs(bearing_rad))} {side}"
    return f"nearest echo {range_m:.2f} m {where}"
