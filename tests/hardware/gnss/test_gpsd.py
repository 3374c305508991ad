"""gpsd's reports as its manual documents them, and its server coming and going."""

import math
import os
import shutil
import socket
import subprocess
import time
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from twins.gpsd import DEVICES, GREETING, GpsdServer, line, sky, tpv
from twins.lines import HandClock, MemoryLine, PtyLine, eventually, known
from twins.ubx_messages import Motion, nav_pvt

from companion.config.sensors import GnssPart
from companion.core.readings import GnssFix
from companion.hal.gnss.gpsd import GpsdGnss, open_gpsd_gnss
from companion.sensors.gpsd import GpsdReader

# The examples of the manual, which an older gpsd wrote
MANUAL_TPV = (
    b'{"class":"TPV","device":"/dev/pts/1","time":"2005-06-08T10:34:48.283Z","ept":0.005,"lat":46.498293369,'
    b'"lon":7.567411672,"alt":1343.127,"eph":36.000,"epv":32.321,"track":10.3788,"speed":0.091,"climb":-0.085,'
    b'"mode":3}\r\n'
)
MANUAL_SKY = (
    b'{"class":"SKY","device":"/dev/pts/1","time":"2005-07-08T11:28:07.114Z","xdop":1.55,"hdop":1.24,"pdop":1.99,'
    b'"satellites":[{"PRN":23,"el":6,"az":84,"ss":0,"used":false},{"PRN":8,"el":66,"az":189,"ss":44,"used":true},'
    b'{"PRN":10,"el":51,"az":304,"ss":29,"used":true}]}\r\n'
)


def fix_of(*reports: dict[str, object]) -> GnssFix:
    reader = GpsdReader(0.1)
    fixes = [fix for report in reports for fix in reader.feed(line(report), 10.0)]
    assert reader.malformed == 0
    return fixes[-1]


def test_a_report_of_a_modern_gpsd_is_a_whole_fix() -> None:
    fix = fix_of(GREETING, DEVICES, sky(uSat=11), tpv(0.2))
    assert (fix.position.lat_deg, fix.position.lon_deg) == (50.5, -1.2)
    assert (fix.north_m_s, fix.east_m_s) == (0.0, 1.5)
    assert (fix.fix_type, fix.satellites, fix.hdop, fix.altitude_m) == (3, 11, 0.85, 12.5)
    assert (fix.horizontal_accuracy_m, fix.vertical_accuracy_m, fix.speed_accuracy_m_s) == (1.6, 3.0, None)
    assert fix.unix_time_s == pytest.approx(1_716_888_420.2)
    assert fix.time_s == pytest.approx(9.9)


def test_the_examples_of_the_manual_are_read() -> None:
    reader = GpsdReader(0.1)
    assert reader.feed(MANUAL_SKY, 10.0) == []
    (fix,) = reader.feed(MANUAL_TPV, 10.0)
    assert (fix.satellites, fix.hdop, fix.altitude_m) == (2, 1.24, 1343.127)
    assert fix.north_m_s == pytest.approx(0.091 * math.cos(math.radians(10.3788)))
    assert fix.horizontal_accuracy_m == 36.0


@pytest.mark.parametrize(
    ("mode", "status", "fix_type"),
    [
        (1, 0, 1),
        (2, 1, 2),
        (3, 0, 3),
        (3, 2, 4),
        (3, 3, 6),
        (3, 4, 5),
        (3, 5, 1),
    ],
)
def test_mode_and_status_give_the_fix_type(mode: int, status: int, fix_type: int) -> None:
    fix = fix_of(tpv(0.0, mode=mode, status=status))
    assert fix.fix_type == fix_type
    assert (fix.north_m_s is None) == (fix_type == 1)
    assert (fix.unix_time_s is None) == (fix_type == 1)


def test_without_a_fix_the_last_position_stays_and_a_working_receiver_shows() -> None:
    reader = GpsdReader(0.0)
    reader.feed(line(tpv(0.0)), 10.0)
    (fix,) = reader.feed(b'{"class":"TPV","device":"/dev/ttyACM0","mode":1}\r\n', 11.0)
    assert (fix.fix_type, fix.position.lat_deg) == (1, 50.5)


def test_an_error_that_gpsd_computed_from_the_hdop_is_not_the_receivers() -> None:
    assert (
        fix_of(sky(), tpv(0.0, eph=16.150)).horizontal_accuracy_m is None
    )  # 19 × 0.85, as gpsd 3.22 sent it
    assert fix_of(sky(), tpv(0.0, eph=4.038)).horizontal_accuracy_m is None
    assert fix_of(sky(), tpv(0.0, eph=16.30)).horizontal_accuracy_m == 16.30


def test_one_epoch_is_one_fix() -> None:
    reader = GpsdReader(0.0)
    fixes = [
        fix for second in (0.0, 0.0, 0.2, 0.2, 0.4) for fix in reader.feed(line(tpv(second)), 10.0 + second)
    ]
    assert len(fixes) == 3


@given(st.binary(max_size=300))
def test_garbage_is_counted_and_the_next_line_is_read(garbage: bytes) -> None:
    reader = GpsdReader(0.0)
    reader.feed(garbage + b"\n", 10.0)
    assert len(reader.feed(line(tpv(0.0)), 10.0)) == 1


@pytest.mark.parametrize(
    "wrong",
    [
        b'{"class":"TPV"}',
        b'{"class":"TPV","mode":"3"}',
        b'{"class":"TPV","mode":3,"lat":null',
        b"[]",
        b'{"class":"TPV","mode":3,"time":"\xb2"}',
    ],
)
def test_truncated_and_mistyped_reports_are_dropped(wrong: bytes) -> None:
    reader = GpsdReader(0.0)
    assert reader.feed(wrong + b"\r\n", 10.0) == []
    assert reader.malformed == 1


def test_a_silent_gpsd_is_reported_and_so_is_its_return(wire: MemoryLine, clock: HandClock) -> None:
    gnss = GpsdGnss(wire.port, clock, 0.0, 5.0)
    gnss.step()
    assert wire.heard() == b'?WATCH={"enable":true,"json":true};\n'
    clock.advance(5.1)
    gnss.step()
    assert [text for _, text in gnss.take_texts()] == ["GNSS: gpsd is silent"]
    wire.say(line(tpv(0.0)))
    gnss.step()
    assert [text for _, text in gnss.take_texts()] == ["GNSS: gpsd measures again"]


@pytest.mark.realtime
def test_a_restarted_gpsd_is_found_again() -> None:
    clock, server = HandClock(), GpsdServer()
    part = GnssPart(driver="gpsd", port=f"127.0.0.1:{server.port}")
    gnss = open_gpsd_gnss(part, clock)

    def hears(satellites: int) -> bool:
        clock.advance(0.2)
        server.serve()
        server.send(line(sky(satellites)) + line(tpv(clock() % 60.0))[:40])
        server.send(line(tpv(clock() % 60.0))[40:])
        return (fix := gnss.read()) is not None and fix.satellites == satellites

    eventually(lambda: hears(7))
    server.close()
    server = GpsdServer(server.port)
    eventually(lambda: hears(5))
    gnss.close()
    gnss.close()
    server.close()


@pytest.mark.realtime
def test_the_real_gpsd_with_a_u_blox_receiver_gives_fixes(tmp_path: Path) -> None:
    program = shutil.which("gpsd", path=f"{os.environ['PATH']}:/usr/sbin")
    if program is None:
        pytest.skip("gpsd is not installed")
    device, began_s, sent = PtyLine(tmp_path / "ttyGNSS"), time.monotonic(), [0]
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    command = [program, "-N", "-n", "-S", str(port), os.path.realpath(device.device)]
    with subprocess.Popen(command, stderr=subprocess.DEVNULL) as process:
        gnss = open_gpsd_gnss(GnssPart(driver="gpsd", port=f"127.0.0.1:{port}"), time.monotonic)

        def has_fix() -> bool:
            if time.monotonic() - began_s > 0.1 * sent[0]:
                sent[0] += 1
                device.say(nav_pvt(216_000_000 + 100 * sent[0], Motion()))
            return gnss.read() is not None

        try:
            eventually(has_fix)
        finally:
            gnss.close()
            process.terminate()
    device.unplug()
    fix = known(gnss.read())
    assert (fix.position.lat_deg, fix.position.lon_deg, fix.fix_type) == (50.5, -1.2, 3)
    assert fix.horizontal_accuracy_m == pytest.approx(1.5)
    assert (fix.north_m_s, fix.east_m_s) == pytest.approx((1.2, -0.3), abs=0.01)
