"""Scanning lidars on their lines: read, silent, unplugged, ill, and started again."""

import math

import pytest
from twins.lidars import Echo, Ld06Twin, RplidarTwin
from twins.lines import HandClock, MemoryLine

from companion.config.sensors import LidarPart
from companion.core.readings import SonarReading
from companion.core.status_text import Severity
from companion.hal.ranging.scanning_lidar import Rplidar, ScanningLidar, open_lidar
from companion.links.memory import MemoryPort
from companion.links.serial_port import LINE_8N1, LineFormat

STEP_S = 0.02
LD06, A1 = LidarPart(driver="ld06"), LidarPart(driver="rplidar_a1")


def post(first_deg: float, last_deg: float, millimetres: int) -> Echo:
    return lambda angle_deg: (millimetres, 47) if first_deg <= angle_deg <= last_deg else (0, 0)


def echoes(readings: list[SonarReading]) -> dict[int, float]:
    return {round(math.degrees(one.bearing_rad)): one.range_m for one in readings if one.range_m is not None}


class Bench:
    """A part on its line; time goes by in steps of a tick."""

    def __init__(self, wire: MemoryLine, clock: HandClock, twin: Ld06Twin | RplidarTwin) -> None:
        self.wire, self.clock, self.twin = wire, clock, twin
        if isinstance(twin, Ld06Twin):
            self.part: ScanningLidar = ScanningLidar(wire.port, clock, LD06)
        else:
            self.part = Rplidar(wire.port, clock, A1)

    def run(self, seconds: float, is_heard: bool = True) -> list[SonarReading]:
        """What it has read meanwhile. is_heard: the part has power."""
        readings: list[SonarReading] = []
        for _ in range(round(seconds / STEP_S)):
            self.part.step()
            heard = self.wire.heard()
            answer = self.twin.hear(heard) if isinstance(self.twin, RplidarTwin) and is_heard else b""
            said = answer + self.twin.say(STEP_S)
            self.clock.advance(STEP_S)
            if is_heard and said:
                self.wire.say(said)
            self.part.step()
            readings += self.part.read()
        return readings


@pytest.fixture
def ld06(wire: MemoryLine, clock: HandClock) -> Bench:
    return Bench(wire, clock, Ld06Twin(post(28.0, 32.0, 3210)))


@pytest.fixture
def a1(wire: MemoryLine, clock: HandClock) -> Bench:
    return Bench(wire, clock, RplidarTwin(post(268.0, 272.0, 1500)))


def test_an_ld06_is_read_as_it_sends(ld06: Bench) -> None:
    readings = ld06.run(0.5)
    assert echoes(readings) == {30: 3.21}
    assert len({one.bearing_rad for one in readings}) == 72
    assert ld06.part.reader.skipped == 0
    assert all(ld06.clock() - 0.5 < one.time_s <= ld06.clock() for one in readings)
    assert [one.time_s for one in readings] == sorted(one.time_s for one in readings)
    assert ld06.part.read() == []


def test_an_ld06_that_is_unplugged_is_read_again(ld06: Bench) -> None:
    ld06.run(0.25)
    ld06.wire.say(ld06.twin.say(0.003)[:20])
    ld06.part.step()
    ld06.wire.plug_in()
    assert echoes(ld06.run(0.5)) == {30: 3.21}
    assert ld06.part.reader.skipped == 0, "the half packet is forgotten"


def test_an_rplidar_is_stopped_asked_for_its_health_and_started(a1: Bench) -> None:
    readings = a1.run(1.0)
    assert a1.twin.requests == b"\x25\x52\xf0\x20"  # type: ignore[union-attr]
    assert echoes(readings) == {-90: 1.5}
    assert len({one.bearing_rad for one in readings}) == 72
    assert a1.part.take_texts() == []
    a1.run(10.0)
    assert a1.twin.requests == b"\x25\x52\xf0\x20", "once is enough"  # type: ignore[union-attr]


def test_an_rplidar_that_was_left_scanning_is_started_anew(a1: Bench) -> None:
    a1.twin.hear(b"\xa5\x20")  # type: ignore[union-attr]
    assert echoes(a1.run(1.0)) == {-90: 1.5}


def test_an_rplidar_that_lost_its_supply_is_started_again(a1: Bench) -> None:
    a1.run(1.0)
    a1.twin.power_up()  # type: ignore[union-attr]
    assert a1.run(2.9) == []
    assert echoes(a1.run(1.5)) == {-90: 1.5}


def test_an_rplidar_that_is_plugged_in_again_is_started_again(a1: Bench) -> None:
    a1.run(1.0)
    a1.wire.plug_in()
    a1.twin.power_up()  # type: ignore[union-attr]
    assert echoes(a1.run(4.0)) == {-90: 1.5}


def test_a_silent_rplidar_is_asked_every_three_seconds(a1: Bench) -> None:
    assert a1.run(9.0, is_heard=False) == []
    assert echoes(a1.run(4.0)) == {-90: 1.5}


def test_an_ill_rplidar_is_told_and_reset_and_its_recovery_told(a1: Bench) -> None:
    twin = a1.twin
    assert isinstance(twin, RplidarTwin)
    twin.health, twin.heals = (2, 0x8001), False
    assert a1.run(8.0) == []
    assert twin.requests.count(b"\x40") == 4
    assert b"\x20" not in twin.requests
    texts = a1.part.take_texts()
    assert [(one.severity, one.text) for one in texts] == [
        (Severity.ERROR, "Lidar: hardware error, code 0x8001")
    ]
    twin.heals = True
    assert echoes(a1.run(6.0)) == {-90: 1.5}
    assert [one.text for one in a1.part.take_texts()] == ["Lidar: good again, code 0x0000"]


def test_a_warning_of_an_rplidar_is_told_and_it_scans(a1: Bench) -> None:
    a1.twin.health = 1, 0  # type: ignore[union-attr]
    assert echoes(a1.run(1.0)) == {-90: 1.5}
    assert [one.text for one in a1.part.take_texts()] == ["Lidar: warning, code 0x0000"]


@pytest.mark.parametrize(
    ("driver", "baud", "is_ready"), [("ld06", 230_400, True), ("rplidar_a1", 115_200, False)]
)
def test_a_lidar_has_its_own_baud_rate_and_an_rplidar_dtr_low_for_its_motor(
    monkeypatch: pytest.MonkeyPatch, wire: MemoryLine, driver: str, baud: int, is_ready: bool
) -> None:
    opened: list[tuple[str, int, bool]] = []

    def open_line(place: str, rate: int, _: object, line: LineFormat = LINE_8N1) -> MemoryPort:
        opened.append((place, rate, line.is_ready))
        return wire.port

    monkeypatch.setattr("companion.hal.ranging.scanning_lidar.open_line", open_line)
    for rate in (0, 256_000):
        part = LidarPart(driver=driver, port="/dev/ttyUSB7", baud=rate)  # type: ignore[arg-type]
        open_lidar(part, HandClock()).close()
    assert opened == [("/dev/ttyUSB7", baud, is_ready), ("/dev/ttyUSB7", 256_000, is_ready)]


def test_a_lidar_needs_no_sector(ld06: Bench) -> None:
    ld06.part.set_sector(-0.1, 0.1)
    assert len({one.bearing_rad for one in ld06.run(0.5)}) == 72
