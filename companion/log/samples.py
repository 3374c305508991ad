"""Encodes a tick as log records. Angles are converted to degrees, as in ArduPilot's logs."""

import math
from collections.abc import Iterator
from typing import Final

from companion.autopilot.snapshot import Snapshot
from companion.core import readings
from companion.core.geo import LocalFrame, bearing_rad, distance_m, position_to_e7
from companion.core.state import Demand, NavState
from companion.core.units import GPS_EPOCH_UNIX_S, GPS_WEEK_S, clamp, deg_to_e7, wrap_pi, wrap_two_pi
from companion.core.vectors import Vector
from companion.estimation.estimator import EstimatorReport
from companion.estimation.innovation import GATE_2
from companion.log import records as r
from companion.sensors.compass.magnetic_field import FieldCorrector

_DEG: Final = 180.0 / math.pi
_NAN: Final = math.nan
_LOGGED_CHANNELS: Final = 14
_RANGE_GOOD, _RANGE_TOO_FAR = 4, 3  # RangeFinder status
_SOUNDER: Final = 1  # RNGFND2, as in DISTANCE_SENSOR; the ranger is 0


def _degrees(heading_rad: float) -> float:
    return wrap_two_pi(heading_rad) * _DEG


def time_us(time_s: float) -> int:
    """A time since boot as in records."""
    return max(round(time_s * 1e6), 0)


def motion(now: Snapshot) -> Iterator[bytes]:
    """Motion and steering."""
    us, nav, demand, command = time_us(now.now_s), now.vehicle.nav, now.guidance.demand, now.command
    left, right = command.left, command.right
    yield r.RCOU.pack(us, *now.output_us[:_LOGGED_CHANNELS])
    if nav is None:
        return
    yaw_deg = _degrees(nav.heading_rad)
    wanted_deg = yaw_deg if demand is None else _degrees(demand.heading_rad)
    compass = now.sensors.compass
    roll_deg = 0.0 if compass is None else (compass.roll_rad or 0.0) * _DEG
    pitch_deg = 0.0 if compass is None else (compass.pitch_rad or 0.0) * _DEG
    yield r.ATT.pack(us, 0.0, roll_deg, 0.0, pitch_deg, wanted_deg, yaw_deg, 0)
    if now.sensors.field is not None and compass is not None and compass.field_mg is not None:
        yield _magnetometer(us, now.sensors.field, compass.field_mg)
    yield r.BOAT.pack(
        us, nav.surge_m_s, nav.sway_m_s, nav.yaw_rate_rad_s * _DEG, nav.position_age_s, nav.heading_age_s
    )
    yield r.EST.pack(us, nav.current_north_m_s, nav.current_east_m_s, nav.position_sigma_m, nav.faults)
    yield from _around(now, us, nav)
    centideg = round(yaw_deg * 100.0) % 36000
    yield r.XKF1.pack(
        us, 0, 0, 0, centideg, nav.north_m_s, nav.east_m_s, 0.0, 0.0, nav.north_m, nav.east_m, 0.0, 0, 0, 0, 0
    )
    if now.vehicle.frame is not None:
        yield r.POS.pack(us, *_place_e7(now.vehicle.frame, nav), 0.0, 0.0, 0.0)
    turn_rad_s = nav.yaw_rate_rad_s
    steering = 2250.0 * (left - right) + 4500.0 * command.rudder
    yield r.STER.pack(us, 0, steering, _NAN, nav.surge_m_s * turn_rad_s, _NAN, turn_rad_s * _DEG)
    wanted_m_s = _NAN if demand is None else demand.speed_m_s
    yield r.THR.pack(us, 0, 50.0 * (left + right), wanted_m_s, nav.surge_m_s, _NAN)
    if demand is not None:
        yield from _loops(now, us, nav, demand, centideg)


def _place_e7(frame: LocalFrame, nav: NavState) -> tuple[int, int]:
    return position_to_e7(frame.to_global(nav.point))


def _magnetometer(us: int, corrector: FieldCorrector, measured: Vector) -> bytes:
    """As ArduPilot's: the corrected field, the offsets, and what was added for the motors, in mG."""
    correction, limit = corrector.correction, 32767.0
    motor_load = corrector.load.of(correction.motor_source)
    values = (
        *corrector.correct(measured),
        *correction.offset,
        *(one * motor_load for one in correction.motor),
    )
    return r.MAG.pack(us, 0, *(round(clamp(one, -limit, limit)) for one in values), 1, us)


def estimator(us: int, report: EstimatorReport, compass_gate_rad: float) -> Iterator[bytes]:
    """The filter's inside: innovations and test ratios as ArduPilot's XKF3 and XKF4, where 1 is the gate;
    standard deviations, sensor errors, and probabilities that a sensor is wrong.
    """
    velocity, compass = (report.velocity_north, report.velocity_east), report.compass
    position = report.position_north, report.position_east
    yield r.XKF3.pack(
        us, 0, *(_int16(one.value * 100.0) for one in velocity), 0,
        *(_int16(one.value * 100.0) for one in position), 0, 0, 0, 0, _int16(compass.value * _DEG * 100.0), 0,
        0.0, 0.0,
    )  # fmt: skip
    ratios = (
        math.sqrt(sum(one.nis for one in velocity) / GATE_2),
        math.sqrt(sum(one.nis for one in position) / GATE_2),
        0.0,
        abs(compass.value) / compass_gate_rad,
        0.0,
    )
    yield r.XKF4.pack(us, 0, *(_int16(one * 100.0) for one in ratios), 0.0, 0.0, 0.0, 0, 0, 0, 0, 0)
    deviations = [math.sqrt(report.covariance[one][one]) for one in range(len(report.state))]
    north, east, heading, surge, _, current_n, current_e, bias, offset, gain, gnss_n, gnss_e, _ = deviations
    yield r.ESD.pack(
        us, north, east, heading * _DEG, surge, current_n, current_e, bias * _DEG, offset * _DEG, gain,
        gnss_n, gnss_e,
    )  # fmt: skip
    bias, offset, gain, gnss_n, gnss_e, delay = report.state[7:]
    yield r.EBIA.pack(us, bias * _DEG, offset * _DEG, gain, gnss_n, gnss_e, delay)
    if report.hypotheses:
        yield r.EHYP.pack(us, *(probability for _, probability in report.hypotheses))


def _int16(value: float) -> int:
    return round(clamp(value, -32767.0, 32767.0))


def payload(now: Snapshot) -> Iterator[bytes]:
    """Values given to the payload in this tick, and images taken, with the place."""
    us, here = time_us(now.now_s), now.payload.position
    lat_e7, lon_e7 = (0, 0) if here is None else (deg_to_e7(here.lat_deg), deg_to_e7(here.lon_deg))
    for title, value in now.payload.written:
        yield r.PAYL.pack(us, title.encode()[:16], value, lat_e7, lon_e7)
    for image in now.payload.images:
        if image.fault:
            continue
        place, yaw = image.position, image.heading_rad
        yield r.CAM.pack(
            time_us(image.time_s), 0, image.index & 0xFFFF, 0, 0,
            0 if place is None else deg_to_e7(place.lat_deg),
            0 if place is None else deg_to_e7(place.lon_deg),
            0, 0, 0, 0, 0, 0 if math.isnan(yaw) else round(_degrees(yaw) * 100.0) % 36000,
        )  # fmt: skip


def _around(now: Snapshot, us: int, nav: NavState) -> Iterator[bytes]:
    """Obstacles and avoidance: dR0 is the paper's equation 1, to the nearest obstacle; Cls the closing speed
    of the nearest mover. Nothing without obstacles.
    """
    perception, avoidance = now.guidance.perception, now.guidance.avoidance
    if perception is None or avoidance is None or perception.is_empty:
        return
    here, now_s = nav.point, now.now_s
    nearest_m = min((distance_m(here, thing) for thing in perception.solid()), default=_NAN)
    movers = perception.tracks.movers(now_s)
    closing = _NAN
    if movers:
        mover = min(movers, key=lambda one: one.distance_m(here, now_s))
        closing = mover.closing_m_s(here, nav.north_m_s, nav.east_m_s, now_s)
    limit = avoidance.limit.ahead_m_s
    yield r.AVD.pack(
        us, avoidance.stage, limit if math.isfinite(limit) else _NAN, nearest_m, len(movers), closing
    )


def _loops(now: Snapshot, us: int, nav: NavState, demand: Demand, centideg: int) -> Iterator[bytes]:
    if (pid := now.guidance.helm.heading_pid) is not None:
        wanted, actual = demand.heading_rad, nav.heading_rad
        error_deg = wrap_pi(wanted - actual) * _DEG
        yield r.PIDS.pack(
            us, _degrees(wanted), _degrees(actual), error_deg, pid.p, pid.i, pid.d, pid.ff, 0.0,
            0.0, pid.saturated,
        )  # fmt: skip
    if (speed_pid := now.guidance.helm.speed_pid) is not None:
        error_m_s = demand.speed_m_s - nav.surge_m_s
        yield r.PIDA.pack(
            us, demand.speed_m_s, nav.surge_m_s, error_m_s, speed_pid.p, speed_pid.i, speed_pid.d,
            speed_pid.ff, 0.0, 0.0, speed_pid.saturated,
        )  # fmt: skip
    target_deg = wanted_deg = _degrees(demand.heading_rad)
    if now.vehicle.frame is not None and (target := now.vehicle.destination) is not None:
        target_deg = _degrees(bearing_rad(nav.point, now.vehicle.frame.to_local(target)))
    yield r.NTUN.pack(us, demand.distance_m, target_deg, wanted_deg, centideg, demand.cross_track_m)


def gnss(fix: readings.GnssFix) -> Iterator[bytes]:
    """A fix, at its own time; week and time of week give the date of the log."""
    week, ms = 0, 0
    if fix.unix_time_s is not None:
        weeks, seconds = divmod(fix.unix_time_s - GPS_EPOCH_UNIX_S, GPS_WEEK_S)
        week, ms = int(clamp(weeks, 0.0, 65535.0)), round(seconds * 1e3)
    speed_m_s, course_deg = _NAN, _NAN
    if fix.north_m_s is not None and fix.east_m_s is not None:
        speed_m_s = math.hypot(fix.north_m_s, fix.east_m_s)
        course_deg = _degrees(math.atan2(fix.east_m_s, fix.north_m_s))
    us = time_us(fix.time_s)
    yield r.GPS.pack(
        us, 0, fix.fix_type, ms, week, min(fix.satellites, 255), _cents(fix.hdop, 32767),
        deg_to_e7(fix.position.lat_deg), deg_to_e7(fix.position.lon_deg), _cents(fix.altitude_m, 2**31 - 1),
        speed_m_s, course_deg, 0.0, 0.0 if fix.heading_rad is None else _degrees(fix.heading_rad), 1,
    )  # fmt: skip
    if fix.horizontal_accuracy_m is not None:
        accuracies = fix.horizontal_accuracy_m, fix.vertical_accuracy_m or 0.0, fix.speed_accuracy_m_s or 0.0
        yaw_deg = _NAN if fix.heading_accuracy_rad is None else fix.heading_accuracy_rad * _DEG
        limited = (_cents(one, 65535) for one in accuracies)
        yield r.GPA.pack(us, 0, 0, *limited, yaw_deg, 0, us // 1000 & 0xFFFFFFFF, 0, 0.0, 0)


def _cents(value: float, most: int) -> int:
    """Hundredths, limited to the field; the maximum if not finite."""
    return round(clamp(value * 100.0, -most, most)) if math.isfinite(value) else most


def heading(reading: readings.HeadingReading) -> bytes:
    """A heading reading as the estimator has it, at its own time."""
    rate = reading.yaw_rate_rad_s
    return r.HDG.pack(
        time_us(reading.time_s), _degrees(reading.heading_rad), _NAN if rate is None else rate * _DEG
    )


def sonar(ping: readings.SonarReading) -> Iterator[bytes]:
    """A ping, at its own time: RFND in eighths of a turn as in ArduPilot, SONR with its bearing."""
    us = time_us(ping.time_s)
    eighth = round(wrap_two_pi(ping.bearing_rad) / (math.pi / 4.0)) % 8
    is_clear = ping.range_m is None
    range_m = ping.max_range_m if ping.range_m is None else ping.range_m
    yield r.RFND.pack(us, 0, _cents(range_m, 65535), _RANGE_TOO_FAR if is_clear else _RANGE_GOOD, eighth)
    yield r.SONR.pack(us, ping.bearing_rad * _DEG, _NAN if is_clear else range_m, ping.max_range_m)


def depth(sounding: readings.DepthReading, nav: NavState, frame: LocalFrame) -> bytes:
    """A sounding, at its own time and where the boat is now: below the transducer, NaN without a bottom. The
    quality is in percent, -1 if not reported, as in ArduPilot's RFND.
    """
    depth_m = _NAN if sounding.depth_m is None else sounding.depth_m
    temperature_c = _NAN if sounding.temperature_c is None else sounding.temperature_c
    quality = -1 if sounding.quality is None else round(100.0 * sounding.quality)
    return r.DPTH.pack(
        time_us(sounding.time_s), _SOUNDER, *_place_e7(frame, nav), depth_m, temperature_c, quality,
        sounding.transducer_m,
    )  # fmt: skip


def probe(reading: readings.ProbeReading, nav: NavState, frame: LocalFrame) -> bytes:
    """A probe's value, at its own time and where the boat is now."""
    name, unit = reading.name.encode("ascii"), reading.unit.encode("ascii")
    return r.PROB.pack(time_us(reading.time_s), name, reading.value, *_place_e7(frame, nav), unit)


def battery(reading: readings.BatteryReading, consumed_mah: float, capacity_mah: float) -> bytes:
    """The pack, at the reading's time. RemPct is from the counted charge, as in Rover."""
    current_a = _NAN if reading.current_a is None else reading.current_a
    left_percent = round(clamp(100.0 * (1.0 - consumed_mah / capacity_mah), 0.0, 100.0))
    return r.BAT.pack(
        time_us(reading.time_s), 0, reading.voltage_v, _NAN, current_a, consumed_mah, _NAN, 0, _NAN,
        left_percent, 1, 0,
    )  # fmt: skip


def esc(reading: readings.EscReading) -> bytes:
    """A speed controller, at the reading's time, as ArduPilot's; a temperature that is not measured is 0."""
    rpm = reading.shaft_rad_s * 60.0 / math.tau
    celsius = _cents(reading.temperature_c, 32767), _cents(reading.motor_c or 0.0, 32767)
    return r.ESC.pack(
        time_us(reading.time_s), reading.side, rpm, rpm, reading.voltage_v, reading.current_a, celsius[0],
        reading.consumed_mah, celsius[1], 0.0,
    )  # fmt: skip


def radio(reading: readings.RcReading) -> Iterator[bytes]:
    """The RC channels, at their own time; the signal if known."""
    us = time_us(reading.time_s)
    pulses = [min(max(pulse_us, 0), 0xFFFF) for pulse_us in reading.channels_us[:_LOGGED_CHANNELS]]
    yield r.RCIN.pack(us, *pulses, *[0] * (_LOGGED_CHANNELS - len(pulses)))
    if reading.quality is not None:
        signal_dbm = _NAN if reading.rssi_dbm is None else reading.rssi_dbm
        yield r.RSSI.pack(us, signal_dbm, 100.0 * reading.quality)


def text(us: int, line: str) -> Iterator[bytes]:
    """A status text; a long one in several records."""
    raw = line.encode("ascii", errors="replace")
    for start in range(0, max(len(raw), 1), 64):
        yield r.MSG.pack(us, raw[start : start + 64])
