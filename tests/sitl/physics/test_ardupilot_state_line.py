"""The state line as ArduPilot reads it: by its documented scan, which is not a JSON parser.

The rules (ArduPilot 4.7, SIM_JSON): a datagram's last text between two line ends counts. For each entry of a
table, the section's name is looked for from the beginning of the line, the key's name from one character
behind it; the value stands two characters behind the key. A vector is read by sscanf("[%lf, %lf, %lf]"): the
bracket must stand right there, blanks in the format match any number of blanks, and numbers skip those before
them. A scalar is read by atof. A required entry that is missing, or a vector that does not scan, makes the
line useless.
"""

import ctypes
import dataclasses
import math
import struct

import pytest

from companion.core.geo import LatLon, LocalFrame, Point
from companion.core.readings import SonarReading
from sitl.physics.backend import Backend
from sitl.physics.json_interface import NO_ECHO_M, sphere_offset, state_line
from sitl.scenarios.scenario import load_scenario
from sitl.world.world import World

# (section, key, is a vector, is required), in the order of its table
TABLE = (
    ("", "timestamp", False, True),
    ("imu", "gyro", True, True),
    ("imu", "accel_body", True, True),
    ("", "position", True, True),
    ("", "attitude", True, False),
    ("", "quaternion", True, False),
    ("", "velocity", True, True),
    ("", "rng_1", False, False),
)
BUFFER_BYTES = 65000
LIBC = ctypes.CDLL(None)
LIBC.atof.restype = ctypes.c_double

Value = float | tuple[float, ...]


class SilentSonar:
    """A sonar that hears nothing any more."""

    def read(self) -> list[SonarReading]:
        return []

    def set_sector(self, port_rad: float, starboard_rad: float) -> None:
        """Nowhere."""

    def close(self) -> None:
        """Nothing to let go."""


class UnreadableError(Exception):
    """ArduPilot would not take this line."""


def scan_vector(text: str) -> tuple[float, ...]:
    """By the C library's own sscanf, which is what ArduPilot calls."""
    values = [ctypes.c_double(math.nan) for _ in range(3)]
    found = LIBC.sscanf(text.encode(), b"[%lf, %lf, %lf]", *map(ctypes.byref, values))
    if found != 3:
        raise UnreadableError(f"sscanf found {found} of 3 numbers in {text[:30]!r}")
    return tuple(value.value for value in values)


def ardupilot_reads(datagram: bytes) -> dict[str, Value]:
    """What ArduPilot would know after this datagram."""
    assert len(datagram) < BUFFER_BYTES
    end = datagram.rfind(b"\n")
    begin = datagram.rfind(b"\n", 0, end)
    if begin < 0:
        raise UnreadableError("no text between two line ends")
    line = datagram[begin + 1 : end].decode("ascii")
    known: dict[str, Value] = {}
    for section, key, is_vector, is_required in TABLE:
        start = line.find(section)
        at = -1 if start < 0 else line.find(key, start + len(section) + 1)
        if at < 0:
            if is_required:
                raise UnreadableError(f"{section}/{key} is missing")
            continue
        text = line[at + len(key) + 2 :]
        if is_vector:
            known[key] = scan_vector(text)
            continue
        known[key] = float(LIBC.atof(text.encode()))
    return known


def ardupilot_place(origin: LatLon, north_m: float, east_m: float, down_m: float = 0.0) -> LatLon:
    """Where ArduPilot is then: Location::offset_latlng, with whole units of 1e-7 degrees."""
    per_m, lat, lon = 89.83204953368922, int(origin.lat_deg * 1e7), int(origin.lon_deg * 1e7)
    lat_step = int(north_m * per_m)
    scale = max(math.cos((lat + lat_step // 2) * 1e-7 * math.pi / 180.0), 0.01)
    lon_step = int(east_m * per_m / scale)
    return LatLon((lat + lat_step) * 1e-7, math.remainder((lon + lon_step) * 1e-7, 360.0))


@pytest.mark.parametrize("lat_deg", [0.0, 50.0, -60.0, 75.0])
@pytest.mark.parametrize("point", [Point(3000.0, 0.0), Point(-1500.0, 4000.0), Point(0.0, -5000.0)])
def test_ardupilot_is_where_the_scenario_is(lat_deg: float, point: Point) -> None:
    frame = LocalFrame(LatLon(lat_deg, 179.99))
    there = frame.to_global(point)
    place = ardupilot_place(frame.origin, *sphere_offset(frame.origin, there))
    found = frame.to_local(place)
    assert math.hypot(found.north_m - point.north_m, found.east_m - point.east_m) < 0.03


def packet(frame: int, left: int = 1500, right: int = 1500, rate_hz: int = 100) -> bytes:
    """Servo outputs 1 and 3."""
    return struct.pack("<HHI16H", 18458, rate_hz, frame, left, 1500, right, *[1500] * 13)


def read(backend: Backend, data: bytes) -> dict[str, Value]:
    line = backend.handle(data)
    assert line is not None
    return ardupilot_reads(line)


def vector(known: dict[str, Value], key: str) -> tuple[float, ...]:
    value = known[key]
    assert isinstance(value, tuple)
    return value


@pytest.mark.parametrize("settings", [(), ("environment.current_m_s=1.0", "environment.gust_m_s=8.0")])
def test_every_line_is_read_and_means_the_boats_true_state(settings: tuple[str, ...]) -> None:
    backend = Backend(load_scenario("lake", settings))
    frame = backend.world.scenario.frame
    for number in range(1, 500):
        known = read(backend, packet(number, 1900, 1600))
        truth = backend.world.truth
        assert known["timestamp"] == truth.time_s
        place = ardupilot_place(frame.origin, *vector(known, "position"))
        there = frame.to_local(place)
        assert (there.north_m, there.east_m) == pytest.approx((truth.north_m, truth.east_m), abs=0.02)
        assert known["attitude"] == (0.0, 0.0, truth.heading_rad)
        assert known["velocity"] == (truth.north_m_s, truth.east_m_s, 0.0)
        assert known["gyro"] == (0.0, 0.0, truth.yaw_rate_rad_s)
        assert vector(known, "accel_body")[2] == pytest.approx(-9.80665)


def test_numbers_of_any_size_are_read() -> None:
    world = World(load_scenario("open"))
    for yaw_rate in (1e-9, -3.25e-17, 123456.789, -0.0):
        now = world.truth._replace(yaw_rate_rad_s=yaw_rate)
        assert ardupilot_reads(state_line(now, now, Point(0.0, 0.0), None))["gyro"] == (0.0, 0.0, yaw_rate)


def test_an_echo_that_ends_goes_far_away_and_does_not_stay() -> None:
    backend = Backend(load_scenario("pool"))
    ranges = [read(backend, packet(frame))["rng_1"] for frame in range(1, 400)]
    assert min(float(value) for value in ranges if isinstance(value, float)) <= 4.0
    backend.world.hardware = dataclasses.replace(backend.world.hardware, sonar=SilentSonar())
    for frame in range(400, 800):  # 4 s
        known = read(backend, packet(frame))
    assert known["rng_1"] == NO_ECHO_M


def test_the_boat_is_moored_until_a_motor_is_driven_and_lets_go_without_a_jerk() -> None:
    backend = Backend(load_scenario("open", ("environment.current_m_s=1.0", "environment.wind_m_s=8.0")))
    start = backend.world.scenario.start
    for frame in range(1, 1000):  # ten seconds, with outputs a little off their centre
        known = read(backend, packet(frame, 1505, 0))
        assert known["position"] == pytest.approx((start.north_m, start.east_m, 0.0), abs=1e-6)
        assert known["velocity"] == (0.0, 0.0, 0.0)
        assert vector(known, "accel_body")[:2] == pytest.approx((0.0, 0.0), abs=1e-9)
    assert known["timestamp"] == pytest.approx(9.99)
    for frame in range(1000, 1500):
        known = read(backend, packet(frame, 1515 if frame < 1010 else 1500))
        assert math.hypot(*vector(known, "accel_body")[:2]) < 10.0  # all at once it would be 100
    assert math.hypot(*vector(known, "velocity")) > 0.3, "the water does not carry the boat"
