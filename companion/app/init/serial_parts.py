"""Finds parts on serial ports by what they send, and the receiver that gpsd owns.

All ports are listened to at once, rate by rate. Only then is a GNSS receiver, or a line that was silent,
asked what changes nothing: UBX-MON-VER, the device information of the Ping protocol, an RPLIDAR's health.
"""

import os
import re
import socket
import time
from collections import Counter
from collections.abc import Callable, Generator, Iterator
from contextlib import closing, suppress
from functools import partial
from itertools import islice
from typing import Any, Final, NamedTuple

from companion.app.init.findings import COMPASS, GNSS, Found
from companion.app.init.presets import Value
from companion.core.errors import LinkError
from companion.hal import ping1d, raspberry_pi
from companion.hal.heading import bno085
from companion.hal.ranging.serial_ranger import A02YYUW, TFMINI, RangerReader
from companion.links.serial_port import LINE_8E2, LINE_8N1, LineFormat, SerialPort
from companion.mavlink.codec import Decoder
from companion.mavlink.dialect import dialect
from companion.rc.parsers import CrsfParser, IbusParser, SbusParser
from companion.sensors.framing import FrameReader
from companion.sensors.lidar import ld06, rplidar
from companion.sensors.nmea.sentences import LineReader, NmeaReader
from companion.sensors.sh2 import ShtpReader
from companion.sensors.ubx.frames import MON_VER, UbxReader, encode

_AUTOPILOT: Final = "parts.autopilot"
_DEPTH, _SONAR, _RC = "parts.depth.driver", "parts.sonar.driver", "rc.driver"
GPSD: Final = ("127.0.0.1", 2947)
CONSOLE: Final = "the system's console; boat-companion doctor --fix frees it"
NOTHING: Final = "silent, or no supported part"
_LISTEN_S: Final = 3.0  # three epochs of a GNSS receiver; on a crowded line an answer waits for two
_PAUSE_S: Final = 0.005
_BAUDS: Final = (9600, 115_200, 38_400, 4800)
_FIXES, _DEPTHS = frozenset({"RMC", "GGA", "GNS"}), frozenset({"DPT", "DBT"})
_HEADINGS: Final = frozenset({"HDT", "THS", "HPR", "HDG", "HDM"})
_AIS: Final = re.compile(rb"![A-Z]{2}VD[MO],.+\*[0-9A-F]{2}")


class SerialRow(NamedTuple):
    """What a part sends, and at which rates. question: makes a part speak that says nothing by itself."""

    key: str
    driver: str
    bauds: tuple[int, ...]
    reader: Callable[[], Any]
    question: bytes = b""
    line: LineFormat = LINE_8N1


_PING_REQUEST: Final = ping1d.encode(6, bytes((4, 0)))  # general_request: device_information
# Of two rows for one use the upper one comes first. Rates are tried in the order of the rows.
ROWS: Final = (
    SerialRow(GNSS, "ubx", _BAUDS, UbxReader, encode(MON_VER)),
    SerialRow(GNSS, "nmea", _BAUDS, partial(NmeaReader, _FIXES)),
    SerialRow(COMPASS, "bno085", (bno085.BAUD,), ShtpReader),
    SerialRow(COMPASS, "nmea", _BAUDS, partial(NmeaReader, _HEADINGS)),
    SerialRow(_DEPTH, "ping1d", (ping1d.BAUD,), ping1d.PingReader, _PING_REQUEST),
    SerialRow(_DEPTH, "nmea", _BAUDS, partial(NmeaReader, _DEPTHS)),
    SerialRow("parts.ais.driver", "nmea", (38_400,), LineReader),
    SerialRow(_SONAR, "a02yyuw", (A02YYUW.baud,), partial(RangerReader, A02YYUW)),
    SerialRow(_SONAR, "tfmini", (TFMINI.baud,), partial(RangerReader, TFMINI)),
    SerialRow("parts.lidar.driver", "ld06", (ld06.BAUD,), ld06.Ld06Reader),
    SerialRow("parts.lidar.driver", "rplidar_a1", (rplidar.BAUD,), rplidar.RplidarReader, rplidar.GET_HEALTH),
    SerialRow(_AUTOPILOT, "autopilot", (115_200, 57_600, 921_600), partial(Decoder, datagram=False)),
    SerialRow(_RC, "crsf", (CrsfParser.baud,), CrsfParser),
    SerialRow(_RC, "ibus", (IbusParser.baud,), IbusParser),
    SerialRow(_RC, "sbus", (SbusParser.baud,), SbusParser, line=LINE_8E2),
)


def _count(reader: object, data: bytes, time_s: float) -> int:
    """The frames that bytes complete."""
    match reader:
        case SbusParser():
            return reader.feed(data, time_s) is not None
        case ping1d.PingReader():  # a Ping360 gives its device information (4), too, as type 2
            return sum(frame[4] != 4 or frame[8] == 1 for frame in reader.split(data))
        case FrameReader():
            return len(reader.split(data))
        case UbxReader():
            return len(reader.feed(data)[0])
        case NmeaReader() | ShtpReader():
            return len(reader.feed(data))
        case Decoder():  # a station is none
            beats = (one.message for one in reader.feed(data) if one.message.get_type() == "HEARTBEAT")
            return sum(beat.autopilot == dialect.MAV_AUTOPILOT_ARDUPILOTMEGA for beat in beats)
        case LineReader():
            return sum(_AIS.fullmatch(line) is not None for line in reader.lines(data))
    raise TypeError(reader)


_RANKS: Final = {(row.key, row.driver): rank for rank, row in enumerate(ROWS)}
_STAGES: Final = dict.fromkeys(
    [(baud, row.line, b"") for row in ROWS for baud in row.bauds]
    + [(baud, row.line, row.question) for row in ROWS for baud in row.bauds if row.question]
)


def find_serial_parts(
    now: Callable[[], float] = time.monotonic, wait: Callable[[float], None] = time.sleep
) -> Iterator[Found | str]:
    """Parts and remarks, of every port that nobody uses."""
    arguments = ""
    with suppress(OSError):  # what the kernel was told
        arguments = (raspberry_pi.ROOT / "proc/cmdline").read_text(encoding="utf-8", errors="replace")
    reasons = {_real(f"/dev/{name}"): CONSOLE for name in re.findall(r"\bconsole=(\w+)", arguments)}
    if owned := _devices_of_gpsd():
        place = f"{GPSD[0]}:{GPSD[1]}"
        reasons |= {_real(device): f"owned by gpsd at {place}" for device in owned}
        yield Found(GNSS, "gpsd", place, {GNSS: "gpsd", "parts.gnss.port": place})
    devices, parts = list(_devices()), list[Found]()
    yield from (f"{device}: {reasons[_real(device)]}" for device in devices if _real(device) in reasons)
    running = {device: _examine(device, now) for device in devices if _real(device) not in reasons}
    if running:
        longest_s = _LISTEN_S * (1 + sum(not question for *_, question in _STAGES))
        yield f"listening on {', '.join(running)}, for {longest_s:.0f} s at most"
    while running:
        for device, examination in list(running.items()):
            try:
                next(examination)
                continue
            except StopIteration as end:
                parts += end.value
                yield f"{device}: {', '.join(part.driver for part in end.value) or NOTHING}"
            except LinkError as error:
                yield str(error)
            del running[device]
        wait(_PAUSE_S)
    yield from sorted(parts, key=lambda part: _RANKS.get((part.key, part.driver), len(_RANKS)))


def _examine(device: str, now: Callable[[], float]) -> Generator[None, None, list[Found]]:
    """Yields while it waits for bytes; returns the parts. Only a line that is silent at first is asked."""
    is_silent: bool | None = None
    for baud, line, question in _STAGES:
        if is_silent is not None and is_silent != bool(question):
            continue
        heard = yield from _hear(device, baud, line, question, now)
        if heard[GNSS, "nmea"] and not heard[GNSS, "ubx"]:
            heard += yield from _hear(device, baud, line, encode(MON_VER), now)
        if parts := _parts(device, baud, heard):
            return parts
        is_silent = not heard if is_silent is None else is_silent
    return []


def _hear(
    device: str, baud: int, line: LineFormat, question: bytes, now: Callable[[], float]
) -> Generator[None, None, Counter[tuple[str, str]]]:
    """Frames by key and driver; empty if no bytes arrive."""
    length, heard = 0, Counter[tuple[str, str]]()
    readers = [(row, row.reader()) for row in ROWS if baud in row.bauds and row.line == line]
    with closing(SerialPort(str(raspberry_pi.ROOT / device[1:]), baud, now, line=line)) as port:
        (link,) = port.accept()
        if question:
            link.send(question)
        until_s = now() + _LISTEN_S
        while now() < until_s:
            yield
            for data in link.receive():
                length += len(data)
                for row, reader in readers:
                    heard[row.key, row.driver] += _count(reader, data, now())
    for row, reader in readers:  # where most bytes belong to no frame, frames are chance
        if isinstance(reader, FrameReader) and 2 * reader.skipped > length:
            heard[row.key, row.driver] = 0
    return heard


def _parts(device: str, baud: int, heard: Counter[tuple[str, str]]) -> list[Found]:
    """One part a line; but a GNSS receiver's may have sentences of depth and heading, too."""
    parts: dict[str, Found] = {}
    for row in (row for row in ROWS if heard[row.key, row.driver]):
        driver, section = row.driver, row.key.removesuffix("driver")
        values: dict[str, Value] = {row.key: driver, f"{section}port": device}
        values |= {f"{section}baud": baud} if driver == "nmea" else {}
        doubt = "another part has its line" if parts else ""
        if row.key == _AUTOPILOT:
            values, doubt = {row.key: f"serial:{device}:{baud}"}, "name in the file which parts are its"
        elif GNSS in parts and row.key == COMPASS:
            driver, values, doubt = "gnss", {row.key: "gnss"}, "has it two antennas?"
        elif GNSS in parts and row.key == _DEPTH and parts[GNSS].driver == "nmea":
            driver, values, doubt = "gnss", {row.key: "gnss"}, ""
        parts.setdefault(row.key, Found(row.key, driver, f"{device}, {baud} baud", values, doubt))
    return list(parts.values())


def _devices() -> Iterator[str]:
    """Each port once, by the name that stays with it. /dev/serial1 is a Pi's Bluetooth."""
    seen = {_real("/dev/serial1")}
    for pattern in ("mavboat-*", "serial/by-id/*", "serial0", "ttyAMA*", "ttyUSB*", "ttyACM*"):
        for path in sorted((raspberry_pi.ROOT / "dev").glob(pattern)):
            device = f"/{path.relative_to(raspberry_pi.ROOT)}"
            if _real(device) not in seen:
                seen.add(_real(device))
                yield device


def _real(device: str) -> str:
    return os.path.realpath(raspberry_pi.ROOT / device[1:])


def _devices_of_gpsd() -> list[str]:
    """Those that it has opened (gpsd_json(5), ?DEVICES)."""
    try:
        with socket.create_connection(GPSD, timeout=1.0) as line, line.makefile("rb") as answers:
            line.sendall(b"?DEVICES;\n")
            report = next((one for one in islice(answers, 9) if b'"class":"DEVICES"' in one), b"")
    except OSError:
        return []
    return [path.decode(errors="replace") for path in re.findall(rb'"path":"([^"]+)"', report)]
