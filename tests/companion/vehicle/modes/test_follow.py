import math

import pytest
from boat_rig import BOAT, Peer, Rig, nav_at, place
from hypothesis import given
from hypothesis import strategies as st
from mode_inputs import mode_inputs

from companion.config.boat_config import BoatConfig, Follow
from companion.core.intent import HoldCourse, KeepStation
from companion.core.requests import OtherVehicle
from companion.mavlink.address import Address
from companion.mavlink.dialect import dialect
from companion.vehicle.modes.follow import FollowMode

CONFIG = BoatConfig()
BESIDE = BoatConfig(follow=Follow(offset_x_m=0.0, offset_y_m=0.0))  # in the place of the lead itself


def seen(
    north_m: float, east_m: float, north_m_s: float = 0.0, east_m_s: float = 0.0, system: int = 2
) -> OtherVehicle:
    return OtherVehicle(system, place(north_m, east_m), north_m_s, east_m_s, math.atan2(east_m_s, north_m_s))


def following(sighting: OtherVehicle, now_s: float = 0.0) -> FollowMode:
    one = FollowMode([])
    assert one.ingest(sighting, CONFIG.follow, now_s)
    return one


def test_the_first_that_is_heard_is_followed_until_it_falls_silent() -> None:
    one = following(seen(0, 0))
    assert not one.ingest(seen(5, 5, system=3), CONFIG.follow, 1.0)
    assert one.ingest(seen(5, 5, system=3), CONFIG.follow, 10.0)


def test_a_chosen_one_is_the_only_one() -> None:
    one, chosen = FollowMode([]), Follow(system_id=7)
    config = BoatConfig(follow=chosen)
    assert not one.ingest(seen(0, 0), chosen, 0.0)
    assert one.fault(mode_inputs(config=config)) == "system 7 is not heard"
    assert one.ingest(seen(0, 0, system=7), chosen, 0.0)
    assert one.fault(mode_inputs(config=config)) == ""
    assert one.fault(mode_inputs(now_s=3.1, config=config)) == "system 7 is not heard"


def test_one_that_is_too_far_away_is_not_followed() -> None:
    one = following(seen(150, 0))
    assert one.fault(mode_inputs()) == "system 2 is 150 m away (FOLL_DIST_MAX 100)"
    assert one.fault(mode_inputs(config=BoatConfig(follow=Follow(max_distance_m=0.0)))) == ""


@pytest.mark.parametrize(
    ("offset_type", "north_m", "east_m"), [(0, 40.0, 20.0), (1, 50.0, 10.0)], ids=["compass", "bow"]
)
def test_the_offset_is_seen_from_north_or_from_the_leads_bow(
    offset_type: int, north_m: float, east_m: float
) -> None:
    config = BoatConfig(follow=Follow(offset_type=offset_type, offset_x_m=-10.0))
    intent = following(OtherVehicle(2, place(50.0, 20.0), 0.0, 0.1, math.pi / 2)).intent(
        mode_inputs(config=config)
    )
    assert isinstance(intent, KeepStation)  # a lead that lies still
    assert intent.point == pytest.approx((north_m, east_m), abs=0.01)


speeds, places = st.floats(-3.0, 3.0), st.floats(-80.0, 80.0)


@given(places, places, speeds, speeds, st.floats(0.0, 3.0))
def test_it_is_never_faster_than_it_may_be(
    north_m: float, east_m: float, north_m_s: float, east_m_s: float, now_s: float
) -> None:
    one = following(seen(north_m, east_m, north_m_s, east_m_s))
    intent = one.intent(mode_inputs(now_s=now_s, speed_m_s=1.5))
    if isinstance(intent, HoldCourse):
        assert 0.0 <= intent.speed_m_s <= 1.5
        assert -math.pi <= intent.course_rad <= math.pi


def tell(peer: Peer, lat: int = 500_000_000, lon: int = -12_000_000, hdg: int = 0xFFFF) -> None:
    peer.send(dialect.MAVLink_global_position_int_message(0, lat, lon, 0, 0, 0, 120, 0, hdg))


@pytest.mark.parametrize(
    ("sender", "is_lead"),
    [(Address(2, 1), True), (Address(255, 190), True), (Address(2, 154), False), (BOAT, False)],
)
def test_vehicles_and_stations_can_be_followed_but_not_their_parts(sender: Address, is_lead: bool) -> None:
    rig = Rig().ready()
    peer = rig.connect(sender)
    rig.receive()
    tell(peer)
    rig.receive()
    lead = rig.boat.vehicle.modes.follow.lead
    assert (lead is not None) is is_lead
    if lead is not None:
        assert lead.heading_rad == pytest.approx(math.pi / 2)  # the course, for want of a heading


def test_a_follow_target_brings_velocity_and_attitude_as_far_as_it_knows_them() -> None:
    rig = Rig().ready()
    for known, heading, speed in ((0b1011, 1.0, 1.5), (0b0011, 0.0, 1.5), (0b0001, 0.0, 0.0)):
        q = [math.cos(0.5), 0.0, 0.0, math.sin(0.5)]
        rig.peer.send(
            dialect.MAVLink_follow_target_message(
                0, known, 500_000_000, -12_000_000, 0.0, [1.5, 0, 0], [0, 0, 0], q, [0, 0, 0], [0, 0, 0], 0
            )
        )
        rig.receive()
        lead = rig.boat.vehicle.modes.follow.lead
        assert lead is not None
        assert (lead.heading_rad, lead.north_m_s) == pytest.approx((heading, speed))


def test_the_leads_position_is_extrapolated_for_a_second_at_most() -> None:
    slow = OtherVehicle(2, place(20.0, 0.0), 0.0, 0.1, 0.0)
    one = following(slow, now_s=100.0)
    for late_s, east_m in ((0.0, 0.0), (0.5, 0.05), (2.0, 0.1)):
        intent = one.intent(mode_inputs(now_s=100.0 + late_s, config=BESIDE))
        assert isinstance(intent, KeepStation)
        assert intent.point == pytest.approx((20.0, east_m), abs=1e-3)


def test_the_course_adds_what_closes_the_gap_to_the_leads_velocity() -> None:
    gain = CONFIG.follow.gain_per_s
    one = following(seen(0.0, 0.0, 0.8, 0.6))
    intent = one.intent(mode_inputs(nav_at(-1.0, 0.5), speed_m_s=9.0, config=BESIDE))
    assert isinstance(intent, HoldCourse)
    north, east = 0.8 + gain, 0.6 - 0.5 * gain
    assert intent.course_rad == pytest.approx(math.atan2(east, north), abs=1e-3)
    assert intent.speed_m_s == pytest.approx(math.hypot(north, east), abs=1e-3)


def test_a_boat_ahead_of_its_place_keeps_the_leads_course_and_waits() -> None:
    gain, onward = CONFIG.follow.gain_per_s, math.atan2(0.6, 0.8)
    one = following(seen(0.0, 0.0, 0.8, 0.6))
    far = one.intent(mode_inputs(nav_at(8.0, 6.0), config=BESIDE))  # ten metres ahead
    assert isinstance(far, HoldCourse)
    assert (far.course_rad, far.speed_m_s) == pytest.approx((onward, 0.0))
    ahead_m = 0.8 / gain  # leaves 0.2 m/s, less than steerage way
    near = one.intent(mode_inputs(nav_at(0.8 * ahead_m, 0.6 * ahead_m), config=BESIDE))
    assert isinstance(near, HoldCourse)
    assert (near.course_rad, near.speed_m_s) == pytest.approx((onward, 0.2), abs=1e-3)


def test_a_slow_lead_is_followed_from_half_the_least_speed_on() -> None:
    least_m_s = CONFIG.guidance.min_speed_m_s
    crawling = following(seen(0.0, 0.0, 0.45 * least_m_s)).intent(mode_inputs())
    assert isinstance(crawling, KeepStation)
    assert isinstance(following(seen(0.0, 0.0, 0.55 * least_m_s)).intent(mode_inputs()), HoldCourse)
