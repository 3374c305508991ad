"""Mission items: the wire's old and new form, and JSON."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from companion.mavlink.address import Address
from companion.mavlink.codec import Decoder, Encoder
from companion.mavlink.dialect import Message, dialect
from companion.mavlink.items import ItemFault, MissionItem, MissionResult, MissionType

BOAT = Address(1, 1)
INT32 = st.integers(-(2**31), 2**31 - 1)
SINGLE = st.floats(width=32)
BYTE = st.integers(0, 255)

any_item = st.builds(
    MissionItem,
    frame=BYTE,
    command=st.integers(0, 65535),
    current=BYTE,
    autocontinue=BYTE,
    param1=SINGLE,
    param2=SINGLE,
    param3=SINGLE,
    param4=SINGLE,
    x=INT32,
    y=INT32,
    z=SINGLE,
)


def old_item(frame: int, x: float, y: float) -> Message:
    message: Message = dialect.MAVLink_mission_item_message(
        1, 1, 0, frame, 16, 0, 1, 0, 0, 0, math.nan, x, y, 0
    )
    return message


@given(any_item, st.sampled_from(MissionType), st.integers(0, 65535))
def test_an_item_comes_off_the_wire_as_it_went_on(
    item: MissionItem, mission_type: MissionType, seq: int
) -> None:
    frame = Encoder(Address(255, 190)).encode(item.to_message(seq, BOAT, mission_type))
    (received,) = Decoder(datagram=True).feed(frame)
    message = received.message
    assert MissionItem.from_message(message) == item
    assert (message.seq, message.mission_type) == (seq, mission_type)
    assert (message.target_system, message.target_component) == BOAT


@given(any_item, any_item)
def test_equal_items_have_equal_hashes_and_nan_equals_nan(one: MissionItem, other: MissionItem) -> None:
    assert one == MissionItem.from_dict(one.to_dict())
    assert hash(one) == hash(MissionItem.from_dict(one.to_dict()))
    assert (one == other) == (one.to_dict() == other.to_dict())


@pytest.mark.parametrize(
    ("frame", "x", "y", "expected"),
    [
        (dialect.MAV_FRAME_GLOBAL, 50.00000004, -1.25, (500000000, -12500000)),
        (
            dialect.MAV_FRAME_GLOBAL_RELATIVE_ALT,
            59.89931869506836,
            10.703136444091797,
            (598993187, 107031364),
        ),
        (dialect.MAV_FRAME_GLOBAL_INT, -90.0, 180.0, (-900000000, 1800000000)),
        (dialect.MAV_FRAME_LOCAL_NED, 12.34567, -0.00004, (123457, 0)),
        (dialect.MAV_FRAME_BODY_FRD, 1.0, 2.0, (10000, 20000)),
        (dialect.MAV_FRAME_MISSION, 3.0, 4.0, (3, 4)),
    ],
)
def test_an_old_item_is_scaled_as_its_frame_asks(
    frame: int, x: float, y: float, expected: tuple[int, int]
) -> None:
    item = MissionItem.from_message(old_item(frame, x, y))
    assert isinstance(item, MissionItem)
    assert (item.x, item.y) == expected
    assert item.frame == frame
    assert math.isnan(item.param4)


@pytest.mark.parametrize("frame", [0, 1, 2, 3, 6, 200])
@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf, 1e30, 3e9])
def test_an_old_item_without_a_position_is_a_fault_that_names_the_coordinate(frame: int, bad: float) -> None:
    x_fault = MissionItem.from_message(old_item(frame, bad, 0.0))
    y_fault = MissionItem.from_message(old_item(frame, 0.0, bad))
    assert isinstance(x_fault, ItemFault)
    assert x_fault.result is MissionResult.INVALID_PARAM5_X
    assert "x is" in x_fault.text
    assert isinstance(y_fault, ItemFault)
    assert y_fault.result is MissionResult.INVALID_PARAM6_Y


@pytest.mark.parametrize(
    ("field", "value"), [("frame", 256), ("command", -1), ("current", 300), ("x", 2**31), ("y", -(2**31) - 1)]
)
def test_a_number_that_the_wire_cannot_hold_is_refused_by_name(field: str, value: int) -> None:
    fields: dict[str, int] = {"frame": 3, "command": 16, field: value}
    with pytest.raises(ValueError, match=field):
        MissionItem(**fields)
