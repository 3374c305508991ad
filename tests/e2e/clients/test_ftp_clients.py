"""Files with the clients that people use: MAVProxy, MAVSDK and pymavlink's own, against the emulator."""

import asyncio
import json
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import pytest
from mavsdk.asyncio.plugins.component_metadata import ComponentMetadataAsync
from mavsdk.asyncio.plugins.ftp import FtpAsync
from mavsdk.asyncio.plugins.param import ParamAsync
from mavsdk.logging import log_subscribe
from mavsdk.plugins.component_metadata import MetadataType
from mavsdk_station import mavsdk_station
from mavutil_station import OpenStation
from patience import JOB_S, MOMENT_S
from programs import RunningBoat, RunProgram, start_boat, until
from pymavlink.mavftp import MAVFTP, FtpError

from companion.config.boat_config import BoatConfig
from companion.config.parameter_table import ROWS
from sitl.scenarios.scenario import load_scenario
from sitl.world.world import World

pytestmark = pytest.mark.realtime
pytest_plugins = ("program_fixtures",)

CONTENT = bytes(range(256)) * 100 + b"the end"
SERVED = len(ROWS) + len(
    World(load_scenario("open")).hardware.parameter_hooks
)  # the emulator brings some along


class Aboard(NamedTuple):
    """One boat for all clients, and the folder in which it stores."""

    boat: RunningBoat
    state: Path


@pytest.fixture(scope="module")
def aboard(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Aboard]:
    log_subscribe(lambda *_: True)
    folder = tmp_path_factory.mktemp("ftp")
    boat = start_boat(folder / "boat", "open", "--state", str(folder / "state"))
    yield Aboard(boat, folder / "state")
    boat.program.close()


def mavlink_crc(content: bytes) -> int:
    return zlib.crc32(content, 0xFFFFFFFF) ^ 0xFFFFFFFF


def test_mavproxy_fetches_parameters_as_a_file_and_moves_files(
    aboard: Aboard, run_program: RunProgram
) -> None:
    boat, state = aboard
    proxy = run_program("mavproxy.py", f"--master={boat.url}", "--state-basedir=.")
    (proxy.room / "there.bin").write_bytes(CONTENT)
    proxy.wait_for(rf"Received {SERVED} parameters \(ftp\)")
    proxy.say("param show HDG_KP")
    assert float(proxy.wait_for(r"HDG_KP +([0-9.]+)")[1]) == BoatConfig().heading.kp
    proxy.say("ftp list /")
    proxy.wait_for(r"^ *D files$")
    proxy.wait_for("Total size")
    proxy.say("ftp put there.bin /files/there.bin")
    proxy.wait_for(f"Sent file of length {len(CONTENT)}")
    proxy.say("ftp crc /files/there.bin")
    assert int(proxy.wait_for(r"crc: /files/there\.bin (0x[0-9a-f]+)")[1], 16) == mavlink_crc(CONTENT)
    assert (state / "files" / "there.bin").read_bytes() == CONTENT
    proxy.say("ftp list /files")
    proxy.wait_for(rf"^ +there\.bin\t{len(CONTENT)}$")
    proxy.say("ftp get /files/there.bin back.bin")
    proxy.wait_for(f"Wrote {len(CONTENT)} bytes to back.bin")
    until(lambda: (proxy.room / "back.bin").read_bytes() == CONTENT)  # it says so before it has flushed it
    proxy.say("ftp rm /files/there.bin")
    until(lambda: not (state / "files" / "there.bin").exists())
    proxy.say("ftp mkdir /files/bay")
    until((state / "files" / "bay").is_dir)
    proxy.say("ftp get /files/there.bin gone.bin")
    proxy.wait_for("ftp open failed")

    (proxy.room / "new.parm").write_text("HDG_KP 3.5\nWP_RADIUS 4\n", encoding="ascii")
    proxy.say("param ftpload new.parm")
    proxy.wait_for("Sending 2 params")
    stored = state / "params.parm"
    until(lambda: stored.exists() and "WP_RADIUS 4" in stored.read_text(encoding="ascii"))
    said = len(proxy.out)
    proxy.say("param fetch")
    proxy.wait_for(rf"Received {SERVED} parameters", after=said)
    proxy.say("param show WP_RADIUS")
    assert float(proxy.wait_for(r"WP_RADIUS +([0-9.]+)", after=said)[1]) == 4.0
    assert "HDG_KP 3.5" in stored.read_text(encoding="ascii")
    proxy.hang_up()
    proxy.wait()
    assert "Traceback" not in proxy.out + proxy.err


async def move_files_with_mavsdk(port: int, here: Path, state: Path) -> None:
    (here / "there.bin").write_bytes(CONTENT)
    async with mavsdk_station(port) as system:
        ftp, param, metadata = FtpAsync(system), ParamAsync(system), ComponentMetadataAsync(system)
        root = await ftp.list_directory("/")
        assert {"files", "logs", "metadata"} <= {entry.name for entry in root.entries}
        async for _ in ftp.upload(str(here / "there.bin"), "/files"):
            pass
        assert (state / "files" / "there.bin").read_bytes() == CONTENT
        assert await ftp.are_files_identical(str(here / "there.bin"), "/files/there.bin")
        entries = (await ftp.list_directory("/files")).entries
        assert ("there.bin", len(CONTENT)) in [(entry.name, entry.size_bytes) for entry in entries]
        for use_burst in (True, False):
            back = here / f"burst-{use_burst}"
            back.mkdir()
            async for _ in ftp.download("/files/there.bin", str(back), use_burst):
                pass
            assert (back / "there.bin").read_bytes() == CONTENT
        await ftp.create_directory("/files/sub")
        await ftp.rename("/files/there.bin", "/files/sub/moved.bin")
        assert (state / "files" / "sub" / "moved.bin").read_bytes() == CONTENT
        await ftp.remove_file("/files/sub/moved.bin")
        await ftp.remove_directory("/files/sub")
        assert not (state / "files" / "sub").exists()

        parameters = await param.get_all_params()
        assert len(parameters.int_params) + len(parameters.float_params) == SERVED

        updates = metadata.subscribe_metadata_available()
        first = asyncio.ensure_future(anext(updates))  # it listens before it asks: the answer comes at once
        await asyncio.sleep(0)
        await metadata.request_autopilot_component()
        update = await first
        while update.type != MetadataType.PARAMETER:
            update = await anext(updates)
        await updates.aclose()
        described = json.loads(update.json_metadata)
        names = {entry["name"] for entry in described["parameters"]}
        assert (len(names), names >= {row.name for row in ROWS}) == (SERVED, True)
        for plugin in (ftp, param, metadata):
            plugin.destroy()


def test_mavsdk_moves_files_and_fetches_what_the_boat_says_of_its_parameters(
    aboard: Aboard, tmp_path: Path
) -> None:
    job = move_files_with_mavsdk(aboard.boat.port, tmp_path, aboard.state)
    asyncio.run(asyncio.wait_for(job, JOB_S))


def test_pymavlink_fetches_parameters_and_moves_files(
    aboard: Aboard, open_station: OpenStation, tmp_path: Path
) -> None:
    boat, state = aboard
    station = open_station(boat.port)
    station.drain()
    assert len(station.parameters()) == SERVED

    client = MAVFTP(station.link, target_system=1, target_component=1)
    values, defaults = tmp_path / "values.parm", tmp_path / "defaults.parm"
    client.cmd_getparams([str(values), str(defaults)])
    assert client.process_ftp_reply("getparams", timeout=MOMENT_S).error_code == FtpError.Success
    assert len(values.read_text(encoding="ascii").splitlines()) == SERVED
    assert len(defaults.read_text(encoding="ascii").splitlines()) == SERVED

    there, back = tmp_path / "there.bin", tmp_path / "back.bin"
    there.write_bytes(CONTENT)
    client.cmd_put([str(there), "/files/there.bin"])
    assert client.process_ftp_reply("CreateFile", timeout=MOMENT_S).error_code == FtpError.Success
    assert (state / "files" / "there.bin").read_bytes() == CONTENT
    client.cmd_get(["/files/there.bin", str(back)])
    assert client.process_ftp_reply("OpenFileRO", timeout=MOMENT_S).error_code == FtpError.Success
    assert back.read_bytes() == CONTENT
    listed = client.cmd_list(["/files"])
    assert listed.error_code == FtpError.Success
    assert ("there.bin", len(CONTENT)) in [(entry.name, entry.size_b) for entry in client.list_result]
    assert client.cmd_rm(["/files/there.bin"]).error_code == FtpError.Success
    assert client.cmd_rm(["/files/there.bin"]).error_code == FtpError.FileNotFound
