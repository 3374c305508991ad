"""TCP ports over loopback, and serial ports over pseudo-terminals."""

import contextlib
import errno
import os
import socket
import struct
import termios
import types
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from patience import MOMENT_S
from twins.lines import HandClock, PtyLine, eventually, gather

from companion.core.errors import LinkError
from companion.links.interfaces import Link, Port
from companion.links.serial_port import LINE_8E2, LINE_8N1, LineFormat, SerialPort
from companion.links.stream import StreamLink
from companion.links.tcp import TcpInPort, TcpOutPort

HERE = "127.0.0.1"


@pytest.fixture
def server() -> Iterator[TcpInPort]:
    port = TcpInPort(HERE, 0)
    yield port
    port.close()


def number_of(port: Port) -> int:
    return int(port.name.rpartition(":")[2])


def next_link(port: Port) -> Link:
    links: list[Link] = []

    def has_come() -> bool:
        links.extend(port.accept())
        return bool(links)

    eventually(has_come)
    (link,) = links
    return link


def connect(port: TcpInPort) -> tuple[Link, socket.socket]:
    client = socket.create_connection((HERE, number_of(port)), timeout=MOMENT_S)
    return next_link(port), client


def receive_all(link: Link, size: int) -> bytes:
    heard: list[bytes] = []
    eventually(lambda: len(b"".join(gather(link.receive, heard))) >= size)
    return b"".join(heard)


def test_many_clients_are_served_side_by_side(server: TcpInPort) -> None:
    pairs = [connect(server) for _ in range(5)]
    for index, (link, client) in enumerate(pairs):
        client.sendall(b"client %d" % index)
        assert receive_all(link, 8) == b"client %d" % index
        assert link.send(b"boat %d" % index)
        assert client.recv(100) == b"boat %d" % index
        assert not link.is_datagram
        assert link.name == "tcp:{}:{}".format(*client.getsockname())
        with socket.socket(fileno=os.dup(link.fileno())) as same:  # sent at once, and dead peers looked for
            assert same.getsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY)
            assert same.getsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE)
            alive = (socket.TCP_KEEPIDLE, socket.TCP_KEEPINTVL, socket.TCP_KEEPCNT)
            assert [same.getsockopt(socket.IPPROTO_TCP, option) for option in alive] == [10, 5, 4]
        client.close()


def test_last_words_survive_a_send_that_fails(server: TcpInPort) -> None:
    link, client = connect(server)
    client.sendall(b"last words")
    client.close()
    eventually(lambda: not link.send(b"telemetry"))
    assert receive_all(link, 10) == b"last words"
    assert link.is_closed
    assert link.fileno() == -1


def test_a_descriptor_that_takes_nothing_and_says_nothing_is_given_up() -> None:
    reading, writing = os.pipe()
    os.set_blocking(reading, False)
    link = StreamLink("broken", reading, lambda: os.close(reading), 100)
    os.write(writing, b"last words")
    assert not link.send(b"x")  # a pipe's reading end refuses to be written to
    assert link.receive() == [b"last words"]
    assert link.is_closed
    os.close(writing)


def test_a_client_that_stops_reading_loses_whole_frames_and_never_half_of_one() -> None:
    port = TcpInPort(HERE, 0, queue_bytes=20_000)
    link, client = connect(port)
    other, other_client = connect(port)
    sent = []
    for index in range(20_000):
        frame = struct.pack("<I", index) * 64
        if link.send(frame):
            sent.append(frame)
        if index % 1000 == 0:
            assert other.send(frame)
            assert other_client.recv(len(frame)) == frame
    assert 0 < len(sent) < 20_000
    wanted = b"".join(sent)
    heard = bytearray()
    client.setblocking(False)

    def read_on() -> bool:
        link.receive()  # drains the queue as the boat's tick does
        try:
            heard.extend(client.recv(1 << 20))
        except BlockingIOError:
            return False
        return len(heard) >= len(wanted)

    eventually(read_on)
    assert bytes(heard) == wanted
    assert link.send(b"again")
    client.close()
    other_client.close()
    port.close()


def test_one_call_takes_a_bounded_bite_of_a_flood(server: TcpInPort) -> None:
    link, client = connect(server)
    client.setblocking(False)
    with contextlib.suppress(BlockingIOError):
        while True:
            client.send(bytes(65536))
    assert 0 < sum(map(len, link.receive())) <= 16 * 4096
    client.close()


def test_clients_beyond_the_limit_are_turned_away() -> None:
    port = TcpInPort(HERE, 0, max_clients=1)
    link, client = connect(port)
    with socket.create_connection((HERE, number_of(port)), timeout=MOMENT_S) as refused:
        assert port.accept() == []
        assert refused.recv(1) == b""
    link.close()
    client.close()
    _, client = connect(port)
    client.close()
    port.close()


def test_a_server_that_restarts_takes_its_port_back_at_once(server: TcpInPort) -> None:
    link, client = connect(server)
    server.close()
    server.close()
    assert link.is_closed
    assert server.fileno() == -1
    assert client.recv(1) == b""
    again = TcpInPort(HERE, number_of(server))
    _, new_client = connect(again)
    new_client.close()
    client.close()
    again.close()


def test_tcpout_waits_for_its_server_and_comes_back_to_it(clock: HandClock) -> None:
    server = TcpInPort(HERE, 0)
    number = number_of(server)
    server.close()
    port = TcpOutPort(HERE, number, clock)
    for _ in range(20):
        assert port.accept() == []
        clock.advance(1.0)
    server = TcpInPort(HERE, number)
    clock.advance(10.0)
    link = next_link(port)
    far = next_link(server)
    assert link.send(b"boat")
    assert receive_all(far, 4) == b"boat"
    far.close()
    eventually(lambda: link.receive() or link.is_closed)
    assert port.accept() == []
    clock.advance(10.0)
    again = next_link(port)
    assert again is not link
    assert not again.is_closed
    port.close()
    port.close()
    server.close()
    clock.advance(100.0)
    assert port.accept() == []


def test_tcpout_tries_again_with_growing_waits(clock: HandClock) -> None:
    with socket.socket() as closed:
        closed.bind((HERE, 0))
        port = TcpOutPort(HERE, closed.getsockname()[1], clock)
        tries = 0
        for _ in range(600):
            is_due = port._backoff.is_due(clock())
            tries += is_due
            eventually(lambda: port.accept() or port._dialling is None)
            clock.advance(0.1)
        port.close()
    assert 7 <= tries <= 12  # a minute of 0.5, 1, 2, 4, 8, 8, … s


def test_a_serial_line_is_set_up_for_its_format_and_baud_rate(line: PtyLine, clock: HandClock) -> None:
    checks = termios.INPCK | termios.IGNPAR
    for line_format, flags in ((LINE_8N1, 0), (LINE_8E2, checks)):
        port = SerialPort(line.device, 57600, clock, line=line_format)
        (link,) = port.accept()
        assert termios.tcgetattr(link.fileno())[0] & checks == flags
        port.set_baud(9600)
        assert termios.tcgetattr(link.fileno())[4] == termios.B9600
        port.close()


def test_a_line_may_keep_dtr_low_from_its_opening_on(
    line: PtyLine, clock: HandClock, monkeypatch: pytest.MonkeyPatch
) -> None:
    levels: list[bool] = []
    monkeypatch.setattr("serial.Serial._update_dtr_state", lambda self: levels.append(self.dtr))
    for is_ready in (True, False):
        port = SerialPort(line.device, 57600, clock, line=LineFormat(is_ready=is_ready))
        line.unplug()
        port.accept()
        port._link.receive()
        line.plug_in()
        clock.advance(5.0)
        port.accept()
        port.close()
    assert levels == [True, True, False, False]


def test_a_serial_line_that_is_unplugged_comes_back_as_a_new_link(line: PtyLine, clock: HandClock) -> None:
    port = SerialPort(line.device, 57600, clock)
    (link,) = port.accept()
    assert link.name == port.name == f"serial:{line.device}:57600"
    assert link.receive() == [], "and does not wait"
    line.unplug()
    assert link.receive() == []
    assert link.is_closed
    assert not link.send(b"x")
    for _ in range(5):
        assert port.accept() == []
        clock.advance(5.0)
    line.plug_in()
    (again,) = port.accept()
    line.say(b"back")
    assert receive_all(again, 4) == b"back"
    port.close()


@pytest.mark.parametrize(("where", "function"), [("pyserial", "tcgetattr"), ("ours", "tcsetattr")])
def test_a_device_that_is_pulled_out_while_it_is_set_up_is_looked_for_again(
    line: PtyLine, clock: HandClock, monkeypatch: pytest.MonkeyPatch, where: str, function: str
) -> None:
    port = SerialPort(line.device, 57600, clock)
    (link,) = port.accept()
    line.unplug()
    link.receive()
    line.plug_in()
    before = len(os.listdir("/proc/self/fd"))

    def pulled_out(*_: object) -> None:
        raise termios.error(errno.EIO, "Input/output error")  # of a tty that has hung up

    with monkeypatch.context() as patch:
        module = "serial.serialposix" if where == "pyserial" else "companion.links.serial_port"
        double = types.SimpleNamespace(**{name: getattr(termios, name) for name in dir(termios)})
        setattr(double, function, pulled_out)
        patch.setattr(f"{module}.termios", double)
        for _ in range(3):
            clock.advance(5.0)
            assert port.accept() == []
        assert len(os.listdir("/proc/self/fd")) == before, "a descriptor was left open"
    clock.advance(5.0)
    (again,) = port.accept()
    line.say(b"back")
    assert receive_all(again, 4) == b"back"
    port.close()


def test_a_device_that_vanishes_while_its_fault_is_looked_into_is_told_as_missing(
    line: PtyLine, clock: HandClock, monkeypatch: pytest.MonkeyPatch
) -> None:
    port = SerialPort(line.device, 57600, clock)
    (link,) = port.accept()
    exists = os.path.exists

    def vanishes(path: str) -> bool:
        was_there = exists(path)
        line.unplug()
        return was_there

    monkeypatch.setattr("os.path.exists", vanishes)
    with pytest.raises(LinkError):
        SerialPort(line.device, 57600, clock)  # in use: the reason is looked for, and the device goes
    line.unplug()
    link.receive()
    clock.advance(5.0)
    assert port.accept() == []
    port.close()


def test_a_full_queue_takes_a_frame_as_soon_as_the_far_side_has_read() -> None:
    near, far = socket.socketpair()
    near.setblocking(False)
    far.settimeout(MOMENT_S)
    link = StreamLink("pair", near.fileno(), near.close, 1000)
    while link.send(bytes(1000)):
        pass
    while not link.send(b"again"):
        assert far.recv(1 << 20)
    link.close()
    far.close()


def test_a_device_without_permission_names_the_cure(
    clock: HandClock, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("os.access", lambda _, mode: mode != os.R_OK | os.W_OK)
    with pytest.raises(LinkError, match="no permission for /dev/null; add the user to the group 'dialout'"):
        SerialPort("/dev/null", 57600, clock)


def test_a_descriptor_that_refuses_to_be_closed_is_let_go() -> None:
    def refuses() -> None:
        raise OSError(errno.EIO, "Input/output error")

    link = StreamLink("gone", os.open("/dev/null", os.O_RDONLY), refuses, 100)
    descriptor = link.fileno()
    link.close()
    assert link.is_closed
    os.close(descriptor)


def test_a_slow_serial_line_drops_whole_frames(line: PtyLine, clock: HandClock) -> None:
    port = SerialPort(line.device, 57600, clock)
    (link,) = port.accept()
    sent = b"".join(frame for index in range(1000) if link.send(frame := struct.pack("<I", index) * 20))
    assert 8192 - 80 < len(sent) < 80_000
    heard: list[bytes] = []

    def read_on() -> bool:
        link.receive()
        return len(b"".join(gather(lambda: [line.heard()], heard))) >= len(sent)

    eventually(read_on)
    assert b"".join(heard) == sent
    port.close()


def test_a_device_that_is_missing_or_not_serial_is_named(tmp_path: Path, clock: HandClock) -> None:
    with pytest.raises(LinkError, match="there is no device /dev/ttyNONE; is it plugged in"):
        SerialPort("/dev/ttyNONE", 57600, clock)
    plain = tmp_path / "plain"
    plain.touch()
    with pytest.raises(LinkError, match="is not a serial device"):
        SerialPort(str(plain), 57600, clock)


def test_a_device_in_use_is_named(line: PtyLine, clock: HandClock) -> None:
    port = SerialPort(line.device, 57600, clock)
    with pytest.raises(LinkError, match="is in use by another program"):
        SerialPort(line.device, 57600, clock)
    port.close()


@settings(max_examples=10)
@given(st.lists(st.binary(min_size=1, max_size=3000), min_size=1, max_size=20))
def test_any_bytes_come_through_a_stream_in_order(frames: list[bytes]) -> None:
    server, wanted = TcpInPort(HERE, 0), b"".join(frames)
    port = TcpOutPort(HERE, number_of(server), HandClock())
    near = next_link(port)
    far = next_link(server)
    for frame in frames:
        assert near.send(frame)
    assert receive_all(far, len(wanted)) == wanted
    for frame in frames:
        assert far.send(frame)
    assert receive_all(near, len(wanted)) == wanted
    port.close()
    server.close()
