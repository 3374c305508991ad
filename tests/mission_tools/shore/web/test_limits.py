"""How many connections, sockets and requests an address gets, and that a skipper always gets in."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path

import pytest
from aiohttp import ClientSession, ClientWebSocketResponse, TCPConnector, WSMsgType, WSServerHandshakeError
from shore_server import PAGE, FakeBoats, FakeChart, FakeClock, Server, serving, until

from mission_tools.shore.web.connections.access_control import (
    MOST_CONNECTIONS,
    MOST_OF_ADDRESS,
    AccessControl,
)
from mission_tools.shore.web.connections.rates import Bucket, Rate, Rates
from mission_tools.shore.web.listening import Listening
from mission_tools.shore.web.login.pin_file import PinFile
from mission_tools.shore.web.login.session import Sessions
from mission_tools.shore.web.server import make_app
from mission_tools.shore.web.sockets import MOST_OF_ADDRESS as MOST_SOCKETS_OF_ADDRESS
from mission_tools.shore.web.sockets import MOST_SOCKETS

pytest_plugins = ("server_fixtures",)


def test_a_bucket_gives_its_burst_and_then_its_rate() -> None:
    bucket = Bucket(Rate(burst=3, per_s=2.0), 0.0)
    assert [bucket.allows(0.0) for _ in range(4)] == [True, True, True, False]
    assert [bucket.allows(1.0) for _ in range(3)] == [True, True, False]
    assert [bucket.allows(1000.0) for _ in range(4)] == [True, True, True, False]


def test_a_flood_from_many_addresses_does_not_hold_up_who_has_told_the_pin() -> None:
    rates = Rates(each=Rate(3, 1.0), strangers=Rate(10, 1.0))
    told = [rates.allows(f"10.0.0.{number}", 0.0, is_known=False) for number in range(100)]
    assert sum(told) == 10
    assert [rates.allows("10.0.1.1", 0.0, is_known=True) for _ in range(4)] == [True, True, True, False]


class _Transport(asyncio.Transport):
    """A connection from an address."""

    def __init__(self, address: str) -> None:
        super().__init__({"peername": (address, 5)})
        self.is_open = True
        self.protocol: asyncio.BaseProtocol | None = None

    def abort(self) -> None:
        self.is_open = False

    def is_closing(self) -> bool:
        return not self.is_open

    def set_protocol(self, protocol: asyncio.BaseProtocol) -> None:
        self.protocol = protocol


class _Handler(asyncio.Protocol):
    """As aiohttp's."""

    transport: asyncio.BaseTransport | None = None

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        self.transport = transport


class _Server:
    """As aiohttp's: makes handlers, and knows the open ones."""

    def __init__(self) -> None:
        self.connections: list[_Handler] = []

    def __call__(self) -> _Handler:
        self.connections.append(_Handler())
        return self.connections[-1]


class Knocks:
    """Connections from addresses; time goes by between any two."""

    def __init__(self) -> None:
        self.now_s = 0.0
        self.known = "10.0.9.9"
        self.access = AccessControl(_Server(), lambda address: address == self.known, lambda: self.now_s)

    def connect(self, address: str, later_s: float = 1.0) -> _Transport:
        self.now_s += later_s
        transport = _Transport(address)
        self.access.open().connection_made(transport)
        return transport


def test_an_address_gets_so_many_connections() -> None:
    network = Knocks()
    opened = [network.connect("10.0.0.1") for _ in range(MOST_OF_ADDRESS + 5)]
    assert [one.is_open for one in opened] == [True] * MOST_OF_ADDRESS + [False] * 5
    opened[0].abort()
    assert network.connect("10.0.0.1").is_open


def test_an_address_that_connects_again_and_again_is_held_up() -> None:
    network = Knocks()
    opened = 0
    for _ in range(1000):
        one = network.connect("10.0.0.1", 0.01)
        opened += one.is_open
        one.abort()
    assert 64 + 8 * 9 <= opened <= 64 + 8 * 10 + 1


def test_four_addresses_that_take_every_place_give_way_to_a_fifth() -> None:
    network = Knocks()
    taken = [network.connect(f"10.0.0.{n % 4}") for n in range(MOST_CONNECTIONS)]
    assert all(one.is_open for one in taken)
    assert network.connect("10.0.0.5").is_open
    assert sum(one.is_open for one in taken) == MOST_CONNECTIONS - 1


def test_many_addresses_with_a_connection_each_keep_out_a_stranger_but_no_skipper() -> None:
    network = Knocks()
    taken = [network.connect(f"10.1.{n // 100}.{n % 100}") for n in range(MOST_CONNECTIONS)]
    assert all(one.is_open for one in taken)
    assert not network.connect("10.0.0.5").is_open
    assert network.connect(network.known).is_open
    assert sum(one.is_open for one in taken) == MOST_CONNECTIONS - 1


@asynccontextmanager
async def at(server: Server, number: int) -> AsyncIterator[ClientSession]:
    """A browser with an address of its own."""
    connector = TCPConnector(local_addr=(f"127.0.0.{number}", 0))
    async with ClientSession(server.origin, connector=connector, headers=server.own) as session:
        yield session


async def fill(server: Server, sessions: list[ClientSession]) -> list[ClientWebSocketResponse]:
    return [
        await session.ws_connect("/live?boat=1")
        for session in sessions
        for _ in range(MOST_SOCKETS_OF_ADDRESS)
    ]


async def test_when_every_socket_is_taken_a_skipper_still_gets_in(server: Server) -> None:
    others = [at(server, number) for number in range(2, 2 + MOST_SOCKETS // MOST_SOCKETS_OF_ADDRESS)]
    sessions = [await one.__aenter__() for one in others]
    sockets = await fill(server, sessions)
    assert len(sockets) == len(server.hub.watches) == MOST_SOCKETS
    async with at(server, 20) as stranger:
        with pytest.raises(WSServerHandshakeError) as refused:
            await stranger.ws_connect("/live?boat=1")
        assert refused.value.status == 503
    assert await server.log_in() == 200
    ws = await server.live()
    assert (await ws.receive_json())["role"] == "skipper"
    await until(lambda: len(server.hub.watches) == MOST_SOCKETS)
    for socket in (*sockets, ws):
        await socket.close()
    for one in others:
        await one.__aexit__(None, None, None)


async def test_a_skipper_whose_own_sockets_are_left_behind_gets_in_again(server: Server) -> None:
    await server.log_in()
    sockets = [await server.live() for _ in range(MOST_SOCKETS_OF_ADDRESS)]
    ws = await server.live()
    assert (await ws.receive_json())["role"] == "skipper"
    kinds: set[WSMsgType] = set()
    while not kinds & {WSMsgType.CLOSED, WSMsgType.CLOSE, WSMsgType.ERROR}:
        kinds.add((await sockets[0].receive()).type)
    await until(lambda: len(server.hub.watches) == MOST_SOCKETS_OF_ADDRESS)
    for socket in (*sockets, ws):
        await socket.close()


async def flood(session: ClientSession, count: int) -> list[int]:
    codes = []
    for _ in range(count):
        async with session.get("/api/session") as told:
            codes.append(told.status)
    return codes


async def test_an_address_that_asks_too_often_is_refused_and_others_are_served() -> None:
    async with serving() as server, at(server, 2) as one, at(server, 3) as other:
        codes = await flood(one, 420)
        assert codes == [200] * 400 + [429] * 20
        assert await flood(other, 1) == [200]
        server.clock.at_s += 1.0
        assert await flood(one, 60) == [200] * 50 + [429] * 10


async def test_a_page_that_leaves_before_its_socket_is_open_is_no_fault(
    server: Server, monkeypatch: pytest.MonkeyPatch
) -> None:
    async def leave(*_: object) -> None:
        raise ConnectionResetError

    monkeypatch.setattr("aiohttp.web.WebSocketResponse.prepare", leave)
    with pytest.raises(WSServerHandshakeError) as refused:
        await server.live()
    assert refused.value.status == 400
    assert server.hub.watches == []


async def test_a_handler_that_fails_is_logged_once_and_answered(
    server: Server, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    def fail() -> None:
        raise ValueError("a broken boat")

    monkeypatch.setattr(server.boats, "names", fail)
    async with server.client.get("/api/boats") as told:
        assert told.status == 500
        assert "broken" not in await told.text()
    assert [record.getMessage() for record in caplog.records] == ["GET '/api/boats' has failed"]


async def test_bytes_that_are_no_http_are_not_logged(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    for name, text in PAGE.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    app = make_app(
        FakeBoats(),
        FakeChart(),
        Sessions(PinFile(tmp_path / "none")),
        tmp_path,
        FakeClock(),
        is_polling=False,
    )
    server = Listening(app)
    port = await server.open("127.0.0.1", 0)
    reader, writer = await asyncio.open_connection("127.0.0.1", port)
    writer.write(b"\x1b]0;evil\x07 /\r\nFAULT: motors off\r\n\r\n")
    assert b" 400 " in await reader.readline()
    writer.close()
    await server.close()
    assert caplog.records == []
