"""The power goes, and SMART_RTL still knows the way that the boat has come."""

import itertools
import math

import pytest
from boat_rig import OK, Rig, waypoint
from hypothesis import given
from hypothesis import strategies as st

from companion.boat import TICK_S
from companion.core.geo import Line, Point
from companion.core.modes import Mode
from companion.core.storage import MemoryStorage, Saving
from companion.mavlink.dialect import dialect
from companion.vehicle.track import CONTINUES_WITHIN_M, SailedTrack
from companion.vehicle.track_record import FILE, TrackRecord
from companion.vehicle.voyage_record import FILE as VOYAGE

pytestmark = pytest.mark.slow

START_S = 10.0  # a Pi takes longer
SAILED = [Point(0.0, 0.0), Point(40.0, 0.0), Point(40.0, 60.0), Point(0.0, 60.0)]


class Recording(MemoryStorage):
    """Notes when the trail was written, and how long it was."""

    def __init__(self) -> None:
        super().__init__()
        self.sizes: list[int] = []

    def save(self, name: str, content: bytes) -> Saving:
        """Replace the content."""
        if name == FILE:
            self.sizes.append(len(content))
        return super().save(name, content)


def on_the_last_leg(config: dict[str, object] | None = None) -> Rig:
    """Three sides of a square behind it, as home."""
    rig = Rig(config=config, storage=Recording())
    rig.sail(*(waypoint(point.north_m, point.east_m) for point in SAILED[1:]))
    rig.until(lambda: rig.boat.vehicle.progress.current_seq == 3, 120.0)
    rig.run(12.0)
    return rig


def cut(rig: Rig) -> Rig:
    """No power for a moment. The hull loses its way while the computer starts."""
    rig.world._motors.stop()
    for _ in range(round(START_S / TICK_S)):
        rig.world.step(TICK_S)
    rig.reboot()
    rig.ready()
    return rig


def off_the_track_m(rig: Rig) -> float:
    """How far the boat truly is from the sides that it has sailed."""
    at = Point(rig.world.truth.north_m, rig.world.truth.east_m)
    off = [math.dist(at, corner) for corner in SAILED]
    for start, end in itertools.pairwise(SAILED):
        along_m, cross_m = Line(start, end).along_and_cross_track_m(at)
        if 0.0 <= along_m <= math.dist(start, end):
            off.append(abs(cross_m))
    return min(off)


def sails_home_along_its_track(rig: Rig) -> bool:
    """Whether it gets home, and never leaves the sides of the square by more than corners take."""
    farthest_m = 0.0
    for _ in range(1500):
        rig.run(0.1)
        farthest_m = max(farthest_m, off_the_track_m(rig))
        if rig.offset_m(0.0, 0.0) < 3.0:
            return farthest_m < 4.0
    return False


def test_after_a_power_cut_smart_rtl_goes_back_the_way_the_boat_has_come() -> None:
    rig = cut(on_the_last_leg())
    assert rig.arm() == OK
    assert rig.set_mode(Mode.SMART_RTL) == OK
    assert sails_home_along_its_track(rig)


def test_a_boat_cut_on_its_way_back_goes_on_along_its_track_by_itself() -> None:
    rig = on_the_last_leg({"failsafe.resume": 2})
    assert rig.set_mode(Mode.SMART_RTL) == OK
    rig.run(25.0)
    cut(rig)
    assert any(text.endswith("on the way home: arm and SMART_RTL to resume") for text in rig.peer.texts)
    rig.until(lambda: rig.boat.vehicle.armed, 30.0)
    assert rig.mode == "SMART_RTL"
    assert sails_home_along_its_track(rig)


def test_a_boat_that_is_to_forget_forgets_its_track_too() -> None:
    rig = cut(on_the_last_leg({"failsafe.resume": 0}))
    assert not rig.boat.vehicle.track.points


def test_a_voyage_that_had_ended_leaves_no_track() -> None:
    rig = on_the_last_leg()
    rig.ask(dialect.MAV_CMD_COMPONENT_ARM_DISARM, 0.0)
    rig.run(1.0)
    assert not cut(rig).boat.vehicle.track.points


def test_another_voyage_s_track_is_not_taken_for_this_one_s() -> None:
    rig = on_the_last_leg()
    old = rig.storage.load(FILE)
    rig.ask(dialect.MAV_CMD_COMPONENT_ARM_DISARM, 0.0)
    rig.run(1.0)
    for _ in range(2):
        assert rig.arm() == OK
        rig.run(1.0)
        rig.ask(dialect.MAV_CMD_COMPONENT_ARM_DISARM, 0.0)
        rig.run(1.0)
    assert rig.arm() == OK
    rig.run(1.0)
    rig.storage.save(FILE, old)
    assert not cut(rig).boat.vehicle.track.points


def test_a_boat_that_was_carried_elsewhere_begins_a_new_track() -> None:
    trail = SailedTrack()
    trail.restore([Point(0.0, 0.0), Point(50.0, 0.0)])
    there = Point(50.0, CONTINUES_WITHIN_M + 1.0)
    assert not trail.continues_from(there)
    trail.restart(there)
    assert trail.points == [there]


def test_where_the_water_has_carried_it_to_is_a_point_of_the_track() -> None:
    trail = SailedTrack()
    trail.restore([Point(0.0, 0.0), Point(50.0, 0.0)])
    trail.restart(Point(50.0, 20.0))
    for metre in range(40):
        trail.add(Point(50.0 + metre, 20.0), 1.0, 500)
    assert trail.points == [Point(0.0, 0.0), Point(50.0, 0.0), Point(50.0, 20.0)]


def test_only_one_arming_goes_on_with_a_cut_track() -> None:
    trail = SailedTrack()
    trail.restore([Point(0.0, 0.0), Point(50.0, 0.0)])
    trail.restart(Point(50.0, 1.0))
    trail.restart(Point(50.0, 2.0))
    assert trail.points == [Point(50.0, 2.0)]


def test_the_medium_is_written_seldom_however_the_boat_winds() -> None:
    storage = Recording()
    rig = Rig(storage=storage, config={"modes.trail_accuracy_m": 0.2})
    corners = [waypoint(8.0 * n, 8.0 * (n % 2)) for n in range(1, 40)]
    rig.sail(*corners)
    storage.sizes.clear()
    rig.run(120.0)
    assert 6 <= len(storage.sizes) <= 13
    assert sum(storage.sizes) <= 120.0 * 1000.0


def test_a_track_of_the_most_points_is_written_no_faster_than_a_kilobyte_a_second() -> None:
    storage, trail = Recording(), SailedTrack()
    rig = Rig().ready()
    frame = rig.boat.vehicle.frame
    assert frame is not None
    record = TrackRecord(storage, trail, None)
    trail.restart(Point(0.0, 0.0))
    places = [Point(2.0 * n, 3.0 * (n % 7)) for n in range(4600)]
    for second in range(600):
        trail.points = places[: 4000 + second]
        record.update(1, frame, float(second))
    assert len(storage.sizes) >= 5
    assert sum(storage.sizes[:-1]) <= 600.0 * 1000.0


@given(
    st.binary(max_size=60)
    | st.builds(
        lambda voyage, places: f'{{"voyage": {voyage}, "places": {places}}}'.encode(),
        st.integers(-1, 2),
        st.lists(st.lists(st.integers(-(2**33), 2**33), max_size=3), max_size=5),
    )
)
def test_any_stored_track_gives_valid_places_or_none(content: bytes) -> None:
    storage = MemoryStorage()
    storage.content[FILE] = content
    rig = Rig()
    rig.storage.save(VOYAGE, b"")
    frame = rig.scenario.frame
    trail = SailedTrack()
    TrackRecord(storage, trail, 1).restore(frame, armed=False)
    assert all(math.isfinite(value) for point in trail.points for value in point)


@pytest.mark.parametrize("armed", [False, True])
def test_a_boat_that_was_armed_before_it_knew_where_it_is_keeps_its_new_track(armed: bool) -> None:
    storage = MemoryStorage()
    storage.content[FILE] = b'{"voyage": 1, "places": [[500000000, -12000000], [500000100, -12000000]]}'
    trail, frame = SailedTrack(), Rig().scenario.frame
    record = TrackRecord(storage, trail, 1)
    record.restore(None, armed=armed)
    record.restore(frame, armed=False)
    assert bool(trail.points) is not armed
