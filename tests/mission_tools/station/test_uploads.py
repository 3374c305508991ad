"""A plan on its way to a real boat: as it is, whole or not at all, read back before it is started."""

import pytest
from boat_rig import HOME_ITEM, Rig, waypoint
from shore_rig import Shore

from companion.core.geo import Point
from companion.mavlink.dialect import dialect
from companion.mavlink.items import MissionItem, MissionType
from mission_tools.station.items import ItemLists
from mission_tools.station.outcome import Accepted, Cancelled, Outcome, Refused, Silent
from mission_tools.station.uploads import LONGEST_S, ListUpload, Upload, first_difference, plan_upload

SPEED = MissionItem(
    frame=dialect.MAV_FRAME_MISSION,
    command=dialect.MAV_CMD_DO_CHANGE_SPEED,
    param1=1.0,
    param2=0.8,
    param3=-1.0,
)
HOLD = waypoint(30.0, 10.0, param1=4.0)
PLAN = (HOME_ITEM, SPEED, waypoint(20.0, 0.0), HOLD, waypoint(40.0, 20.0))


def survey(count: int) -> tuple[MissionItem, ...]:
    """A long plan."""
    return (HOME_ITEM, *(waypoint(20.0 + n % 2 * 30.0, 1.0 * n) for n in range(count)))


def fence(rig: Rig) -> tuple[MissionItem, ...]:
    """A square around everything, as a station sends it."""
    start = rig.scenario.start
    corners = []
    for north, east in ((-300.0, -300.0), (-300.0, 300.0), (300.0, 300.0), (300.0, -300.0)):
        at = rig.scenario.frame.to_global(Point(start.north_m + north, start.east_m + east))
        corners.append(
            MissionItem(
                frame=0, command=5001, param1=4.0, x=round(at.lat_deg * 1e7), y=round(at.lon_deg * 1e7)
            )
        )
    return tuple(corners)


def send(shore: Shore, upload: Upload, limit_s: float = 60.0) -> Outcome:
    """Upload, and wait for the one answer."""
    told: list[Outcome] = []
    shore.boats.upload(1, upload, told.append)
    assert shore.boats.is_transferring
    shore.until(lambda: bool(told), limit_s)
    shore.run(1.0)
    assert len(told) == 1
    return told[0]


def shore_of(rig: Rig) -> Shore:
    """The station of a boat that is ready."""
    return Shore(rig.ready()).ready()


def test_a_plan_arrives_although_a_fifth_of_the_frames_is_lost() -> None:
    rig = Rig()
    shore = shore_of(rig)
    assert shore.ask("arm").ok
    shore.ends[0].reseed(3, 0.2)
    plan = survey(25)
    upload = plan_upload(plan, is_started=True)
    assert send(shore, upload, upload.limit_s + 5.0) == Accepted("The boat sails the plan")
    assert tuple(rig.items()[1:]) == plan[1:]
    assert rig.mode == "AUTO"


def test_the_fence_of_a_plan_goes_first_and_only_where_it_is_wanted() -> None:
    rig = Rig()
    shore = shore_of(rig)
    square = fence(rig)
    for upload in (plan_upload(PLAN, square, is_started=False), plan_upload(PLAN[:3], is_started=False)):
        assert isinstance(send(shore, upload), Accepted)
        assert len(shore.features("fence")) == 1


def test_what_the_boat_refuses_leaves_the_old_mission_and_says_why() -> None:
    rig = Rig().ready()
    rig.upload([HOME_ITEM, waypoint(60.0, 0.0)])
    shore = Shore(rig).ready()
    before = rig.items()
    takeoff = MissionItem(frame=3, command=dialect.MAV_CMD_NAV_VTOL_TAKEOFF, x=PLAN[2].x, y=PLAN[2].y)
    refused = send(shore, plan_upload((HOME_ITEM, takeoff), is_started=True))
    assert isinstance(refused, Refused)
    assert refused.text.startswith("The boat refuses the plan: ")
    assert rig.items() == before
    assert rig.mode == "HOLD"


def test_hold_ends_the_upload_of_a_plan_that_would_be_started() -> None:
    rig = Rig()
    shore = shore_of(rig)
    assert shore.ask("arm").ok
    told: list[Outcome] = []
    shore.boats.upload(1, plan_upload(survey(40), is_started=True), told.append)
    shore.run(0.2)
    assert shore.ask("hold").ok
    shore.run(20.0)
    assert told == [Cancelled()]
    assert rig.mode == "LOITER"


def test_a_boat_whose_last_answer_is_lost_has_not_refused_the_plan() -> None:
    rig = Rig()
    shore = shore_of(rig)
    shore.ends[0].unheard = {dialect.MAVLINK_MSG_ID_MISSION_ACK}
    assert send(shore, plan_upload(PLAN, is_started=False)) == Silent()
    assert rig.items()[1:] == PLAN[1:]


def test_a_plan_that_cannot_be_read_back_is_not_started() -> None:
    rig = Rig()
    shore = shore_of(rig)
    assert shore.ask("arm").ok
    plan = survey(5)
    told: list[Outcome] = []
    shore.boats.upload(1, plan_upload(plan, is_started=True), told.append)
    shore.until(lambda: len(rig.items()) == len(plan), 10.0)
    mode = rig.mode
    shore.run(0.1)
    shore.ends[0].loss = 1.0
    shore.until(lambda: bool(told), LONGEST_S)
    assert isinstance(told[0], Silent)
    assert rig.mode == mode


def test_what_the_boat_holds_otherwise_is_not_started(monkeypatch: pytest.MonkeyPatch) -> None:
    rig = Rig()
    shore = shore_of(rig)
    assert shore.ask("arm").ok
    monkeypatch.setattr(ItemLists, "items", lambda _self, _kind: (*PLAN[:2], waypoint(21.0, 0.0), *PLAN[3:]))
    refused = send(shore, plan_upload(PLAN, is_started=True))
    assert isinstance(refused, Refused)
    assert refused.text.startswith(
        "The boat holds something else than was sent, from item 2 of the mission on"
    )
    assert rig.mode != "AUTO"


def test_differences_are_found_by_item_and_home_is_the_boats() -> None:
    part = ListUpload("mission", MissionType.MISSION, PLAN)
    assert first_difference(part, (waypoint(1.0, 1.0), *PLAN[1:])) is None
    assert first_difference(part, PLAN[:3]) == 3
    assert first_difference(part, (*PLAN[:2], waypoint(20.0, 0.1), *PLAN[3:])) == 2
    assert first_difference(part, (*PLAN[:3], waypoint(30.0, 10.0), PLAN[4])) == 3


def test_a_parameter_that_is_left_to_the_boat_may_come_back_as_anything() -> None:
    free = MissionItem(frame=3, command=16, param4=float("nan"), x=1, y=2)
    kept = MissionItem(frame=6, command=16, param4=0.0, x=1, y=2)
    assert first_difference(ListUpload("mission", MissionType.MISSION, (free, free)), (free, kept)) is None
    assert first_difference(ListUpload("mission", MissionType.MISSION, (free, kept)), (free, free)) == 1
