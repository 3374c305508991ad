"""The power goes and comes back: the boat knows its voyage, and SMART_RTL the way that it has come."""

import functools
import itertools
import json
import math

import pytest
from boat_rig import FRAME, OK, Rig, waypoint
from fence_rig import EXCLUDED, box, fenced, margin_m, polygon
from hypothesis import given
from hypothesis import strategies as st

from companion.boat import TICK_S
from companion.config.boat_config import BoatConfig
from companion.core.geo import LatLon, Line, LocalFrame, Point
from companion.core.modes import Mode
from companion.core.storage import MemoryStorage, Saving, ended
from companion.mavlink.dialect import dialect
from companion.vehicle.resume import CHECK_S, VoyageResume
from companion.vehicle.track import CONTINUES_WITHIN_M, SailedTrack
from companion.vehicle.track_record import FILE as TRACK
from companion.vehicle.track_record import TrackRecord
from companion.vehicle.vehicle import Vehicle
from companion.vehicle.voyage_record import FILE

pytestmark = pytest.mark.slow

SAILED = [Point(0.0, 0.0), Point(25.0, 0.0), Point(25.0, 40.0), Point(0.0, 40.0)]
LEGS = [waypoint(*at) for at in SAILED[1:]]


class Counting(MemoryStorage):
    """Notes how long each record was, by its name."""

    def __init__(self) -> None:
        super().__init__()
        self.sizes: dict[str, list[int]] = {FILE: [], TRACK: []}

    def save(self, name: str, content: bytes) -> Saving:
        """Replace the content."""
        self.sizes.setdefault(name, []).append(len(content))
        return super().save(name, content)


def cut(rig: Rig, dark_s: float = 0.0) -> Rig:
    """No power for a time: the motors stop, memory is gone, what is stored is not."""
    rig.world._motors.stop()
    for _ in range(round(dark_s / TICK_S)):
        rig.world.step(TICK_S)
    rig.reboot()
    return rig


def in_mid_leg(seq: int = 2, config: dict[str, object] | None = None) -> Rig:
    """Under way to an item of the mission for some time."""
    rig = Rig(config=config).sail(*LEGS)
    rig.until(lambda: rig.boat.vehicle.progress.current_seq == seq, 120.0)
    rig.run(8.0)
    return rig


@functools.cache
def _stored() -> dict[str, bytes]:
    rig = in_mid_leg()
    assert isinstance(rig.storage, MemoryStorage)
    return dict(rig.storage.content)


def restarted(config: dict[str, object] | None = None) -> Rig:
    """A boat with the memory of one that was cut in mid-leg, back at the start."""
    storage = MemoryStorage()
    storage.content.update(_stored())
    return Rig(config=config, storage=storage)


# The voyage


def test_the_boat_says_where_it_was_and_goes_on_from_there_when_told() -> None:
    rig = cut(in_mid_leg()).ready()
    assert any(
        text.startswith("Power lost at item 2, ") and text.endswith("arm and MISSION_START to resume")
        for text in rig.peer.texts
    )
    rig.run(20.0)
    assert (rig.world._motors.left, rig.world._motors.right) == (0.0, 0.0)
    assert rig.arm() == OK
    assert rig.ask(dialect.MAV_CMD_MISSION_START) == OK
    rig.run(1.0)
    line, frame = rig.boat.vehicle.progress.leg_line(), rig.boat.vehicle.frame
    assert line is not None
    assert frame is not None
    start = rig.scenario.frame.to_local(frame.to_global(line.start))
    assert start == pytest.approx((25.0, 0.0), abs=2.5), "the old leg, not one from here"
    rig.until(lambda: rig.mode != "AUTO", 90.0)
    assert [message.seq for message in rig.peer.said("MISSION_ITEM_REACHED")] == [2, 3]


def test_a_boat_that_may_goes_on_by_itself_after_a_warning() -> None:
    rig = restarted({"failsafe.resume": 2})
    rig.until(lambda: any("Resuming in 10 s" in text for text in rig.peer.texts), 30.0)
    rig.run(9.0)
    assert not rig.boat.vehicle.armed
    rig.run(2.0)
    assert (rig.mode, rig.boat.vehicle.armed) == ("AUTO", True)


@pytest.mark.parametrize("objection", ["mode", "disarm"])
def test_whoever_objects_in_time_keeps_the_boat_where_it_is(objection: str) -> None:
    rig = restarted({"failsafe.resume": 2})
    rig.until(lambda: any("Resuming in" in text for text in rig.peer.texts), 30.0)
    rig.run(5.0)
    if objection == "mode":
        assert rig.set_mode(Mode.HOLD) == OK
    else:
        assert rig.ask(dialect.MAV_CMD_COMPONENT_ARM_DISARM, 0.0) == OK
    rig.run(20.0)
    assert not rig.boat.vehicle.armed


def outside(resume: int) -> Rig:
    """Cut in mid-leg; without power the water carries the boat over the fence beside its leg."""
    water = ("environment.current_m_s=0.5", "environment.current_to_deg=0.0")
    rig = Rig("open", *water, config={"failsafe.resume": resume}).ready()
    fenced(rig, *polygon(box(30.0, -10.0, 70.0, 60.0), EXCLUDED))
    rig.sail(*LEGS)
    rig.until(lambda: rig.boat.vehicle.progress.current_seq == 2, 60.0)
    rig.run(6.0)
    rig.world._motors.stop()
    while margin_m(rig) > -3.0:
        rig.world.step(TICK_S)
    rig.reboot()
    return rig


@pytest.mark.parametrize("objects", [False, True])
def test_a_boat_whose_power_is_back_outside_the_fence_comes_inside_and_sails_on(objects: bool) -> None:
    rig = outside(2)
    rig.until(lambda: rig.boat.vehicle.armed, 40.0)
    rig.step()
    assert rig.mode == "LOITER"
    assert "Outside the fence: returning inside first" in rig.peer.texts
    if objects:
        assert rig.set_mode(Mode.LOITER) == OK
        rig.run(25.0)
        assert (rig.mode, margin_m(rig) > 0.0) == ("LOITER", True)
    else:
        rig.until(lambda: rig.mode == "AUTO", 40.0)
        assert margin_m(rig) > 1.5
        assert rig.boat.vehicle.progress.current_seq == 2


def test_a_boat_that_is_to_forget_begins_at_the_first_item_without_a_track() -> None:
    assert restarted().boat.vehicle.progress.current_seq == 2
    rig = restarted({"failsafe.resume": 0}).ready()
    assert rig.boat.vehicle.progress.current_seq == 1
    assert not any("Power lost" in text for text in rig.peer.texts)
    assert not rig.boat.vehicle.track.points
    assert len(restarted().ready().boat.vehicle.track.points) >= 2


def test_a_boat_that_was_disarmed_has_nothing_to_take_up() -> None:
    rig = Rig().sail(*LEGS)
    rig.boat.vehicle.progress.set_current(2)
    rig.run(3.0)
    rig.ask(dialect.MAV_CMD_COMPONENT_ARM_DISARM, 0.0)
    rig.run(CHECK_S + TICK_S)
    vehicle = cut(rig).ready().boat.vehicle
    assert (vehicle.progress.current_seq, vehicle.track.points) == (1, [])


def test_the_records_are_written_seldom() -> None:
    storage = Counting()
    Rig(storage=storage).sail(waypoint(400.0, 0.0)).run(50.0)
    assert 5 <= len(storage.sizes[FILE]) <= 9
    winding = Counting()
    rig = Rig(storage=winding, config={"modes.trail_accuracy_m": 0.2})
    rig.sail(*(waypoint(8.0 * n, 8.0 * (n % 2)) for n in range(1, 40))).run(60.0)
    assert 3 <= len(winding.sizes[TRACK]) <= 8
    assert sum(winding.sizes[TRACK]) <= 60.0 * 1000.0


def test_a_full_medium_is_told_and_the_boat_sails_on() -> None:
    class Full(MemoryStorage):
        is_full = False

        def save(self, name: str, content: bytes) -> Saving:
            """Refuse the record, once full."""
            return ended("No space left on device") if self.is_full else super().save(name, content)

    storage = Full()
    rig = Rig(storage=storage).sail(waypoint(400.0, 0.0))
    storage.is_full = True
    rig.until(lambda: "Failsafe: Storage failed: No space left on device" in rig.peer.texts, 30.0)
    storage.is_full = False
    rig.until(lambda: "Failsafe over: storage works again" in rig.peer.texts, 40.0)
    assert rig.mode == "AUTO"


def test_a_boat_that_was_on_its_way_home_by_rtl_is_offered_rtl_though_it_has_a_track() -> None:
    rig = restarted()
    voyage = json.loads(_stored()[FILE]) | {"mode": int(Mode.RTL)}
    assert isinstance(rig.storage, MemoryStorage)
    rig.storage.content[FILE] = json.dumps(voyage).encode()
    rig.reboot()
    rig.ready()
    assert any(text.endswith("on the way home: arm and RTL to resume") for text in rig.peer.texts)


def test_a_voyage_record_that_cannot_be_read_is_told() -> None:
    storage, vehicle = MemoryStorage(), Vehicle(BoatConfig())
    storage.content[FILE] = b"{"
    VoyageResume(storage, vehicle)
    (told,) = vehicle.data_losses.update(100.0)
    assert told.startswith("Voyage record lost: ")


@given(
    st.binary(max_size=80)
    | st.dictionaries(st.text(max_size=8), st.integers()).map(json.dumps).map(str.encode)
)
def test_the_boat_starts_with_any_content_in_the_voyage_record(content: bytes) -> None:
    storage, vehicle = MemoryStorage(), Vehicle(BoatConfig())
    storage.content[FILE] = content
    VoyageResume(storage, vehicle).update(vehicle, 1.0)
    assert not vehicle.armed


# The track


def off_the_track_m(rig: Rig) -> float:
    """How far the boat truly is from the sides that it has sailed."""
    at = Point(rig.world.truth.north_m, rig.world.truth.east_m)
    off = [math.dist(at, corner) for corner in SAILED]
    for start, end in itertools.pairwise(SAILED):
        along_m, cross_m = Line(start, end).along_and_cross_track_m(at)
        if 0.0 <= along_m <= math.dist(start, end):
            off.append(abs(cross_m))
    return min(off)


@pytest.mark.parametrize("by_itself", [False, True])
def test_after_a_power_cut_smart_rtl_goes_back_the_way_the_boat_has_come(by_itself: bool) -> None:
    rig = in_mid_leg(3, {"failsafe.resume": 2 if by_itself else 1})
    if by_itself:
        assert rig.set_mode(Mode.SMART_RTL) == OK
        rig.run(20.0)  # past the corner
    cut(rig, 10.0).ready()
    if by_itself:
        assert any(text.endswith("on the way home: arm and SMART_RTL to resume") for text in rig.peer.texts)
        rig.until(lambda: rig.boat.vehicle.armed, 30.0)
        assert rig.mode == "SMART_RTL"
    else:
        assert rig.arm() == OK
        assert rig.set_mode(Mode.SMART_RTL) == OK
    farthest_m = 0.0
    while rig.offset_m(0.0, 0.0) >= 3.0:
        rig.run(0.1)
        farthest_m = max(farthest_m, off_the_track_m(rig))
        assert rig.now_s < 400.0
    assert farthest_m < 4.0, "but for the corners, along the sides of the square"


@pytest.mark.parametrize(
    ("armed_at", "kept"),
    [([Point(50.0, CONTINUES_WITHIN_M + 1.0)], 0), ([Point(50.0, 20.0)], 2), ([Point(50.0, 1.0)] * 2, 0)],
    ids=["carried elsewhere", "near its end", "armed a second time"],
)
def test_a_cut_track_goes_on_once_where_it_ended(armed_at: list[Point], kept: int) -> None:
    cut_track = [Point(0.0, 0.0), Point(50.0, 0.0)]
    trail = SailedTrack()
    trail.restore(cut_track)
    for at in armed_at:
        trail.restart(at)
    for metre in range(40):
        trail.add(Point(armed_at[-1].north_m + metre, armed_at[-1].east_m), 1.0, 500)
    assert trail.points == [*cut_track[:kept], armed_at[-1]]


def test_a_track_of_the_most_points_is_written_no_faster_than_a_kilobyte_a_second() -> None:
    storage, trail = Counting(), SailedTrack()
    record = TrackRecord(storage, trail, None)
    places = [Point(2.0 * n, 3.0 * (n % 7)) for n in range(4300)]
    for second in range(300):
        trail.points = places[: 4000 + second]
        record.update(1, FRAME, float(second))
    assert len(storage.sizes[TRACK]) >= 3
    assert sum(storage.sizes[TRACK][:-1]) <= 300.0 * 1000.0


def test_the_place_of_a_point_is_computed_once() -> None:
    class Frame(LocalFrame):
        computed: list[Point]

        def to_global(self, point: Point) -> LatLon:
            self.computed.append(point)
            return super().to_global(point)

    storage, trail, frame = MemoryStorage(), SailedTrack(), Frame(FRAME.origin)
    frame.computed = []
    record = TrackRecord(storage, trail, None)
    for count in (2, 3, 4):
        trail.points = SAILED[:count]
        record.update(1, frame, 100.0 * count)
    assert frame.computed == SAILED
    trail.points = [SAILED[0], SAILED[3]]  # a loop was cut off
    record.update(1, frame, 500.0)
    assert frame.computed == [*SAILED, SAILED[3]]
    assert len(json.loads(storage.content[TRACK])["places"]) == 2


@given(
    st.binary(max_size=60)
    | st.builds(
        lambda voyage, places: f'{{"voyage": {voyage}, "places": {places}}}'.encode(),
        st.integers(-1, 2),
        st.lists(st.lists(st.integers(-(2**33), 2**33), max_size=3), max_size=5),
    )
)
def test_any_stored_track_gives_valid_places_or_none(content: bytes) -> None:
    storage, trail = MemoryStorage(), SailedTrack()
    storage.content[TRACK] = content
    TrackRecord(storage, trail, 1).restore(FRAME, armed=False)
    assert all(math.isfinite(value) for point in trail.points for value in point)


# Called home by the charge. The fence keeps a block out between home and the second leg, 60 m north

NORTH = [waypoint(60.0, 0.0), waypoint(60.0, 60.0), waypoint(75.0, 60.0), waypoint(75.0, 0.0)]
BLOCK = box(15.0, -20.0, 45.0, 45.0)
SMALL: dict[str, object] = {"battery.capacity_mah": 150.0, "fence.margin_m": 1.0, "mission.done_behave": 1}


@functools.cache
def _called_home() -> tuple[MemoryStorage, Point]:
    """What a boat has stored that its charge called home from the second leg and that was disarmed there; and
    where it left the leg.
    """
    rig = Rig(config=SMALL).ready()
    fenced(rig, *polygon(box(-30.0, -60.0, 110.0, 110.0)), *polygon(BLOCK, EXCLUDED))
    rig.sail(waypoint(0.0, -40.0), waypoint(60.0, -40.0), *NORTH[1:])
    rig.until(lambda: rig.mode == "RTL", 200.0)
    assert rig.boat.vehicle.progress.current_seq == 3
    left = rig.world.truth
    rig.until(lambda: any(text.startswith("RTL: arrived") for text in rig.peer.texts), 200.0)
    assert rig.ask(dialect.MAV_CMD_COMPONENT_ARM_DISARM, 0.0) == OK
    rig.run(1.0)
    assert isinstance(rig.storage, MemoryStorage)
    return rig.storage, Point(left.north_m, left.east_m)


def with_a_new_pack(config: dict[str, object] | None = None) -> Rig:
    """The boat of `_called_home` at home, switched on with a full pack, which lasts for all of it."""
    storage = MemoryStorage()
    storage.content.update(_called_home()[0].content)
    return Rig(config=SMALL | {"battery.capacity_mah": 5000.0} | (config or {}), storage=storage).ready()


def test_a_boat_that_its_charge_called_home_goes_on_where_it_left_its_leg_after_the_pack_was_changed() -> (
    None
):
    rig, (north_m, east_m) = with_a_new_pack(), _called_home()[1]
    assert "Charge ended on the leg to item 3: arm and MISSION_START to resume" in rig.peer.texts
    assert rig.arm() == OK
    assert rig.set_mode(Mode.AUTO) == OK
    rig.run(0.2)
    assert "Going on where the charge ended, on the leg to item 3" in rig.peer.texts
    track, least_m = [], math.inf
    while rig.mode == "AUTO":
        rig.run(0.2)
        track.append(Point(rig.world.truth.north_m, rig.world.truth.east_m))
        least_m = min(least_m, margin_m(rig))
        assert len(track) < 2000
    assert least_m > 0.3, "round the block, not straight over it"
    back = min(range(len(track)), key=lambda n: math.hypot(track[n][0] - north_m, track[n][1] - east_m))
    assert math.hypot(track[back][0] - north_m, track[back][1] - east_m) < 4.0
    line = Line(Point(60.0, -40.0), Point(60.0, 60.0))
    on_leg = [line.along_and_cross_track_m(at) for at in track[back + 10 :]]
    rest = [abs(cross_m) for along_m, cross_m in on_leg if along_m < line.length_m - 5.0][:150]
    assert max(rest[:60]) < 2.0
    assert [message.seq for message in rig.peer.said("MISSION_ITEM_REACHED")] == [3, 4, 5]


def test_a_boat_that_was_disarmed_at_home_never_goes_out_again_by_itself() -> None:
    rig = with_a_new_pack({"failsafe.resume": 2})
    rig.run(30.0)
    assert not rig.boat.vehicle.armed
    assert with_a_new_pack({"failsafe.resume": 0}).boat.vehicle.progress.current_seq == 1


def test_the_place_on_the_leg_outlasts_a_second_restart_and_is_forgotten_with_the_item() -> None:
    rig = with_a_new_pack()
    rig.reboot()
    progress = rig.ready().boat.vehicle.progress
    assert progress.left is not None
    assert rig.arm() == OK
    rig.run(1.0)
    assert rig.ask(dialect.MAV_CMD_COMPONENT_ARM_DISARM, 0.0) == OK
    rig.run(1.0)
    rig.reboot()
    assert rig.ready().boat.vehicle.progress.left == progress.left
    rig.boat.vehicle.progress.set_current(3)
    assert rig.boat.vehicle.progress.left is None
