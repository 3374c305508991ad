"""The parameters by HTTP."""

import gzip
import json
from pathlib import Path
from typing import Any

import pytest
from pymavlink import mavparm
from shore_server import Server

from companion.mavlink.address import Address
from companion.mavlink.dialect import Message, dialect
from companion.mavlink.metadata_messages import ComponentMetadata
from mission_tools.station.ftp.jobs import FtpFailure
from mission_tools.station.parameters.param_file import MOST_BYTES, ParamFileError, read_file
from mission_tools.station.parameters.parameter_table import ParameterTable

pytest_plugins = ("server_fixtures",)

PATH = "/api/boats/1/parameters"


class Fake:
    """A boat's table, filled by hand."""

    def __init__(self, server: Server, texts: dict[str, Any] | None = None) -> None:
        self.files: dict[str, bytes] = {}
        if texts is not None:
            kind = {"type": 1, "uri": "mftp:///p"}
            self.files = {
                "/g": json.dumps({"version": 1, "metadataTypes": [kind]}).encode(),
                "/p": json.dumps(
                    {"version": 3, "parameters": [{"name": n, **t} for n, t in texts.items()]}
                ).encode(),
            }
        self.sent: list[Message] = []
        self.table = ParameterTable(Address(1, 1), Address(250, 190), self.sent.append, self._read)
        self.now_s = 100.0
        server.boats.boat.parameters = self.table

    def _read(self, path: str, done: Any, most_bytes: int) -> None:  # noqa: ANN401
        done(self.files.get(path, FtpFailure("none")))

    def fill(self, **values: float) -> None:
        for index, (name, number) in enumerate(values.items()):
            self.say(name, number, index, len(values))
        self.table.snapshot()
        self.table.poll(self.now_s, is_heard=True)
        if self.files:
            self.table.handle(ComponentMetadata(0, 0, b"mftp:///g"), self.now_s)

    def say(self, name: str, number: float, index: int, count: int) -> None:
        self.table.handle(
            dialect.MAVLink_param_value_message(name.encode(), number, 9, count, index), self.now_s
        )


async def get(server: Server, path: str = PATH, **headers: str) -> tuple[int, Any, str]:
    async with server.client.get(path, headers=headers) as response:
        content = await response.read()
        tag = response.headers.get("ETag", "")
        return response.status, json.loads(content) if content else None, tag


async def test_the_list_comes_with_progress_then_whole_then_only_when_it_has_changed(server: Server) -> None:
    await server.log_in()
    assert (await get(server, "/api/boats/7/parameters"))[0] == 404
    boat = Fake(server, {"B": {"shortDesc": "The second", "default": 2, "group": "G"}})
    assert (await get(server))[:2] == (202, {"got": 0, "count": None})
    boat.say("A", 0.1, 0, 2)
    assert (await get(server))[:2] == (202, {"got": 1, "count": 2})
    boat.fill(A=0.1, B=3.0)
    status, body, tag = await get(server)
    assert status == 200
    assert (body["texts"], body["missing"]) == ("here", 0)
    first, second = body["parameters"]
    assert (first["name"], first["value"], first["default"], first["changed"]) == ("A", 0.1, None, False)
    assert (second["text"], second["changed"], second["group"]) == ("The second", True, "G")
    status, body, again = await get(server, **{"If-None-Match": tag})
    assert (status, body, again) == (304, None, tag)
    boat.say("A", 0.2, 0, 2)
    status, body, again = await get(server, **{"If-None-Match": tag})
    assert (status, body["parameters"][0]["value"]) == (200, 0.2)
    assert again != tag


async def test_texts_that_cannot_be_read_are_left_out_and_tried_again(server: Server) -> None:
    await server.log_in()
    boat = Fake(server, {})
    boat.files["/p"] = b"\x1f\x8bnothing"
    boat.fill(A=1.0)
    _, body, _ = await get(server)
    assert (body["texts"], body["parameters"][0]["text"]) == ("loading", "")


async def test_the_file_is_for_those_with_the_pin_and_pymavlink_reads_it(
    server: Server, tmp_path: Path
) -> None:
    boat = Fake(server)
    assert (await get(server, f"{PATH}.param"))[0] == 403
    await server.log_in()
    assert (await get(server, f"{PATH}.param"))[0] == 503
    values = {"CRUISE_SPEED": 0.1, "ANGLE": -45.836624, "BIG": 1e20, "ZERO": 0.0, "NONE": float("nan")}
    boat.fill(**values)
    async with server.client.get(f"{PATH}.param") as response:
        assert response.headers["Content-Disposition"] == 'attachment; filename="boat-1.param"'
        (tmp_path / "boat.param").write_bytes(await response.read())
    read = mavparm.MAVParmDict()
    assert read.load(str(tmp_path / "boat.param"))
    del values["NONE"]
    assert dict(read) == {name: pytest.approx(number, rel=1e-7) for name, number in values.items()}


async def compared(server: Server, content: bytes, status: int = 200) -> Any:  # noqa: ANN401
    async with server.client.post(f"{PATH}/compare", data=content, headers=server.own) as response:
        assert response.status == status, await response.text()
        return await response.json()


async def test_a_file_that_pymavlink_wrote_is_compared(server: Server, tmp_path: Path) -> None:
    boat = Fake(server, {"SPEED": {"shortDesc": "Cruise speed", "units": "m/s"}, "FIXED": {"readOnly": True}})
    boat.fill(SPEED=1.0, ANGLE=45.836624, FIXED=0.0, OTHER=7.0)
    await compared(server, b"SPEED,1", 403)
    await server.log_in()
    file = mavparm.MAVParmDict()
    file.update({"SPEED": 0.8, "ANGLE": 45.836624, "FIXED": 1.0, "GONE": 3.0})
    file.save(str(tmp_path / "a.parm"))
    found = await compared(server, (tmp_path / "a.parm").read_bytes())
    assert found == {
        "differences": [
            {"name": "FIXED", "now": 0.0, "file": 1.0, "text": "", "unit": "", "read_only": True},
            {
                "name": "SPEED", "now": 1.0, "file": 0.8,
                "text": "Cruise speed", "unit": "m/s", "read_only": False,
            },
        ],
        "same": 1,
        "unknown": ["GONE"],
    }  # fmt: skip


def test_the_forms_of_mission_planner_mavproxy_and_qgroundcontrol_are_read() -> None:
    lines = (
        "SPEED,0.8", "SPEED 0.8", "1\t1\tSPEED\t0.8\t9", "SPEED,0.8 # faster", "\ufeffSPEED , 0.8\r",
        "SPEED 0.8 @READONLY",
    )  # fmt: skip
    for line in lines:
        assert read_file(f"{line}\n#NOTE: 1/1/2026\n\n".encode()) == {"SPEED": 0.8}


@pytest.mark.parametrize(
    ("content", "text"),
    [
        (b"SPEED,1\nSPEED\n", "Line 2: 'SPEED': expected NAME,VALUE."),
        (b"SPEED,fast\n", "Line 1: 'SPEED,fast'"),
        (b"SPEED,nan\n", "Line 1"),
        (b"<script>alert(1)</script>,1\n", "Line 1"),
        (b"A,1,2\n", "Line 1"),
        (b"# nothing\n", "The file has no parameter in it"),
        (gzip.compress(b"SPEED,1", mtime=0), "This is no text file"),
        (b"\n" * 20_000, "The file has 20000 lines"),
    ],
)
def test_a_file_of_another_kind_is_refused_with_its_line(content: bytes, text: str) -> None:
    with pytest.raises(ParamFileError) as refused:
        read_file(content)
    assert text in refused.value.args[0]


async def test_a_file_that_is_wrong_or_too_long_is_refused(server: Server) -> None:
    Fake(server).fill(SPEED=1.0)
    await server.log_in()
    assert (await compared(server, b"SPEED", 400))["key"] == "error.param_file.line"
    await compared(server, b" " * (MOST_BYTES + 1), 413)
