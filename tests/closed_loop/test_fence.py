"""The fence on ground truth: the boat stops before it, comes back from beyond it."""

import math

import pytest
from boat_rig import OK, Rig
from fence_rig import box, fenced, least_margin_m, polygon

from companion.mavlink.dialect import Message, dialect

ONTO_IT = ("environment.current_m_s=0.5", "environment.current_to_deg=0.0")
CALM: tuple[str, ...] = ()


def armed(rig: Rig, mode: int) -> Rig:
    rig.ready()
    assert rig.set_mode(mode) == OK
    assert rig.arm() == OK
    return rig


def velocity(rig: Rig, north_m_s: float, east_m_s: float) -> None:
    """SET_POSITION_TARGET_LOCAL_NED with a velocity alone."""
    rig.peer.send(
        dialect.MAVLink_set_position_target_local_ned_message(
            0, 1, 1, 1, 0b110111000111, 0, 0, 0, north_m_s, east_m_s, 0, 0, 0, 0, 0, 0
        )
    )


def sticks(steering: int, throttle: int) -> Message:
    message: Message = dialect.MAVLink_manual_control_message(1, 0, steering, throttle, 0, 0)
    return message


@pytest.mark.parametrize("water", [CALM, ONTO_IT], ids=["calm", "current"])
@pytest.mark.parametrize("course_deg", [0.0, 40.0])
def test_a_boat_told_to_sail_at_the_line_stops_inside(water: tuple[str, ...], course_deg: float) -> None:
    rig = fenced(Rig("open", *water), *polygon(box(-30.0, -100.0, 30.0, 100.0)))
    armed(rig, 15)
    least = math.inf
    for _ in range(30):
        course = math.radians(course_deg)
        velocity(rig, 2.0 * math.cos(course), 2.0 * math.sin(course))
        least = min(least, least_margin_m(rig, 1.0))
    assert 0.3 < least < 4.0
    assert "Fence ahead: keeping station before it" in rig.peer.texts


@pytest.mark.parametrize("water", [CALM, ONTO_IT], ids=["calm", "current"])
@pytest.mark.parametrize("throttle", [1000, -1000])
def test_full_throttle_by_hand_does_not_take_the_boat_out(water: tuple[str, ...], throttle: int) -> None:
    rig = fenced(Rig("open", *water), *polygon(box(-20.0, -100.0, 30.0, 100.0)))
    armed(rig, 0)
    least = math.inf
    for _ in range(100):
        rig.peer.send(sticks(0, throttle))
        least = min(least, least_margin_m(rig, 0.4))
    assert 0.3 < least < 4.0
