"""Each part on a serial device, with its thread: read, unplugged, plugged in, read again, closed."""

import array
import fcntl
import os
import threading
import time
from collections.abc import Callable
from typing import Any, NamedTuple

import pytest
from twins.bno085 import Bno085Twin
from twins.escs import VescTwin, kiss_frame
from twins.lidars import Ld06Twin, RplidarTwin
from twins.lines import HandClock, PtyLine, eventually, opened
from twins.rangers import a02yyuw_frame, tfmini_frame
from twins.sounders import Ping1dTwin
from twins.ubx_messages import sentence
from twins.ubx_receiver import ZED_F9P, UbxReceiver
from twins.ubx_serial import SerialReceiver

from companion.app.hardware import begin_probes
from companion.app.parts import open_ais, open_compass, open_depth, open_esc, open_lidar
from companion.config.boat_config import BoatConfig, decode_config
from companion.config.sensors import GnssPart, RangerPart
from companion.config.tuning import Rc
from companion.hal.gnss.receiver import open_nmea_gnss
from companion.hal.gnss.ubx import open_ubx_gnss
from companion.hal.ranging.mounted_ranger import open_ranger
from companion.hal.rc_receiver import open_rc_receiver

CRSF = bytes.fromhex("c81816e0031ff8c0073ef0810f7ce0031ff8c0073ef0810f7cad")
IBUS = bytes.fromhex("2040" + "dc05" * 14 + "51f3")
SBUS = bytes.fromhex("0fe0031ff8c0073ef0810f7ce0031ff8c0073ef0810f7c0000")
_TCGETS2 = 0x802C542A


class Open(NamedTuple):
    """An opened part. talk: what the far end does meanwhile; value: of a reading."""

    part: Any
    talk: Callable[[], None]
    value: Callable[[Any], object]


def parts(device: str, **table: object) -> BoatConfig:
    return decode_config({"parts": {key: {"port": device, **value} for key, value in table.items()}}, "test")  # type: ignore[dict-item]


def gnss(line: PtyLine, clock: HandClock) -> Open:
    def talk() -> None:
        at = f"0927{clock() % 60.0:05.2f}"
        line.say(sentence(f"GNRMC,{at},A,5030.0,N,00112.0,W,2.0,90.0,280524,,,A"))
        line.say(sentence(f"GNGGA,{at},5030.0,N,00112.0,W,1,7,0.85,12.5,M,47.0,M,,"))

    part = open_nmea_gnss(GnssPart(driver="nmea", port=line.device), clock)
    return Open(part, talk, lambda fix: fix.satellites == 7)


def ubx(line: PtyLine, clock: HandClock) -> Open:
    peer = SerialReceiver(line, UbxReceiver(ZED_F9P))
    part = open_ubx_gnss(GnssPart(driver="ubx", port=line.device, rate_hz=10.0), time.monotonic)
    return Open(
        part, peer.run, lambda fix: fix.north_m_s == pytest.approx(1.2) and peer.receiver.baud == 115_200
    )


def compass(line: PtyLine, clock: HandClock) -> Open:
    part = open_compass(parts(line.device, compass={"driver": "nmea", "correction_rad": 0.1}), clock)
    return Open(
        part, lambda: line.say(sentence("HEHDT,0.0,T")), lambda one: one.heading_rad == pytest.approx(0.1)
    )


def bno085(line: PtyLine, clock: HandClock) -> Open:
    twin = Bno085Twin()
    twin.heading_deg = 45.0

    def talk() -> None:
        twin.hear(line.heard())
        line.say(twin.speak(0.02))

    part = open_compass(parts(line.device, compass={"driver": "bno085"}), clock)
    return Open(part, talk, lambda one: one.heading_rad == pytest.approx(0.7854, abs=0.002))


def nmea_depth(line: PtyLine, clock: HandClock) -> Open:
    part = open_depth(parts(line.device, depth={"driver": "nmea", "max_range_m": 90.0}), clock)
    return Open(
        part,
        lambda: line.say(sentence("SDDPT,3.25,0.0")),
        lambda one: (one.depth_m, one.max_range_m) == (3.25, 90.0),
    )


def ais(line: PtyLine, clock: HandClock) -> Open:
    report = b"!AIVDM,1,1,,B,177KQJ5000G?tO`K>RA1wUbN0TKH,0*5C\r\n"
    part = open_ais(parts(line.device, ais={"driver": "nmea"}), clock)
    return Open(part, lambda: line.say(report), lambda one: one.vessels[0].mmsi == 477_553_000)


def ping1d(line: PtyLine, clock: HandClock) -> Open:
    twin = Ping1dTwin()
    part = open_depth(parts(line.device, depth={"driver": "ping1d"}), clock)
    return Open(part, lambda: twin.live(line), lambda one: one.depth_m == 3.25)


def a02yyuw(line: PtyLine, clock: HandClock) -> Open:
    part = open_ranger(RangerPart(driver="a02yyuw", port=line.device), clock)
    return Open(part, lambda: line.say(a02yyuw_frame(1953)), lambda one: one.range_m == 1.953)


def tfmini(line: PtyLine, clock: HandClock) -> Open:
    part = open_ranger(RangerPart(driver="tfmini", port=line.device), clock)
    return Open(
        part,
        lambda: line.say(tfmini_frame(300)),
        lambda one: (one.range_m, one.bearing_rad, one.min_range_m, one.max_range_m) == (3.0, 0.0, 0.1, 12.0),
    )


def ld06(line: PtyLine, clock: HandClock) -> Open:
    twin = Ld06Twin(lambda _: (3000, 200))
    part = open_lidar(parts(line.device, lidar={"driver": "ld06"}), clock)
    return Open(part, lambda: line.say(twin.say(0.05)), lambda one: one.range_m == 3.0)


def rplidar(line: PtyLine, clock: HandClock) -> Open:
    twin = RplidarTwin(lambda _: (3000, 15))
    part = open_lidar(parts(line.device, lidar={"driver": "rplidar_a1"}), clock)

    def talk() -> None:
        line.say(twin.hear(line.heard()) + twin.say(0.05))

    return Open(part, talk, lambda one: one.range_m == 3.0)


def kiss(line: PtyLine, clock: HandClock) -> Open:
    part = open_esc(
        decode_config(
            {"parts": {"motors": {"driver": "esc", "telemetry": "kiss", "left_port": line.device}}}, "test"
        ),
        clock,
    )
    frame = kiss_frame(31, 1542, 873, 210, 143)
    return Open(part, lambda: line.say(frame), lambda one: one.temperature_c == 31)


def vesc(line: PtyLine, clock: HandClock) -> Open:
    twin = VescTwin(clock)
    part = open_esc(
        decode_config({"parts": {"motors": {"driver": "vesc", "left_port": line.device}}}, "test"), clock
    )
    return Open(part, lambda: line.say(twin.hear(line.heard())), lambda one: one.fault == "")


def rc(driver: str, frame: bytes, channels: int) -> Callable[[PtyLine, HandClock], Open]:
    def open_it(line: PtyLine, clock: HandClock) -> Open:
        receiver = open_rc_receiver(Rc(driver=driver, port=line.device), clock)  # type: ignore[arg-type]
        return Open(receiver, lambda: line.say(frame), lambda one: len(one.channels_us) == channels)

    return open_it


KINDS = {
    "nmea gnss": gnss, "u-blox": ubx, "nmea compass": compass, "bno085": bno085, "nmea depth": nmea_depth,
    "ais": ais, "ping1d": ping1d, "a02yyuw": a02yyuw, "tfmini": tfmini, "crsf": rc("crsf", CRSF, 16),
    "ld06": ld06, "rplidar_a1": rplidar, "ibus": rc("ibus", IBUS, 14), "sbus": rc("sbus", SBUS, 18),
    "kiss": kiss, "vesc": vesc,
}  # fmt: skip


@pytest.mark.realtime
@pytest.mark.parametrize("kind", KINDS)
def test_a_part_on_a_device_is_read_and_again_after_it_was_unplugged(
    line: PtyLine, clock: HandClock, kind: str
) -> None:
    part, talk, value = KINDS[kind](line, clock)
    since_s = 0.0

    def is_read() -> bool:
        clock.advance(0.1)
        talk()
        latest = part.read()
        latest = latest[-1] if isinstance(latest, list | tuple) and latest else latest
        return bool(latest) and latest.time_s > since_s and bool(value(latest))

    try:
        eventually(is_read)
        line.unplug()
        line.plug_in()
        since_s = part.read().time_s if kind == "u-blox" else clock()
        eventually(is_read)
    finally:
        part.close()
        part.close()
    assert not [one for one in threading.enumerate() if one.name.endswith("uart") and one.is_alive()]


@pytest.mark.realtime
def test_probes_on_one_device_share_it(line: PtyLine, clock: HandClock) -> None:
    serial = {"driver": "serial", "port": line.device}
    tables = [{"name": "ph", "column": 0, **serial}, {"name": "other", "driver": "file", "path": "/nowhere"},
              {"name": "cond", "column": 1, "unit": "uS/cm", **serial}]  # fmt: skip
    probes = begin_probes(decode_config({"probe": tables}, "test"), clock, opened)

    def has_value() -> bool:
        line.say(b"7.1 1413\n")
        return probes[2].read() is not None

    try:
        eventually(has_value)
        read = [
            None if (one := probe.read()) is None else (one.name, one.value, one.unit) for probe in probes
        ]
        assert read == [("ph", 7.1, ""), None, ("cond", 1413.0, "uS/cm")]
    finally:
        for probe in probes:
            probe.close()


def test_the_line_has_the_speed_of_crossfire_which_is_no_usual_one(line: PtyLine) -> None:
    receiver = open_rc_receiver(Rc(driver="crsf", port=line.device), HandClock())
    try:
        descriptor = os.open(line.device, os.O_RDWR | os.O_NOCTTY)
        settings = array.array("i", [0] * 64)
        fcntl.ioctl(descriptor, _TCGETS2, settings)
        os.close(descriptor)
        assert settings[9:11].tolist() == [420000, 420000]
    finally:
        receiver.close()
