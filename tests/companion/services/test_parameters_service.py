import math

import pytest
from boat_rig import BOAT, Rig

from companion.config.boat_config import BoatConfig
from companion.mavlink.dialect import Message, dialect


def read(rig: Rig, name: str = "", index: int = -1) -> list[Message]:
    rig.peer.forget()
    rig.peer.send(dialect.MAVLink_param_request_read_message(*BOAT, name.encode(), index))
    rig.receive()
    return rig.peer.said("PARAM_VALUE")


def write(rig: Rig, name: str, value: float) -> Message:
    message = dialect.MAVLink_param_set_message(*BOAT, name.encode(), value, dialect.MAV_PARAM_TYPE_REAL32)
    return rig.answer_to(message, "PARAM_VALUE")


@pytest.fixture
def rig() -> Rig:
    """A boat that has just been switched on."""
    rig = Rig()
    rig.step()
    return rig


@pytest.mark.parametrize("component", [0, 1])
def test_the_list_is_complete_with_its_true_count_and_comes_before_the_next_tick(
    rig: Rig, component: int
) -> None:
    rig.peer.forget()
    rig.peer.send(dialect.MAVLink_param_request_list_message(1, component))
    rig.receive()
    values = rig.peer.said("PARAM_VALUE")
    assert [value.param_index for value in values] == list(range(len(rig.boat.parameters.rows)))
    assert {value.param_count for value in values} == {len(rig.boat.parameters.rows)}
    assert [value.param_id for value in values] == [row.name for row in rig.boat.parameters.rows]
    assert [value.param_type for value in values] == [row.kind for row in rig.boat.parameters.rows]


def test_a_slow_line_gets_the_list_as_fast_as_it_carries_it(rig: Rig) -> None:
    left_bytes = 0
    rig.boat.endpoint.outbox.room = lambda _: left_bytes
    rig.peer.forget()
    rig.peer.send(dialect.MAVLink_param_request_list_message(1, 1))
    rig.run(1.0)
    assert not rig.peer.said("PARAM_VALUE")
    left_bytes = 1
    rig.step(10)
    assert len(rig.peer.said("PARAM_VALUE")) == 10


def test_one_is_read_by_name_or_by_index(rig: Rig) -> None:
    (by_name,) = read(rig, "HDG_KP")
    assert by_name.param_value == BoatConfig().heading.kp
    (by_index,) = read(rig, index=by_name.param_index)
    assert by_index.param_id == "HDG_KP"


def test_a_change_is_told_to_every_station_and_takes_hold_at_once(rig: Rig) -> None:
    other = rig.connect()
    rig.step()
    assert write(rig, "HDG_KP", 3.5).param_value == 3.5
    assert [value.param_value for value in other.said("PARAM_VALUE")] == [3.5]
    assert rig.boat.vehicle.config.heading.kp == 3.5


@pytest.mark.parametrize("value", [99.0, -1.0, math.nan, math.inf])
def test_a_refused_change_is_answered_with_the_value_that_stays_and_the_reason(
    rig: Rig, value: float
) -> None:
    assert write(rig, "HDG_KP", value).param_value == BoatConfig().heading.kp
    assert any("HDG_KP" in text for text in rig.peer.texts)


def test_other_names_of_a_setting_are_told_with_it() -> None:
    rig = Rig()
    rig.step()
    rig.peer.forget()
    rig.peer.send(dialect.MAVLink_param_set_message(*BOAT, b"RC7_OPTION", 153.0, 4))
    rig.receive()
    told = {one.param_id.rstrip("\0"): one.param_value for one in rig.peer.said("PARAM_VALUE")}
    assert told["RC7_OPTION"] == 153.0
    assert told["RC_ARM_CH"] == 7.0
    assert told["RC9_OPTION"] == 0.0


def test_a_flood_of_changes_is_done_over_many_ticks_in_its_order(
    rig: Rig, monkeypatch: pytest.MonkeyPatch
) -> None:
    changed: list[float] = []
    parameters = rig.boat.parameters
    do = parameters.set

    def noted(name: str, value: float) -> str:
        changed.append(value)
        return do(name, value)

    monkeypatch.setattr(parameters, "set", noted)
    for number in range(400):
        rig.peer.send(dialect.MAVLink_param_set_message(*BOAT, b"HDG_KP", 1.0 + number / 1000.0, 9))
    rig.receive()
    before = len(changed)
    assert 1 <= before <= 5
    for _ in range(10):
        rig.step()
    assert before + 30 <= len(changed) <= before + 60, "some a tick"
    for _ in range(100):
        rig.step()
    assert changed == sorted(changed)
    assert len(changed) < 400, "more than a file of them is dropped"
    assert write(rig, "HDG_KP", 3.5).param_value == 3.5
