"""The power goes in mid-mission, and comes back."""

import json

import pytest
from boat_rig import OK, Rig, waypoint
from fence_rig import EXCLUDED, box, fenced, margin_m, polygon
from hypothesis import given
from hypothesis import strategies as st

from companion.boat import TICK_S
from companion.core.modes import Mode
from companion.core.storage import MemoryStorage, Saving
from companion.mavlink.dialect import dialect
from companion.vehicle.resume import CHECK_S
from companion.vehicle.voyage_record import FILE

pytestmark = pytest.mark.slow


def cut(rig: Rig) -> Rig:
    """No power for a moment: the motors stop, memory is gone, what is stored is not."""
    rig.world._motors.stop()
    rig.reboot()
    return rig


def in_mid_leg(config: dict[str, object] | None = None) -> Rig:
    rig = Rig(config=config).sail(waypoint(30.0, 0.0), waypoint(30.0, 60.0), waypoint(0.0, 60.0))
    rig.until(lambda: rig.boat.vehicle.progress.current_seq == 2, 60.0)
    rig.run(14.0)
    return rig


def test_the_boat_says_where_it_was_and_goes_on_from_there_when_told() -> None:
    rig = cut(in_mid_leg())
    rig.ready()
    assert any(
        text.startswith("Power lost at item 2, ") and text.endswith("arm and MISSION_START to resume")
        for text in rig.peer.texts
    )
    rig.run(60.0)
    assert (rig.world._motors.left, rig.world._motors.right) == (0.0, 0.0)
    assert rig.arm() == OK
    assert rig.ask(dialect.MAV_CMD_MISSION_START) == OK
    reached = []
    for _ in range(600):
        rig.run(0.1)
        line = rig.boat.vehicle.progress.leg_line()
        if rig.boat.vehicle.progress.current_seq == 2 and line is not None:
            frame = rig.boat.vehicle.frame
            assert frame is not None
            start = rig.scenario.frame.to_local(frame.to_global(line.start))
            assert start == pytest.approx((30.0, 0.0), abs=2.5)  # the old leg, not one from here
        reached = [message.seq for message in rig.peer.said("MISSION_ITEM_REACHED")]
        if rig.mode != "AUTO":
            break
    assert reached == [2, 3]


def test_home_is_where_it_was_not_where_the_power_went() -> None:
    rig = in_mid_leg()
    home = rig.boat.vehicle.home
    assert cut(rig).boat.vehicle.home == home
    rig.ready()
    rig.arm()
    assert rig.boat.vehicle.home == home


def test_a_boat_that_may_goes_on_by_itself_after_a_warning() -> None:
    rig = cut(in_mid_leg({"failsafe.resume": 2}))
    rig.until(lambda: any("Resuming in 10 s" in text for text in rig.peer.texts), 30.0)
    rig.run(9.0)
    assert not rig.boat.vehicle.armed
    rig.run(2.0)
    assert (rig.mode, rig.boat.vehicle.armed) == ("AUTO", True)
    rig.until(lambda: rig.boat.vehicle.progress.current_seq == 3, 60.0)


def outside(resume: int) -> Rig:
    """Cut in mid-leg; without power the water carries the boat over the fence beside its leg."""
    rig = Rig(
        "open",
        "environment.current_m_s=0.5",
        "environment.current_to_deg=0.0",
        config={"failsafe.resume": resume},
    )
    rig.ready()
    fenced(rig, *polygon(box(35.0, -10.0, 70.0, 70.0), EXCLUDED))
    rig.sail(waypoint(30.0, 0.0), waypoint(30.0, 60.0), waypoint(0.0, 60.0))
    rig.until(lambda: rig.boat.vehicle.progress.current_seq == 2, 60.0)
    rig.run(10.0)
    rig.world._motors.stop()
    while margin_m(rig) > -3.0:
        rig.world.step(TICK_S)
    rig.reboot()
    return rig


def test_a_boat_whose_power_is_back_outside_the_fence_comes_inside_and_sails_on() -> None:
    rig = outside(2)
    rig.until(lambda: rig.boat.vehicle.armed, 40.0)
    rig.step()
    assert rig.mode == "LOITER"
    assert "Outside the fence: returning inside first" in rig.peer.texts
    rig.until(lambda: rig.mode == "AUTO", 40.0)
    assert margin_m(rig) > 1.5
    assert rig.boat.vehicle.progress.current_seq == 2


def test_who_objects_while_it_comes_inside_keeps_it_there() -> None:
    rig = outside(2)
    rig.until(lambda: rig.boat.vehicle.armed, 40.0)
    assert rig.set_mode(Mode.LOITER) == OK
    rig.run(40.0)
    assert rig.mode == "LOITER"
    assert margin_m(rig) > 0.0


def test_outside_the_fence_an_operator_is_told_which_modes_bring_the_boat_back() -> None:
    rig = outside(1)
    rig.run(10.0)
    assert rig.set_mode(Mode.HOLD) == OK
    assert rig.arm() != OK
    assert "Arm: Fence: the boat is outside; armed in LOITER or RTL it comes back" in rig.peer.texts
    assert rig.set_mode(Mode.RTL) == OK
    assert rig.arm() == OK
    rig.until(lambda: margin_m(rig) > 1.0, 40.0)


@pytest.mark.parametrize("objection", ["mode", "disarm"])
def test_whoever_objects_in_time_keeps_the_boat_where_it_is(objection: str) -> None:
    rig = cut(in_mid_leg({"failsafe.resume": 2}))
    rig.until(lambda: any("Resuming in" in text for text in rig.peer.texts), 30.0)
    rig.run(5.0)
    if objection == "mode":
        assert rig.set_mode(Mode.HOLD) == OK
    else:
        assert rig.ask(dialect.MAV_CMD_COMPONENT_ARM_DISARM, 0.0) == OK
    rig.run(60.0)
    assert not rig.boat.vehicle.armed


def test_a_boat_that_is_to_forget_begins_at_the_first_item() -> None:
    rig = cut(in_mid_leg({"failsafe.resume": 0}))
    rig.ready()
    assert rig.boat.vehicle.progress.current_seq == 1
    assert not any("Power lost" in text for text in rig.peer.texts)


def test_a_boat_that_was_disarmed_or_done_has_nothing_to_take_up() -> None:
    rig = in_mid_leg()
    rig.ask(dialect.MAV_CMD_COMPONENT_ARM_DISARM, 0.0)
    rig.run(CHECK_S + TICK_S)
    assert cut(rig).boat.vehicle.progress.current_seq == 1


def test_another_mission_is_not_taken_up_in_the_middle() -> None:
    rig = in_mid_leg()
    record = rig.storage.load(FILE)
    assert rig.upload([waypoint(0.0, 0.0), waypoint(5.0, 5.0), waypoint(9.0, 9.0), waypoint(1.0, 1.0)])
    rig.storage.save(FILE, record)
    assert cut(rig).boat.vehicle.progress.current_seq == 1


def test_the_record_is_written_seldom() -> None:
    class Counting(MemoryStorage):
        saves = 0

        def save(self, name: str, content: bytes) -> Saving:
            """Count those of the record."""
            self.saves += name == FILE
            return super().save(name, content)

    storage = Counting()
    rig = Rig(storage=storage).sail(waypoint(400.0, 0.0))
    before = storage.saves
    rig.run(100.0)
    assert 9 <= storage.saves - before <= 11


def test_a_full_medium_is_told_and_the_boat_sails_on() -> None:
    class Full(MemoryStorage):
        error_text = ""

        def save(self, name: str, content: bytes) -> Saving:
            """Refuse the record, once full."""
            return Refused(self.error_text) if self.error_text else super().save(name, content)

    class Refused:
        def __init__(self, text: str) -> None:
            self._text = text

        def is_done(self) -> bool:
            """At once."""
            return True

        def error(self) -> str:
            """Why."""
            return self._text

    storage = Full()
    rig = Rig(storage=storage).sail(waypoint(400.0, 0.0))
    storage.error_text = "No space left on device"
    rig.until(
        lambda: "Failsafe: Storage failed: No space left on device" in rig.peer.texts,
        30.0,
    )
    storage.error_text = ""
    rig.until(lambda: "Failsafe over: storage works again" in rig.peer.texts, 40.0)
    assert rig.mode == "AUTO"


@given(
    st.binary(max_size=80)
    | st.dictionaries(st.text(max_size=8), st.integers()).map(json.dumps).map(str.encode)
)
def test_the_boat_starts_with_any_content_in_the_voyage_record(content: bytes) -> None:
    storage = MemoryStorage()
    storage.content[FILE] = content
    rig = Rig(storage=storage)
    rig.step(2)
    assert not rig.boat.vehicle.armed
