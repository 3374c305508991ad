"""Messages folded into a state."""

import pytest

from companion.core.geo import LatLon
from mission_tools.vehicle.state import COMMAND_RESULTS, MISSION_REFUSALS, VehicleState

HEARTBEAT = {"autopilot": 3, "type": 11, "custom_mode": 10, "base_mode": 129}


def test_heartbeats_of_other_components_are_not_the_boats() -> None:
    state = VehicleState()
    state.handle("HEARTBEAT", 154, HEARTBEAT, now_s=7.0)
    assert state == VehicleState()
    assert (state.autopilot, state.type, state.current_item, state.mission_state, state.refused) == (0,) * 5


def test_every_refusal_of_the_protocol_has_its_words() -> None:
    assert list(MISSION_REFUSALS) == list(range(1, 16))
    assert list(COMMAND_RESULTS) == list(range(1, 7))


@pytest.mark.parametrize(
    ("autopilot", "mode", "name"), [(3, 4, "HOLD"), (3, 99, "mode 99"), (12, 4, "mode 4")]
)
def test_modes_have_rovers_names_on_ardupilot_only(autopilot: int, mode: int, name: str) -> None:
    assert VehicleState(autopilot=autopilot, custom_mode=mode).mode == name


def test_a_position_of_zero_zero_is_no_position() -> None:
    state = VehicleState()
    state.handle("GLOBAL_POSITION_INT", 1, {"time_boot_ms": 0, "lat": 0, "lon": 0, "vx": 0, "vy": 0}, 1.0)
    assert state.position is None


def test_each_message_becomes_what_it_says() -> None:
    state = VehicleState()
    state.handle("HEARTBEAT", 1, HEARTBEAT, now_s=7.0)
    assert (state.autopilot, state.type, state.custom_mode, state.armed, state.heard_s) == (
        3,
        11,
        10,
        True,
        7.0,
    )
    assert not state.says_more
    fix = {"time_boot_ms": 2500, "lat": 500000000, "lon": -12000000, "vx": 30, "vy": -40}
    state.handle("GLOBAL_POSITION_INT", 1, fix, 8.0)
    assert (state.position, state.boat_time_s, state.speed_m_s) == (LatLon(50.0, -1.2), 2.5, 0.5)
    for fields, found in (({"seq": 4, "mission_state": 3}, (4, 3)), ({"seq": 5}, (5, 0))):
        state.handle("MISSION_CURRENT", 1, fields, 8.0)
        assert (state.current_item, state.mission_state) == found
    state.handle("MISSION_REQUEST_INT", 1, {"seq": 2}, 8.0)
    state.handle("MISSION_ACK", 1, {"type": 4, "mission_type": 1}, 8.0)
    state.handle("MISSION_ACK", 1, {"type": 0}, 8.0)
    assert (state.requested_item, state.answers, state.says_more) == (2, {1: 4, 0: 0}, True)


def test_reached_items_only_count_up() -> None:
    state = VehicleState()
    for seq in (2, 3, 1):
        state.handle("MISSION_ITEM_REACHED", 1, {"seq": seq}, 1.0)
    assert state.reached_item == 3


def test_a_long_text_is_put_together_from_its_chunks() -> None:
    state = VehicleState()
    for text in ("a" * 50, "b" * 50, "end"):
        state.handle("STATUSTEXT", 1, {"severity": 3, "text": text, "id": 9}, 1.0)
    assert state.last_warning(0.0) == "a" * 50 + "b" * 50 + "end"


def test_the_last_complaint_is_a_warning_or_worse_and_not_older_than_asked() -> None:
    state = VehicleState()
    for at_s, severity, text in ((1.0, 3, "old"), (2.0, 4, "Arm: no fix"), (3.0, 6, "hello")):
        state.handle("STATUSTEXT", 1, {"severity": severity, "text": text}, at_s)
    assert state.last_warning(1.5) == "Arm: no fix"
    assert state.last_warning(2.5) == ""


def test_a_failsafe_that_fires_meanwhile_is_no_reason_for_a_refusal() -> None:
    state = VehicleState()
    for at_s, text in ((1.0, "Arm: Battery: 9.6 V is below 10.5 V"), (1.2, "Failsafe: Battery low: 9.6 V")):
        state.handle("STATUSTEXT", 1, {"severity": 3, "text": text}, at_s)
    assert state.last_warning(0.0) == "Failsafe: Battery low: 9.6 V"
    assert state.refusal(0.0) == "Arm: Battery: 9.6 V is below 10.5 V"
    assert state.refusal(1.1) == ""


def test_a_vehicle_that_gave_up_waiting_has_not_refused() -> None:
    state = VehicleState()
    for result, has_refused in ((0, False), (15, False), (13, True)):
        state.handle("MISSION_ACK", 1, {"type": result}, 1.0)
        assert state.has_refused is has_refused
