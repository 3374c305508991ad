"""What is fuzzed: one function a target, bytes in; whatever it raises is a find."""

import contextlib
import math
import struct
import tempfile
from collections.abc import Callable, Iterator
from importlib import import_module
from pathlib import Path

from fastcrc.crc8 import dvb_s2 as crc8
from pymavlink.dialects.v20 import all as dialect
from twins.escs import kiss_crc, vesc_frame
from twins.lidars import crc8 as lidar_crc8

from companion.config.boat_config import BoatConfig, load_config
from companion.config.parameter_pack import PackError, unpack_upload
from companion.config.sensors import LidarPart, ProbePart
from companion.config.tuning import Rc
from companion.core.errors import ConfigError, HardwareError
from companion.hal.ping1d import PingReader
from companion.hal.probes import raw_number, value_of
from companion.hal.ranging.serial_ranger import (
    A02YYUW,
    TFMINI,
    RangerReader,
    a02yyuw_range_m,
    tfmini_range_m,
)
from companion.mavlink.codec import Decoder
from companion.rc.parsers import CrsfParser, IbusParser, SbusParser
from companion.rc.rc_control import RcControl
from companion.sensors.esc_frames import EscParser, KissParser, VescParser
from companion.sensors.framing import FrameReader
from companion.sensors.gnss_heading import GnssHeading
from companion.sensors.gpsd import GpsdReader
from companion.sensors.lidar import ld06, rplidar
from companion.sensors.lidar.sectors import SectorScan
from companion.sensors.nmea.ais import AisReader
from companion.sensors.nmea.depth import DEPTH_SENTENCES, DepthAssembler
from companion.sensors.nmea.fix import FixAssembler
from companion.sensors.nmea.heading import HeadingAssembler
from companion.sensors.nmea.sentences import NmeaReader
from companion.sensors.rtcm import RtcmReader, crc24q
from companion.sensors.ubx.frames import NAV_RELPOSNED, UbxReader, encode
from companion.sensors.ubx.messages import UbxFixAssembler, baseline
from companion.sensors.ubx.setup import UbxSetup
from companion.vehicle.vehicle import Vehicle
from fuzz.frames import frame
from fuzz.fuzzed_boat import hear
from fuzz.map_targets import map_geojson, map_gpx, map_kml, map_mask

_MESSAGES = sorted(dialect.mavlink_map)
_MOST_FRAMES = 48
_HANDLED = (
    *("HEARTBEAT", "COMMAND_LONG", "COMMAND_INT", "SET_MODE", "PARAM_REQUEST_LIST"),
    *("PARAM_REQUEST_READ", "PARAM_SET", "REQUEST_DATA_STREAM", "MANUAL_CONTROL", "RC_CHANNELS_OVERRIDE"),
    *("SET_POSITION_TARGET_GLOBAL_INT", "SET_POSITION_TARGET_LOCAL_NED", "SET_ATTITUDE_TARGET", "TIMESYNC"),
    *("PING", "SYSTEM_TIME", "RADIO_STATUS", "LOG_REQUEST_LIST", "LOG_REQUEST_DATA", "LOG_ERASE"),
    *("LOG_REQUEST_END", "GPS_INPUT", "VISION_POSITION_ESTIMATE", "ODOMETRY", "OBSTACLE_DISTANCE"),
    *("DISTANCE_SENSOR", "SETUP_SIGNING", "FILE_TRANSFER_PROTOCOL", "MISSION_SET_CURRENT", "STATUSTEXT"),
    *("SET_HOME_POSITION", "SET_GPS_GLOBAL_ORIGIN", "MISSION_COUNT", "MISSION_ITEM_INT", "MISSION_ITEM"),
)
_PROBES = (
    ProbePart(name="all", driver="file", path="x"),
    ProbePart(name="column", driver="file", path="x", column=1, scale=1e30),
    ProbePart(name="pattern", driver="file", path="x", pattern=r"t=(-?\d+)", invalid=(85000.0,)),
)
_RADIO = BoatConfig(rc=Rc(arm_channel=5, mode_channel=6))
_MISSION = (
    *("MISSION_COUNT", "MISSION_ITEM_INT", "MISSION_ITEM", "MISSION_REQUEST_LIST", "MISSION_REQUEST_INT"),
    *("MISSION_REQUEST", "MISSION_ACK", "MISSION_CLEAR_ALL", "MISSION_SET_CURRENT"),
    *("MISSION_WRITE_PARTIAL_LIST", "MISSION_REQUEST_PARTIAL_LIST", "HEARTBEAT", "COMMAND_LONG"),
)
_NUMBERS = {kind.msgname: number for number, kind in dialect.mavlink_map.items()}
_PATHS = (
    *(b"@PARAM/param.pck", b"@PARAM/param.pck?withdefaults=1", b"@MISSION/mission.dat", b"@SYS/uptime.txt"),
    *(b"/", b"", b"..", b"/../../etc/passwd", b"/logs", b"/APM/LOGS/1.BIN", b"/general.json", b"a" * 239),
)


def codec_stream(data: bytes) -> None:
    """A byte stream in pieces; the first byte says how long they are."""
    _decode(data[1:], datagram=False, piece=1 + (data[0] if data else 0))


def codec_datagram(data: bytes) -> None:
    """Datagrams."""
    _decode(data[1:], datagram=True, piece=8 * (1 + (data[0] if data else 0)))


def _decode(data: bytes, *, datagram: bool, piece: int) -> None:
    decoder = Decoder(datagram)
    received = [r for at in range(0, len(data), piece) for r in decoder.feed(data[at : at + piece])]
    assert decoder.counters.bytes_in == len(data)
    assert decoder.counters.frames_in == len(received)
    assert sum(len(one.frame) for one in received) <= len(data)
    for one in received:
        assert one.message.get_type()
        one.message.to_dict()


def services(data: bytes) -> None:
    """Frames of any message that the boat may act on, fields as they come; now and then of any other."""
    hear(_frames(data, [_NUMBERS[name] for name in _HANDLED]))


def missions(data: bytes) -> None:
    """The mission protocol, in any order; item counts stay small and types are real ones mostly."""
    hear(_frames(data, [_NUMBERS[name] for name in _MISSION]))


def files(data: bytes) -> None:
    """MAVLink FTP requests with sequence numbers that mostly go up, and paths that are worth asking for."""
    hear(_file_requests(data), ticks=6)


def _frames(data: bytes, numbers: list[int]) -> Iterator[bytes]:
    """Each frame: a byte for the message, one for how much of its payload follows, then that."""
    at = 0
    for sequence in range(_MOST_FRAMES):
        if at + 2 > len(data):
            return
        choice, length = data[at], data[at + 1]
        number = (
            numbers[choice % len(numbers)]
            if choice < 240
            else _MESSAGES[(choice * 256 + length) % len(_MESSAGES)]
        )
        yield frame(number, data[at + 2 : at + 2 + length], sequence, 255 - choice % 2)
        at += 2 + length


def _file_requests(data: bytes) -> Iterator[bytes]:
    """Each request: opcode, session, path or none, step of the sequence, size, offset (2 bytes)."""
    number, sequence = _NUMBERS["FILE_TRANSFER_PROTOCOL"], 0
    for at in range(0, min(len(data) - 6, 7 * _MOST_FRAMES), 7):
        opcode, session, path, step, size, low, high = data[at : at + 7]
        sequence = (sequence + (1 if step < 200 else step - 228)) & 0xFFFF
        body = _PATHS[path % 32] if path % 32 < len(_PATHS) else data[at : at + size]
        offset = low | high << 8 | (0xFFFF0000 if high == 0xFF else 0)
        size = size if path & 0x40 else len(body)
        head = struct.pack(
            "<HBBBBBBI", sequence, session % 8, opcode % 24, size & 0xFF, 0, path >> 7, 0, offset
        )
        yield frame(number, b"\0\0\0" + (head + body)[:251], at)


def nmea(data: bytes) -> None:
    """A receiver's and a compass's bytes; checksums are mended, so that more than noise gets through."""
    reader = NmeaReader(frozenset({"GGA", "RMC", "VTG", "GSA", "GLL", "HDT", "HDG", "HDM", "THS", "ZDA"}))
    fixes, headings = FixAssembler(), HeadingAssembler()
    mended = b"\n".join(_with_checksum(line) for line in data.split(b"\n"))
    for at in range(0, len(mended), 61):
        for sentence in reader.feed(mended[at : at + 61]):
            for fix in fixes.feed(sentence, at * 0.01):
                assert abs(fix.position.lat_deg) <= 90.0
            headings.feed(sentence, at * 0.01)
    assert len(reader._held) <= 256


def sounders(data: bytes) -> None:
    """What sensors on serial lines send; the first byte says which. Checksums are mended."""
    which, said = data[0] % 10 if data else 0, data[1:]
    if which >= 8:
        _esc(said, is_vesc=which == 9)
    elif which >= 6:
        _lidar(said, is_ld06=which == 6)
    elif which < 2:
        kind = (A02YYUW, TFMINI)[which]
        frames = RangerReader(kind)
        for at in range(0, len(said), kind.length - 2):
            body = kind.header + said[at : at + kind.length - 1 - len(kind.header)]
            for found in frames.split(body + bytes([sum(body) & 0xFF])):
                with contextlib.suppress(HardwareError):
                    range_m = a02yyuw_range_m(found) if which == 0 else tfmini_range_m(found, 100)
                    assert range_m is None or 0.0 <= range_m <= 656.0
        assert len(frames._held) < kind.length
    elif which == 2:
        ping = PingReader()
        for at in range(0, len(said), 7):
            body = b"BR" + said[at : at + 7]
            ping.split(body + (sum(body) & 0xFFFF).to_bytes(2, "little"))
        assert len(ping._held) < 270
    elif which == 3:
        reader, depths = NmeaReader(DEPTH_SENTENCES), DepthAssembler(0.0, 0.3, 100.0)
        mended = b"\n".join(_with_checksum(line) for line in said.split(b"\n"))
        for number, sentence in enumerate(reader.feed(mended)):
            reading = depths.feed(sentence, number)
            assert reading is None or reading.depth_m is None or 0.0 < reading.depth_m <= 100.0
    elif which == 5:
        ais = AisReader(import_module("pyais").decode)
        for number, line in enumerate(said.split(b"\n")):
            ais.feed(_with_checksum(line) + b"\n", number)
        assert len(ais._held) < 260
    else:
        for part in _PROBES:
            value = value_of(raw_number(said.decode("utf-8", "replace"), part), part)
            assert value is None or math.isfinite(value)


def _esc(said: bytes, *, is_vesc: bool) -> None:
    parser: EscParser = VescParser(0, 7) if is_vesc else KissParser(0, 7)
    for at in range(0, len(said), 9):
        body = said[at : at + 9]
        sent = vesc_frame(b"\x04" + said[at : at + 70]) if is_vesc else body + bytes([kiss_crc(body)])
        for one in parser.feed(sent, 0.001 * at) or ():
            values = one.shaft_rad_s, one.voltage_v, one.current_a, one.temperature_c, one.consumed_mah
            assert all(map(math.isfinite, values))
    assert len(parser._held) < 260


def _lidar(said: bytes, *, is_ld06: bool) -> None:
    scan = SectorScan(LidarPart(driver="ld06" if is_ld06 else "rplidar_a1"))
    frames: FrameReader = ld06.Ld06Reader() if is_ld06 else rplidar.RplidarReader()
    for number in range(0, len(said), 44):
        body = b"\x54\x2c" + said[number : number + 44].ljust(44, b"\0")
        found = frames.split(body + bytes([lidar_crc8(body)]) if is_ld06 else said[number : number + 44])
        rays = ld06.rays_of(found) if is_ld06 else rplidar.rays_of(found)
        for one in scan.add(rays, 0.001 * number, 0.0005):
            assert one.range_m is None or one.min_range_m <= one.range_m <= one.max_range_m
    assert len(frames._held) < 64


def _with_checksum(line: bytes) -> bytes:
    if not line.startswith((b"$", b"!")):
        return line
    body = line[1:].partition(b"*")[0].rstrip(b"\r")
    check = 0
    for byte in body:
        check ^= byte
    return line[:1] + body + b"*%02X\r" % check


def gnss(data: bytes) -> None:
    """Bytes of a u-blox receiver, of gpsd, or of corrections: the first one says which, the second how long
    the pieces are; UBX checksums are mended.
    """
    kind, piece, said = data[0] % 3 if data else 0, 1 + (data[1] if len(data) > 1 else 0), data[2:]
    if kind == 0:
        said = _with_ubx_checksums(said)
    pieces = [said[at : at + piece] for at in range(0, len(said), piece)]
    if kind == 1:
        gpsd = GpsdReader(0.1)
        for number, one in enumerate(pieces):
            for fix in gpsd.feed(one, 0.1 * number):
                assert abs(fix.position.lat_deg) <= 90.0
    elif kind == 2:
        rtcm = RtcmReader()
        for one in pieces:
            assert not any(crc24q(whole) for whole in rtcm.feed(one))
    else:
        _ubx(pieces)


def _ubx(pieces: list[bytes]) -> None:
    reader, assembler, setup = UbxReader(), UbxFixAssembler(0.1), UbxSetup(115_200, 5.0, wants_baseline=True)
    heading, now_s = GnssHeading(baseline_m=1.0), 0.0
    for one in pieces:
        now_s += 0.3
        for heard in reader.feed(one)[0]:
            setup.on_frame(heard, now_s)
            fix = assembler.feed(heard, now_s)
            assert fix is None or abs(fix.position.lon_deg) <= 180.0
            if heard.kind == NAV_RELPOSNED and (found := baseline(heard.payload)) is not None:
                heading.on_baseline(found, now_s)
        setup.tick(now_s)
        heading.tick(now_s, lambda severity, text: None)
        assert sum(map(len, setup.take_outbox())) < 400
        assert all(len(text) < 100 for _, text in setup.take_texts())


def _with_ubx_checksums(data: bytes) -> bytes:
    mended, at = bytearray(data), 0
    while (at := data.find(b"\xb5\x62", at)) >= 0:
        end = at + 6 + int.from_bytes(data[at + 4 : at + 6], "little")
        if len(data) >= end + 2:
            kind = int.from_bytes(data[at + 2 : at + 4], "big")
            mended[at : end + 2] = encode(kind, bytes(mended[at + 6 : end]))
        at += 2
    return bytes(mended)


def radio(data: bytes) -> None:
    """An RC receiver's bytes and the pauses between them: the first two say which protocol, and how long the
    pieces are; CRSF's checksums are mended. What it says reaches a boat's sticks and switches.
    """
    parser = (CrsfParser, IbusParser, SbusParser)[data[0] % 3 if data else 0]()
    piece, said = 1 + (data[1] if len(data) > 1 else 0), data[2:]
    if isinstance(parser, CrsfParser):
        said = _with_crc(said)
    vehicle, rc_control, now_s = Vehicle(_RADIO), RcControl(), 0.0
    for at in range(0, len(said), piece):
        now_s += 0.001 * (1 + said[at] % 8)
        reading = parser.feed(said[at : at + piece], now_s)
        assert len(parser._held) < 64
        if reading is not None:
            assert min(reading.channels_us, default=0) >= 0
            assert max(reading.channels_us, default=0) <= 0xFFFF
            actions = rc_control.update(
                reading, vehicle.manual_input, vehicle.mode, vehicle.armed, vehicle.config, now_s
            )
            for request in actions.requests:
                vehicle.request(request)


def _with_crc(data: bytes) -> bytes:
    mended, at = bytearray(data), 0
    while at + 2 < len(mended):
        end = at + 1 + mended[at + 1]
        if mended[at] != 0xC8 or not at + 2 < end < len(mended):
            at += 1
            continue
        mended[end] = crc8(bytes(mended[at + 2 : end]))
        at = end + 1
    return bytes(mended)


def config(data: bytes) -> None:
    """A configuration file: it is read, or refused in one line."""
    with tempfile.NamedTemporaryFile(suffix=".toml") as file:
        file.write(data)
        file.flush()
        try:
            load_config(Path(file.name))
        except ConfigError:
            return


def parameter_file(data: bytes) -> None:
    """A packed parameter file that a station sends."""
    try:
        unpack_upload(data)
    except PackError:
        return


TARGETS: dict[str, Callable[[bytes], None]] = {
    target.__name__: target
    for target in (
        codec_stream,
        codec_datagram,
        services,
        missions,
        files,
        nmea,
        sounders,
        gnss,
        radio,
        config,
        parameter_file,
        map_geojson,
        map_kml,
        map_gpx,
        map_mask,
    )
}
