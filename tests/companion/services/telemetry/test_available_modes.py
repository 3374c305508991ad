import pytest
from boat_rig import OK, Rig

from companion.core.modes import Mode
from companion.mavlink.dialect import dialect

REQUEST, AVAILABLE = 512, 435

# Letter for letter those of QGroundControl's Rover plug-in: it starts, pauses and returns by these names
QGROUNDCONTROLS = {
    "Manual": 0,
    "Acro": 1,
    "Steering": 3,
    "Hold": 4,
    "Loiter": 5,
    "Follow": 6,
    "Simple": 7,
    "Circle": 9,
    "Auto": 10,
    "RTL": 11,
    "Smart RTL": 12,
    "Guided": 15,
}


def test_the_modes_are_asked_for_one_by_one_until_the_last() -> None:
    rig = Rig()
    rig.step()
    found, index = {}, 0
    while True:
        index += 1
        assert rig.ask(REQUEST, AVAILABLE, index) == OK
        (one,) = rig.peer.said("AVAILABLE_MODES")
        assert (one.mode_index, one.standard_mode) == (index, 0)
        found[one.mode_name.rstrip("\0")] = one.custom_mode
        if one.mode_index >= one.number_modes:
            break
    assert found == QGROUNDCONTROLS


def test_the_mode_is_told_every_two_seconds_and_when_it_changes() -> None:
    rig = Rig().ready()
    rig.peer.forget()
    rig.run(8.0)
    assert len(rig.peer.said("CURRENT_MODE")) == pytest.approx(4, abs=1)
    assert len(rig.peer.said("AVAILABLE_MODES_MONITOR")) == pytest.approx(4, abs=1)
    rig.set_mode(5)
    assert [(one.custom_mode, one.intended_custom_mode) for one in rig.peer.said("CURRENT_MODE")] == [(5, 5)]


def test_the_heartbeat_says_whose_hand_it_is() -> None:
    rig = Rig().ready()
    for mode in Mode:
        rig.boat.vehicle.mode = mode
        rig.run(0.2)
        beat = rig.peer.said("HEARTBEAT")[-1]
        assert beat.custom_mode == mode
        assert bool(beat.base_mode & dialect.MAV_MODE_FLAG_MANUAL_INPUT_ENABLED) is mode.rules.is_by_hand
        steers_itself = not mode.rules.is_by_hand and mode is not Mode.HOLD
        assert bool(beat.base_mode & dialect.MAV_MODE_FLAG_GUIDED_ENABLED) is steers_itself
