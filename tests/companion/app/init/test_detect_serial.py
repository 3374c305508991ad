"""Parts are found on serial ports by what they send at their rate, and none is written to before."""

import socket
import threading
from collections.abc import Callable
from contextlib import closing
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from pymavlink.dialects.v20 import ardupilotmega as mavlink
from twins.bno085 import Bno085Twin
from twins.gpsd import DEVICE, GpsdServer
from twins.lidars import Ld06Twin, RplidarTwin
from twins.lines import HandClock, PtyLine
from twins.rangers import a02yyuw_frame, tfmini_frame
from twins.serial_ports import RMC, STEP_S, Device, SerialBench, Speak, every_s, plug_in_ports, receiver
from twins.sounders import Ping1dTwin
from twins.ubx_messages import sentence
from twins.ubx_receiver import MAX_M10, NEO_6M, NEO_M8N, ZED_F9P, Model

from companion.app.init.findings import Found
from companion.app.init.serial_parts import CONSOLE, NOTHING, find_serial_parts
from companion.links.serial_port import LINE_8E2, SerialPort

# The example of the protocol's page; FlySky's and Futaba's frames by the descriptions that the parsers name
CRSF = bytes.fromhex("c81816e0031ff8c0073ef0810f7ce0031ff8c0073ef0810f7cad")
IBUS = (body := b"\x20\x40" + b"\xdc\x05" * 14) + (0xFFFF - sum(body)).to_bytes(2, "little")
SBUS = b"\x0f" + CRSF[3:25] + b"\x00\x00"
AIS = b"!AIVDM,1,1,,B,177KQJ5000G?tO`K>RA1wUbN0TKH,0*5C\r\n"  # of gpsd's page on AIVDM
LD06 = Ld06Twin()


@pytest.fixture
def bench(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> SerialBench:
    return plug_in_ports(monkeypatch, tmp_path)


def find(bench: SerialBench) -> tuple[list[Found], list[str]]:
    """Parts, and what is told of ports without one."""
    everything = list(find_serial_parts(bench.clock, bench.wait))
    parts = [one for one in everything if isinstance(one, Found)]
    passed = ("listening", *(f"{part.where.partition(',')[0]}:" for part in parts))
    return parts, [one for one in everything if isinstance(one, str) and not one.startswith(passed)]


def silent_ping(twin: Ping1dTwin) -> Device:
    """It passes over what is of another protocol."""
    return Device(115_200, lambda _: b"", lambda data: twin.hear(data) if data.startswith(b"BR") else b"")


def talking_bno085() -> Speak:
    """As the boat left it."""
    twin = Bno085Twin()
    twin.features = {0x05: 0.02}
    return lambda _: twin.speak(STEP_S)


PORTS = {
    "a02yyuw": (Device(9600, every_s(0.1, a02yyuw_frame(1953))), "parts.sonar"),
    "tfmini": (Device(115_200, every_s(0.01, tfmini_frame(300))), "parts.sonar"),
    "ld06": (Device(230_400, lambda _: LD06.say(STEP_S)), "parts.lidar"),
    "crsf": (Device(420_000, every_s(0.02, CRSF)), "rc"),
    "ibus": (Device(115_200, every_s(0.007, IBUS)), "rc"),
    "sbus": (Device(100_000, every_s(0.05, SBUS), line=LINE_8E2), "rc"),
    "bno085": (Device(3_000_000, talking_bno085()), "parts.compass"),
}


@pytest.mark.parametrize("driver", PORTS)
def test_a_part_that_speaks_is_found_and_never_written_to(driver: str, bench: SerialBench) -> None:
    device, section = PORTS[driver]
    bench.plug_in("ttyUSB0", device, "serial/by-id/usb-Adapter_42-if00-port0")
    (part,), notes = find(bench)
    values = {f"{section}.driver": driver, f"{section}.port": "/dev/serial/by-id/usb-Adapter_42-if00-port0"}
    assert (part.values, part.doubt, notes, bench.written) == (values, "", [], [])


@pytest.mark.parametrize("model", [NEO_6M, NEO_M8N, ZED_F9P, MAX_M10], ids=lambda model: model.software)
def test_a_u_blox_receiver_is_found_at_its_own_rate(model: Model, bench: SerialBench) -> None:
    bench.plug_in("ttyS0", receiver(model), "serial0")
    (part,), _ = find(bench)
    assert part.values == {"parts.gnss.driver": "ubx", "parts.gnss.port": "/dev/serial0"}
    assert min(at_s for _, at_s in bench.written) >= 3.0


@pytest.mark.parametrize("baud", [4800, 9600, 38_400, 115_200])
@pytest.mark.parametrize(
    ("section", "said"),
    [
        ("parts.gnss", RMC),
        ("parts.compass", sentence("HCHDG,101.1,,,7.1,W")),
        ("parts.depth", sentence("SDDPT,2.1,0.3")),
    ],
)
def test_sentences_tell_what_sends_them(section: str, said: bytes, baud: int, bench: SerialBench) -> None:
    bench.plug_in("ttyUSB0", Device(baud, every_s(1.0, said)))
    (part,), _ = find(bench)
    values = {f"{section}.driver": "nmea", f"{section}.port": "/dev/ttyUSB0", f"{section}.baud": baud}
    assert (part.values, part.doubt) == (values, "")


def test_an_rplidar_that_waits_for_requests_is_asked_for_its_health(bench: SerialBench) -> None:
    twin = RplidarTwin()
    hear: Callable[[bytes], bytes] = lambda data: twin.hear(data) if data[0] == 0xA5 else b""  # noqa: E731
    bench.plug_in("ttyUSB0", Device(115_200, lambda _: b"", hear))
    (part,), _ = find(bench)
    assert part.values == {"parts.lidar.driver": "rplidar_a1", "parts.lidar.port": "/dev/ttyUSB0"}
    assert twin.requests == b"\x52"


def test_an_ais_receiver_is_found_by_its_messages(bench: SerialBench) -> None:
    bench.plug_in("ttyACM0", Device(38_400, every_s(1.0, AIS)))
    (part,), _ = find(bench)
    assert part.values == {
        "parts.ais.driver": "nmea",
        "parts.ais.port": "/dev/ttyACM0",
        "parts.ais.baud": 38_400,
    }
    assert bench.written == []


@pytest.mark.parametrize("baud", [57_600, 115_200, 921_600])
def test_an_autopilot_is_found_and_a_ground_stations_radio_is_none(baud: int, bench: SerialBench) -> None:
    """Heartbeats by pymavlink: of ArduPilot Rover, and of QGroundControl."""
    wire = mavlink.MAVLink(None, 1, 1)
    rover = mavlink.MAVLink_heartbeat_message(10, 3, 0, 0, 4, 3).pack(wire)
    station = mavlink.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3).pack(wire)
    bench.plug_in("ttyACM0", Device(baud, every_s(1.0, rover)))
    bench.plug_in("ttyUSB0", Device(baud, every_s(1.0, station)))
    (part,), notes = find(bench)
    assert part.values == {"parts.autopilot": f"serial:/dev/ttyACM0:{baud}"}
    assert part.doubt
    assert notes == [f"/dev/ttyUSB0: {NOTHING}"]
    assert bench.written == []


def test_depth_and_heading_on_a_receivers_line_are_of_that_line(bench: SerialBench) -> None:
    said = RMC + sentence("SDDPT,2.1,0.3") + sentence("GNHDT,91.0,T")
    bench.plug_in("ttyUSB0", Device(9600, every_s(1.0, said)))
    (gnss, compass, depth), _ = find(bench)
    assert gnss.driver == "nmea"
    assert (compass.values, bool(compass.doubt)) == ({"parts.compass.driver": "gnss"}, True)
    assert (depth.values, bool(depth.doubt)) == ({"parts.depth.driver": "gnss"}, False)


def test_depth_on_the_line_of_a_u_blox_receiver_is_not_read_there(bench: SerialBench) -> None:
    u_blox, sounder = receiver(NEO_M8N), every_s(1.0, sentence("SDDPT,2.1,0.3"))
    bench.plug_in("ttyUSB0", Device(9600, lambda now_s: u_blox.speak(now_s) + sounder(now_s), u_blox.hear))
    (gnss, depth), _ = find(bench)
    assert (gnss.driver, depth.driver, depth.doubt) == ("ubx", "nmea", "another part has its line")


def test_of_two_instruments_on_one_line_only_the_first_is_sure(bench: SerialBench) -> None:
    said = sentence("SDDPT,2.1,0.3") + sentence("HCHDG,101.1,,,7.1,W")
    bench.plug_in("ttyUSB0", Device(4800, every_s(1.0, said)))
    (compass, depth), _ = find(bench)
    assert (compass.driver, compass.doubt) == ("nmea", "")
    assert (depth.driver, depth.doubt) == ("nmea", "another part has its line")


def test_a_silent_sounder_answers_and_another_sonar_of_its_maker_is_refused(bench: SerialBench) -> None:
    for name, kind in (("ttyUSB0", 1), ("ttyUSB1", 2)):
        bench.plug_in(name, silent_ping(Ping1dTwin(kind)))
    (part,), notes = find(bench)
    assert part.values == {"parts.depth.driver": "ping1d", "parts.depth.port": "/dev/ttyUSB0"}
    assert notes == [f"/dev/ttyUSB1: {NOTHING}"]
    assert min(at_s for _, at_s in bench.written) >= 3.0


@given(st.binary(min_size=1, max_size=400), st.integers(1, 40))
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=15)
def test_garbage_is_no_part_and_gets_no_question(bench: SerialBench, noise: bytes, times: int) -> None:
    bench.written.clear()
    bench.plug_in("ttyUSB0", Device(9600, every_s(1.0, (b"\x00" + noise) * times)))
    assert find(bench) == ([], [f"/dev/ttyUSB0: {NOTHING}"])
    assert bench.written == []


def test_a_frame_by_chance_among_other_bytes_is_no_part(bench: SerialBench) -> None:
    bench.plug_in("ttyUSB0", Device(9600, every_s(1.0, b"\x00" * 9 + a02yyuw_frame(1953) + b"\x7f" * 9)))
    assert find(bench) == ([], [f"/dev/ttyUSB0: {NOTHING}"])


def test_all_ports_are_listened_to_at_once(bench: SerialBench) -> None:
    for number, (device, _) in enumerate(PORTS.values()):
        bench.plug_in(f"ttyUSB{number}", device)
    parts, _ = find(bench)
    assert {part.driver for part in parts} == set(PORTS)
    assert bench.clock() - bench.began_s < 35.0


def test_the_console_the_bluetooth_and_a_port_in_use_are_left_alone(
    bench: SerialBench, tmp_path: Path
) -> None:
    gps = Device(9600, every_s(1.0, RMC))
    bench.plug_in("ttyS0", gps, "serial0")
    bench.plug_in("ttyAMA0", gps, "serial1")
    bench.plug_in("ttyUSB0", gps)
    bench.refused["ttyUSB0"] = "/dev/ttyUSB0 is in use by another program"
    (tmp_path / "proc").mkdir()
    (tmp_path / "proc/cmdline").write_text(
        "console=serial0,115200 console=tty1 root=/dev/sda", encoding="utf-8"
    )
    parts, notes = find(bench)
    assert parts == []
    assert notes == [f"/dev/serial0: {CONSOLE}", bench.refused["ttyUSB0"]]


def test_gpsd_is_the_receiver_and_its_port_is_left_alone(
    bench: SerialBench, monkeypatch: pytest.MonkeyPatch
) -> None:
    server, has_ended = GpsdServer(), threading.Event()
    monkeypatch.setattr("companion.app.init.serial_parts.GPSD", ("127.0.0.1", server.port))
    bench.plug_in(DEVICE.removeprefix("/dev/"), receiver(NEO_M8N))

    def serve() -> None:
        while not has_ended.wait(0.005):
            server.serve()

    thread = threading.Thread(target=serve)
    thread.start()
    parts, notes = find(bench)
    has_ended.set()
    thread.join()
    server.close()
    (part,) = parts
    place = f"127.0.0.1:{server.port}"
    assert part.values == {"parts.gnss.driver": "gpsd", "parts.gnss.port": place}
    assert notes == [f"{DEVICE}: owned by gpsd at {place}"]


@pytest.mark.parametrize("answer", [b"", b"\xff" * 9, b'{"class":"DEVICES","devices":[{"path":"\xff"}]}\n'])
def test_another_server_on_gpsds_port_is_no_harm(
    answer: bytes, bench: SerialBench, monkeypatch: pytest.MonkeyPatch
) -> None:
    with socket.create_server(("127.0.0.1", 0)) as server:
        monkeypatch.setattr("companion.app.init.serial_parts.GPSD", server.getsockname())

        def serve() -> None:
            client, _ = server.accept()
            with client:
                client.sendall(answer)
                client.recv(4096)

        thread = threading.Thread(target=serve)
        thread.start()
        parts, notes = find(bench)
        thread.join()
    assert (len(parts), notes) == (answer.count(b"DEVICES"), [])


def test_a_real_line_is_found_unless_another_program_has_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "dev").mkdir()
    monkeypatch.setattr("companion.hal.raspberry_pi.ROOT", tmp_path)
    monkeypatch.setattr("companion.app.init.serial_parts.GPSD", ("127.0.0.1", 1))
    free, taken = PtyLine(tmp_path / "dev/ttyUSB0"), PtyLine(tmp_path / "dev/ttyUSB1")
    clock = HandClock()

    def wait(_: float) -> None:
        clock.advance(STEP_S)
        free.say(CRSF)

    with closing(SerialPort(taken.device, 9600, clock)):
        _, refusal, told, part = find_serial_parts(clock, wait)
    assert isinstance(part, Found)
    assert (part.driver, "ttyUSB0" in part.where) == ("crsf", True)
    assert str(refusal).endswith(f"{taken.device} is in use by another program")
    assert told == "/dev/ttyUSB0: crsf"
    free.unplug()
    taken.unplug()


def test_a_line_that_is_unplugged_under_way_is_no_part(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "dev").mkdir()
    monkeypatch.setattr("companion.hal.raspberry_pi.ROOT", tmp_path)
    monkeypatch.setattr("companion.app.init.serial_parts.GPSD", ("127.0.0.1", 1))
    line, clock = PtyLine(tmp_path / "dev/ttyUSB0"), HandClock()

    def wait(_: float) -> None:
        clock.advance(STEP_S)
        if clock() > 101.0:
            line.unplug()

    *_, note = find_serial_parts(clock, wait)
    assert "there is no device" in str(note)
