"""MAVSDK's plugins, one after the other, against the emulator as a process."""

import asyncio
import math
from collections.abc import AsyncIterator, Callable, Coroutine, Iterator
from typing import Any

import pytest
from mavsdk.asyncio import System
from mavsdk.asyncio.plugins.action import ActionAsync
from mavsdk.asyncio.plugins.failure import FailureAsync
from mavsdk.asyncio.plugins.geofence import GeofenceAsync
from mavsdk.asyncio.plugins.info import InfoAsync
from mavsdk.asyncio.plugins.manual_control import ManualControlAsync
from mavsdk.asyncio.plugins.mission_raw import MissionRawAsync
from mavsdk.asyncio.plugins.param import ParamAsync
from mavsdk.asyncio.plugins.telemetry import TelemetryAsync
from mavsdk.logging import log_subscribe
from mavsdk.plugins.failure import FailureError, FailureType, FailureUnit
from mavsdk.plugins.geofence import FenceType, GeofenceData, Point, Polygon
from mavsdk.plugins.param import ParamError
from mavsdk_station import mavsdk_station, places_of, raw
from mavutil_station import HOME, MavutilStation, Place, zigzag
from patience import JOB_S
from programs import RunningBoat, start_boat
from pymavlink.dialects.v20 import all as dialect

pytestmark = pytest.mark.realtime

MANUAL = 0
Job = Callable[[System], Coroutine[Any, Any, None]]


@pytest.fixture(scope="module")
def boat(tmp_path_factory: pytest.TempPathFactory) -> Iterator[RunningBoat]:
    """One boat for all."""
    log_subscribe(lambda *_: True)
    running = start_boat(tmp_path_factory.mktemp("mavsdk") / "boat", "open")
    yield running
    running.program.close()


def run(boat: RunningBoat, job: Job) -> None:
    """Connect and do a job, in bounded time."""

    async def connected() -> None:
        async with mavsdk_station(boat.port) as system:
            await job(system)

    asyncio.run(asyncio.wait_for(connected(), JOB_S))


def test_action_arms_starts_a_mission_goes_holds_returns_and_disarms(boat: RunningBoat) -> None:
    async def job(system: System) -> None:
        action, telemetry, missions = ActionAsync(system), TelemetryAsync(system), MissionRawAsync(system)
        await missions.upload_mission(raw(zigzag(3)))
        async for health in telemetry.subscribe_health():
            if health.is_armable and health.is_global_position_ok:
                break
        await action.arm()
        async for armed in telemetry.subscribe_armed():
            if armed:
                break
        await missions.start_mission()
        async for progress in missions.subscribe_mission_progress():
            if progress.current >= 2:
                break
        await action.goto_location(HOME.lat_e7 / 1e7 + 2e-4, HOME.lon_e7 / 1e7, 0.0, math.nan)
        async for velocity in telemetry.subscribe_velocity_ned():
            if velocity.north_m_s > 0.3:
                break
        await action.hold()
        await action.return_to_launch()
        await action.disarm()
        for plugin in (action, telemetry, missions):
            plugin.destroy()

    run(boat, job)


def test_mission_raw_brings_all_three_lists_and_reads_them_back(boat: RunningBoat) -> None:
    corners = [(10, 10), (10, -10), (-10, -10), (-10, 10)]
    fence = [Place(5001, 0, HOME.lat_e7 + 1000 * north, HOME.lon_e7 + 1000 * east) for north, east in corners]
    rally = [Place(5100, 3, HOME.lat_e7 + 1000 * number, HOME.lon_e7) for number in range(1, 4)]

    async def job(system: System) -> None:
        missions = MissionRawAsync(system)
        await missions.upload_mission(raw(zigzag(20)))
        await missions.upload_geofence(raw(fence, 1, 4.0))
        await missions.upload_rally_points(raw(rally, 2))
        assert places_of(await missions.download_mission())[1:] == zigzag(20)[1:]
        assert places_of(await missions.download_geofence()) == fence
        assert places_of(await missions.download_rallypoints()) == rally
        await missions.set_current_mission_item(5)
        async for progress in missions.subscribe_mission_progress():
            if progress.current == 5:
                break
        await missions.clear_mission()
        assert len(await missions.download_mission()) <= 1
        missions.destroy()

    run(boat, job)


def test_geofence_brings_a_polygon(boat: RunningBoat) -> None:
    lat_deg, lon_deg = HOME.lat_e7 / 1e7, HOME.lon_e7 / 1e7
    corners = [
        Point(lat_deg + north, lon_deg + east) for north, east in ((1e-3, 1e-3), (1e-3, -1e-3), (-1e-3, 0.0))
    ]

    async def job(system: System) -> None:
        geofence = GeofenceAsync(system)
        await geofence.upload_geofence(GeofenceData([Polygon(corners, FenceType.INCLUSION)], []))
        await geofence.clear_geofence()
        geofence.destroy()

    run(boat, job)


def test_param_reads_all_and_sets_one(boat: RunningBoat) -> None:
    async def job(system: System) -> None:
        param = ParamAsync(system)
        everything = await param.get_all_params()
        assert "CRUISE_SPEED" in {one.name for one in everything.float_params}
        await param.set_param_float("CRUISE_SPEED", 1.25)
        assert await param.get_param_float("CRUISE_SPEED") == 1.25
        await param.set_param_float("CRUISE_SPEED", 2.0)
        with pytest.raises(ParamError):
            await param.get_param_float("NO_SUCH_THING")
        param.destroy()

    run(boat, job)


def test_telemetry_and_info_tell_who_and_where_the_boat_is(boat: RunningBoat) -> None:
    async def job(system: System) -> None:
        telemetry, info = TelemetryAsync(system), InfoAsync(system)
        version = await info.get_version()
        assert (version.flight_sw_major, version.flight_sw_minor) == (4, 6)
        async for position in telemetry.subscribe_position():
            assert abs(position.latitude_deg - HOME.lat_e7 / 1e7) < 0.01
            break
        async for battery in telemetry.subscribe_battery():
            assert 9.0 < battery.voltage_v < 13.0
            break
        async for attitude in telemetry.subscribe_attitude_euler():
            assert abs(attitude.roll_deg) < 45.0
            break
        async for fix in telemetry.subscribe_gps_info():
            assert fix.num_satellites > 3
            break
        async for home in telemetry.subscribe_home():
            assert abs(home.latitude_deg - HOME.lat_e7 / 1e7) < 0.01
            break
        for plugin in (telemetry, info):
            plugin.destroy()

    run(boat, job)


def test_manual_control_drives(boat: RunningBoat) -> None:
    pilot = MavutilStation(boat.port, 254)
    assert pilot.enter(MANUAL) == dialect.MAV_RESULT_ACCEPTED  # MAVSDK knows no name for this mode of a boat
    pilot.close()

    async def job(system: System) -> None:
        action, manual, telemetry = ActionAsync(system), ManualControlAsync(system), TelemetryAsync(system)

        async def hold_the_stick() -> None:
            while True:
                await manual.set_manual_control_input(0.0, 0.0, 0.6, 0.0)
                await asyncio.sleep(0.1)

        await action.arm()
        hand = asyncio.create_task(hold_the_stick())
        async for velocity in telemetry.subscribe_velocity_ned():
            if math.hypot(velocity.north_m_s, velocity.east_m_s) > 0.5:
                break
        hand.cancel()
        await action.disarm()
        await action.hold()
        for plugin in (action, manual, telemetry):
            plugin.destroy()

    run(boat, job)


def test_failure_breaks_what_the_emulator_has_and_mends_it_again(boat: RunningBoat) -> None:
    async def job(system: System) -> None:
        failure, telemetry = FailureAsync(system), TelemetryAsync(system)
        texts = telemetry.subscribe_status_text()
        said = asyncio.ensure_future(_until_said(texts, "Fault: gnss off"))
        await asyncio.sleep(0)
        await _injected(failure, FailureUnit.SENSOR_GPS, FailureType.OFF)
        await said
        await _injected(failure, FailureUnit.SENSOR_GPS, FailureType.OK)
        with pytest.raises(FailureError) as refused:
            await failure.inject(FailureUnit.SENSOR_BARO, FailureType.OFF, 0)
        assert "UNSUPPORTED" in str(refused.value)
        await texts.aclose()
        for plugin in (failure, telemetry):
            plugin.destroy()

    run(boat, job)


async def _injected(failure: FailureAsync, unit: FailureUnit, kind: FailureType) -> None:
    """The plugin first asks the boat whether it lets itself be broken, and is in no hurry about it."""
    for _ in range(40):
        try:
            await failure.inject(unit, kind, 0)
        except FailureError:
            await asyncio.sleep(0.1)
        else:
            return
    await failure.inject(unit, kind, 0)


async def _until_said(texts: AsyncIterator[Any], wanted: str) -> None:
    async for text in texts:
        if text.text == wanted:
            return
