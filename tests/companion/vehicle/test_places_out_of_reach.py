"""Homes, rally points and altitudes that cannot be meant, and when a mission ends that ends at home."""

import math
from dataclasses import replace

import pytest
from boat_rig import BOAT, DENIED, FRAME, HOME_ITEM, OK, Rig, nav_at, place, waypoint

from companion.config.boat_config import BoatConfig
from companion.core.geo import LatLon
from companion.core.modes import Mode
from companion.core.requests import ChangeMode, SetHome, StartMission
from companion.core.status_text import StatusText
from companion.core.units import deg_to_e7
from companion.mavlink.dialect import dialect
from companion.mavlink.items import MissionItem, MissionResult, MissionType
from companion.mavlink.transfer import Completed, Failed
from companion.vehicle.mission.steps import Home, ReturnHome, Waypoint
from companion.vehicle.vehicle import Vehicle

CMD = dialect


def afloat(vehicle: Vehicle, north_m: float, now_s: float) -> list[StatusText]:
    """The boat is there, and decides."""
    vehicle.update_state(nav_at(north_m, time_s=now_s), FRAME, None, None, now_s)
    vehicle.decide()
    return vehicle.take_status_texts()


# The end of a mission at home


def test_a_mission_that_ends_at_home_is_complete_when_the_boat_is_there() -> None:
    vehicle = Vehicle(BoatConfig())
    afloat(vehicle, 0.0, 1.0)
    vehicle.set_mission((Home(), Waypoint(place(50.0, 0.0)), ReturnHome()))
    vehicle.arm(force=True)
    assert vehicle.request(StartMission()).accepted
    told = [notice.text for now_s in (2.0, 3.0, 4.0) for notice in afloat(vehicle, 50.0, now_s)]
    assert vehicle.mode is Mode.RTL
    assert "Mission complete" not in told
    assert vehicle.is_returning_from_mission
    told = [notice.text for now_s in (60.0, 61.0, 62.0) for notice in afloat(vehicle, 0.5, now_s)]
    assert [text for text in told if text == "Mission complete"] == ["Mission complete"]
    assert not vehicle.is_returning_from_mission


def test_a_mission_that_is_called_off_on_its_way_home_is_not_complete() -> None:
    vehicle = Vehicle(BoatConfig())
    afloat(vehicle, 0.0, 1.0)
    vehicle.set_mission((Home(), Waypoint(place(50.0, 0.0)), ReturnHome()))
    vehicle.arm(force=True)
    vehicle.request(StartMission())
    afloat(vehicle, 50.0, 2.0)
    assert vehicle.request(ChangeMode(Mode.LOITER)).accepted
    vehicle.request(ChangeMode(Mode.RTL))
    told = [notice.text for now_s in (60.0, 61.0) for notice in afloat(vehicle, 0.5, now_s)]
    assert "Mission complete" not in told


# Homes


@pytest.mark.parametrize(("north_m", "is_home"), [(99_000.0, True), (101_000.0, False)])
def test_a_home_beyond_the_local_frame_is_refused(north_m: float, is_home: bool) -> None:
    vehicle = Vehicle(BoatConfig())
    afloat(vehicle, 0.0, 1.0)
    before = vehicle.home
    outcome = vehicle.request(SetHome(place(north_m, 0.0)))
    assert outcome.accepted is is_home
    assert (vehicle.home == before) is not is_home
    if not is_home:
        assert [notice.text for notice in vehicle.take_status_texts()] == ["Home: more than 100 km away"]


def test_the_way_to_a_home_on_the_other_side_of_the_globe_is_refused() -> None:
    vehicle = Vehicle(BoatConfig())
    assert vehicle.request(SetHome(LatLon(-50.0, 178.8))).accepted  # nobody knows yet where the boat is
    afloat(vehicle, 0.0, 1.0)
    assert vehicle.request(ChangeMode(Mode.RTL)).reason == "RTL: home is more than 100 km away"
    assert vehicle.mode is not Mode.RTL


# Item 0


def test_item_0_comes_back_as_home_and_not_as_a_station_has_put_it(rig: Rig) -> None:
    invented = MissionItem(frame=0, command=16, x=deg_to_e7(51.0), y=deg_to_e7(-2.0), z=77.0)
    assert isinstance(rig.upload([invented, waypoint(40.0, 0.0)]), Completed)
    home = rig.boat.vehicle.home
    assert home is not None
    rig.peer.forget()
    rig.peer.send(dialect.MAVLink_mission_request_int_message(*BOAT, 0, 0))
    rig.peer.send(dialect.MAVLink_mission_request_list_message(*BOAT, 0))
    rig.receive()
    rig.peer.send(dialect.MAVLink_mission_request_int_message(*BOAT, 0, 0))
    rig.receive()
    item = rig.peer.said("MISSION_ITEM_INT")[-1]
    assert (item.seq, item.frame, item.command) == (0, 0, 16)
    assert (item.x, item.y) == (deg_to_e7(home.lat_deg), deg_to_e7(home.lon_deg))
    assert rig.items()[0] == invented  # what is stored is what came


# Rally points and altitudes


@pytest.fixture
def rig() -> Rig:
    """A boat that knows where it is."""
    return Rig().ready()


def circle(radius_m: float) -> MissionItem:
    return waypoint(0.0, 0.0, command=5003, param1=radius_m)


def rally(north_m: float) -> MissionItem:
    return waypoint(north_m, 0.0, command=5100)


def test_a_rally_point_outside_the_fence_is_told_whichever_comes_first(rig: Rig) -> None:
    assert isinstance(rig.upload([circle(100.0)], mission_type=MissionType.FENCE), Completed)
    rig.peer.forget()
    assert isinstance(rig.upload([rally(50.0), rally(150.0)], mission_type=MissionType.RALLY), Completed)
    assert [text for text in rig.peer.texts if "Rally" in text] == ["Rally point 1 is outside the fence"]
    rig.peer.forget()
    assert isinstance(rig.upload([circle(40.0)], mission_type=MissionType.FENCE), Completed)
    assert [text for text in rig.peer.texts if "Rally" in text] == [
        "Rally point 0 is outside the fence",
        "Rally point 1 is outside the fence",
    ]


@pytest.mark.parametrize("kind", list(MissionType))
@pytest.mark.parametrize("altitude_m", [math.nan, math.inf, -math.inf, 1e9, -83_001.0])
def test_an_altitude_that_is_none_is_refused_by_name(rig: Rig, kind: MissionType, altitude_m: float) -> None:
    command = {MissionType.MISSION: 16, MissionType.FENCE: 5003, MissionType.RALLY: 5100}[kind]
    items = [replace(waypoint(10.0, 0.0, command=command, param1=5.0), z=altitude_m)]
    outcome = rig.upload([HOME_ITEM, *items] if kind is MissionType.MISSION else items, mission_type=kind)
    assert isinstance(outcome, Failed)
    assert outcome.result is MissionResult.INVALID_PARAM7
    assert any("altitude" in text for text in rig.peer.texts)


@pytest.mark.parametrize(
    ("altitude_m", "result"), [(math.inf, DENIED), (1e9, DENIED), (50.0, OK), (math.nan, OK)]
)
@pytest.mark.parametrize(
    ("number", "params"),
    [(CMD.MAV_CMD_DO_REPOSITION, (-1.0, 1.0, 0.0, math.nan)), (CMD.MAV_CMD_DO_SET_HOME, (0.0,) * 4)],
)
def test_a_command_to_a_place_without_an_altitude_that_may_be_meant_is_denied(
    rig: Rig, number: int, params: tuple[float, ...], altitude_m: float, result: int
) -> None:
    assert rig.ask(number, *params, 50.001, -1.2, altitude_m) == result
