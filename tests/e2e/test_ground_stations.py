"""The three stations that people use, as the programs that they are, against the emulator as a process."""

import asyncio
import re
import time

import pytest
from mavsdk.asyncio import ComponentType, Configuration, Mavsdk, System
from mavsdk.asyncio.plugins.action import ActionAsync
from mavsdk.asyncio.plugins.mission_raw import MissionRawAsync
from mavsdk.asyncio.plugins.param import ParamAsync
from mavsdk.asyncio.plugins.telemetry import TelemetryAsync
from mavsdk.logging import log_subscribe
from mavsdk.plugins.mission_raw import MissionItem as RawItem
from mavutil_station import HOME, OpenStation, Place, zigzag
from patience import JOB_S, MOMENT_S
from programs import RunBoat, RunningBoat, RunProgram
from pymavlink.dialects.v20 import all as dialect

pytestmark = pytest.mark.realtime
pytest_plugins = ("program_fixtures",)

ITEMS = zigzag(100, north_e7=500)
AUTO = 10
CRUISE_M_S = 2.0


def tell(client: str, what: str, seconds: float) -> None:
    print(f"{client}: {what} of {len(ITEMS) - 1} waypoints and home in {seconds * 1e3:.0f} ms")  # noqa: T201


def test_pymavlink_reads_parameters_brings_a_mission_and_sees_the_boat_sail(
    running_boat: RunBoat, open_station: OpenStation
) -> None:
    boat = running_boat("open")
    station = open_station(boat.port)
    parameters = station.parameters()
    assert parameters["CRUISE_SPEED"] == CRUISE_M_S
    began_s = time.perf_counter()
    assert station.upload(ITEMS) == dialect.MAV_MISSION_ACCEPTED
    uploaded_s = time.perf_counter()
    held = station.download()
    read_s = time.perf_counter()
    tell("pymavlink", "upload", uploaded_s - began_s)
    tell("pymavlink", "download", read_s - uploaded_s)
    assert held[1:] == ITEMS[1:]

    station.wait_for("GLOBAL_POSITION_INT")  # AUTO is refused before the first fix
    assert station.arm() == dialect.MAV_RESULT_ACCEPTED
    assert station.command(dialect.MAV_CMD_MISSION_START) == dialect.MAV_RESULT_ACCEPTED
    heartbeat = station.wait_for("HEARTBEAT", lambda heartbeat: heartbeat.custom_mode == AUTO)
    assert heartbeat.base_mode & dialect.MAV_MODE_FLAG_SAFETY_ARMED
    station.wait_for("VFR_HUD", lambda hud: hud.groundspeed > 0.5)
    station.wait_for("MISSION_ITEM_REACHED", lambda reached: reached.seq == 1)
    assert station.metres_from(HOME) > 3.0


async def connected(mavsdk: Mavsdk, boat: RunningBoat) -> System:
    await mavsdk.add_any_connection(f"tcpout://127.0.0.1:{boat.port}")
    system = await mavsdk.first_autopilot(MOMENT_S)
    assert system is not None
    return system


def raw_items(places: list[Place]) -> list[RawItem]:
    return [
        RawItem(seq, place.frame, place.command, int(seq == 0), 1, 0.0, 0.0, 0.0, float("nan"), place.lat_e7,
                place.lon_e7, 0.0, 0)
        for seq, place in enumerate(places)
    ]  # fmt: skip


async def sail_with_mavsdk(boat: RunningBoat) -> None:
    configuration = Configuration.create_with_component_type(ComponentType.GROUND_STATION)
    async with Mavsdk(configuration) as mavsdk:
        system = await connected(mavsdk, boat)
        param, missions, action, telemetry = (
            ParamAsync(system), MissionRawAsync(system), ActionAsync(system), TelemetryAsync(system)
        )  # fmt: skip
        assert await param.get_param_float("CRUISE_SPEED") == CRUISE_M_S
        began_s = time.perf_counter()
        await missions.upload_mission(raw_items(ITEMS))
        uploaded_s = time.perf_counter()
        held = await missions.download_mission()
        read_s = time.perf_counter()
        tell("MAVSDK", "upload", uploaded_s - began_s)
        tell("MAVSDK", "download", read_s - uploaded_s)
        assert [Place(item.command, item.frame, item.x, item.y) for item in held[1:]] == ITEMS[1:]
        assert len(held) == len(ITEMS)

        async for health in telemetry.subscribe_health():  # AUTO is refused before the first fix
            if health.is_armable and health.is_global_position_ok:
                break
        await action.arm()
        await missions.start_mission()
        async for velocity in telemetry.subscribe_velocity_ned():
            if velocity.north_m_s > 0.5:
                break
        async for progress in missions.subscribe_mission_progress():
            if progress.current >= 2:
                break
        async for position in telemetry.subscribe_position():
            assert (position.latitude_deg - HOME.lat_e7 / 1e7) * 111_319.0 > 3.0
            break
        for plugin in (param, missions, action, telemetry):
            plugin.destroy()


def test_mavsdk_reads_parameters_brings_a_mission_and_sees_the_boat_sail(running_boat: RunBoat) -> None:
    log_subscribe(lambda *_: True)
    asyncio.run(asyncio.wait_for(sail_with_mavsdk(running_boat("open")), JOB_S))


def as_wpl(places: list[Place]) -> str:
    """The items in the text form that MAVProxy loads and saves."""
    rows = [
        f"{seq}\t{int(seq == 0)}\t{place.frame}\t{place.command}\t0\t0\t0\t0"
        f"\t{place.lat_e7 / 1e7:.7f}\t{place.lon_e7 / 1e7:.7f}\t0\t1"
        for seq, place in enumerate(places)
    ]
    return "\n".join(["QGC WPL 110", *rows, ""])


def from_wpl(text: str) -> list[Place]:
    rows = [line.split() for line in text.splitlines()[1:]]
    # MAVProxy keeps positions as 32-bit floats of degrees on the way from the wire to its file
    return [
        Place(int(row[3]), int(row[2]), round(float(row[8]) * 1e6) * 10, round(float(row[9]) * 1e6) * 10)
        for row in rows
    ]


def test_mavproxy_reads_parameters_brings_a_mission_and_sees_the_boat_sail(
    running_boat: RunBoat, run_program: RunProgram
) -> None:
    boat = running_boat("open")
    proxy = run_program("mavproxy.py", f"--master={boat.url}", "--state-basedir=.")
    (proxy.room / "brought.txt").write_text(as_wpl(ITEMS), encoding="ascii")
    proxy.wait_for("Received [0-9]+ parameters")
    proxy.say("param show CRUISE_SPEED")
    assert float(proxy.wait_for(r"CRUISE_SPEED +([0-9.]+)")[1]) == CRUISE_M_S
    proxy.say("wp load brought.txt")
    loaded_s = float(proxy.wait_for(r"Loaded 101 waypoints in ([0-9.]+)s")[1])
    tell("MAVProxy", "upload", loaded_s)
    proxy.wait_for("Got MISSION_ACK: TYPE_MISSION: ACCEPTED")
    began_s = time.perf_counter()
    proxy.say("wp save held.txt")
    proxy.wait_for(r"Saved 101 waypoints to held\.txt")
    tell("MAVProxy", "download", time.perf_counter() - began_s)
    assert from_wpl((proxy.room / "held.txt").read_text(encoding="ascii"))[1:] == ITEMS[1:]

    proxy.say("status GLOBAL_POSITION_INT")
    proxy.wait_for(r"GLOBAL_POSITION_INT \{")
    proxy.say("arm throttle")
    proxy.wait_for("Got COMMAND_ACK: COMPONENT_ARM_DISARM: ACCEPTED")
    proxy.wait_for("^ARMED")
    proxy.say("mode auto")
    proxy.wait_for("Got COMMAND_ACK: DO_SET_MODE: ACCEPTED")
    proxy.wait_for("Mode AUTO")
    proxy.wait_for("^waypoint 2")
    proxy.say("status VFR_HUD")
    speed_m_s = float(proxy.wait_for(r"VFR_HUD \{.*groundspeed : ([0-9.]+)")[1])
    assert speed_m_s > 0.5
    proxy.hang_up()
    proxy.wait()  # it ends with 1 however well it went
    assert not re.search("breach|error|Traceback", proxy.out + proxy.err, re.IGNORECASE)
