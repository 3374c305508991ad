"""GUIDED by set-points, CIRCLE, FOLLOW and SMART_RTL, on ground truth."""

import math

import pytest
from boat_rig import BOAT, OK, Peer, Rig

from companion.core.geo import Point
from companion.core.units import deg_to_e7, wrap_pi
from companion.mavlink.address import Address
from companion.mavlink.dialect import dialect

CURRENT = ("environment.current_m_s=0.5", "environment.current_to_deg=90.0")
FOLLOW, CIRCLE, SMART_RTL, GUIDED, LOITER = 6, 9, 12, 15, 5
POSITION, VELOCITY, YAW, YAW_RATE = 0b110111111000, 0b110111000111, 0b100111111111, 0b010111111111


def armed(mode: int, *settings: str, **config: object) -> Rig:
    rig = Rig("open", *settings, config={k.replace("__", "."): v for k, v in config.items()}).ready()
    assert rig.set_mode(mode) == OK
    assert rig.arm() == OK
    return rig


def aim(rig: Rig, mask: int, frame: int = 1, *, x: float = 0, y: float = 0, vx: float = 0, vy: float = 0,
        yaw: float = 0, rate: float = 0) -> None:  # fmt: skip
    rig.peer.send(
        dialect.MAVLink_set_position_target_local_ned_message(
            0, *BOAT, frame, mask, x, y, 0, vx, vy, 0, 0, 0, 0, yaw, rate
        )
    )


def keep_aiming(rig: Rig, seconds: float, mask: int, frame: int = 1, **values: float) -> None:
    for _ in range(round(seconds / 0.5)):
        aim(rig, mask, frame, **values)
        rig.run(0.5)


@pytest.mark.parametrize("setting", [(), CURRENT], ids=["calm", "current"])
def test_a_velocity_is_made_good_over_ground_whatever_the_water_does(setting: tuple[str, ...]) -> None:
    rig = armed(GUIDED, *setting)
    keep_aiming(rig, 30.0, VELOCITY, vx=1.2, vy=-0.9)
    before, t = rig.world.truth, rig.now_s
    keep_aiming(rig, 20.0, VELOCITY, vx=1.2, vy=-0.9)
    north_m_s = (rig.world.truth.north_m - before.north_m) / (rig.now_s - t)
    east_m_s = (rig.world.truth.east_m - before.east_m) / (rig.now_s - t)
    assert math.hypot(north_m_s, east_m_s) == pytest.approx(1.5, abs=0.2)
    assert wrap_pi(math.atan2(east_m_s, north_m_s) - math.atan2(-0.9, 1.2)) == pytest.approx(0.0, abs=0.08)


def test_a_velocity_that_is_not_repeated_ends_in_station_keeping_with_a_notice() -> None:
    rig = armed(GUIDED, *CURRENT)
    keep_aiming(rig, 10.0, VELOCITY, vx=1.5)
    rig.until(lambda: any("set-point is stale" in text for text in rig.peer.texts), 4.0)
    north_m, east_m = rig.world.truth.north_m, rig.world.truth.east_m
    rig.run(40.0)
    assert rig.mode == "GUIDED"
    assert rig.offset_m(north_m, east_m) < 5.0


def test_a_heading_is_turned_to_on_the_spot_and_a_rate_is_kept() -> None:
    rig = armed(GUIDED)
    keep_aiming(rig, 12.0, YAW, yaw=2.0)
    assert wrap_pi(rig.world.truth.heading_rad - 2.0) == pytest.approx(0.0, abs=0.1)
    keep_aiming(rig, 6.0, YAW_RATE, rate=-0.3)
    assert rig.world.truth.yaw_rate_rad_s == pytest.approx(-0.3, abs=0.08)


def test_an_offset_from_the_bow_is_sailed_to() -> None:
    rig = armed(GUIDED)
    truth = rig.world.truth
    c, s = math.cos(truth.heading_rad), math.sin(truth.heading_rad)
    aim(rig, POSITION, dialect.MAV_FRAME_BODY_OFFSET_NED, x=20.0, y=10.0)
    rig.until(lambda: any("GUIDED: arrived" in text for text in rig.peer.texts), 60.0)
    assert rig.offset_m(truth.north_m + 20 * c - 10 * s, truth.east_m + 20 * s + 10 * c) < 3.5


def test_an_attitude_sets_heading_and_a_share_of_the_top_speed() -> None:
    rig = armed(GUIDED)
    q = [math.cos(-0.5), 0.0, 0.0, math.sin(-0.5)]
    for _ in range(30):
        rig.peer.send(dialect.MAVLink_set_attitude_target_message(0, *BOAT, 0b00000111, q, 0, 0, 0, 0.3))
        rig.run(0.5)
    assert wrap_pi(rig.world.truth.heading_rad + 1.0) == pytest.approx(0.0, abs=0.1)
    assert rig.world.truth.surge_m_s == pytest.approx(1.0, abs=0.15)


@pytest.mark.parametrize(
    ("setting", "direction"), [((), 0), (CURRENT, 1)], ids=["clockwise", "counter in a current"]
)
def test_circle_goes_round_a_point_ahead_at_its_radius(setting: tuple[str, ...], direction: int) -> None:
    rig = armed(CIRCLE, *setting, modes__circle_direction=direction, modes__circle_speed_m_s=1.2)
    truth = rig.world.truth
    centre = Point(
        truth.north_m + 10 * math.cos(truth.heading_rad), truth.east_m + 10 * math.sin(truth.heading_rad)
    )
    rig.run(60.0)
    off, swept, last = (
        [],
        0.0,
        math.atan2(rig.world.truth.east_m - centre.east_m, rig.world.truth.north_m - centre.north_m),
    )
    for _ in range(80):
        rig.run(1.0)
        north, east = rig.world.truth.north_m - centre.north_m, rig.world.truth.east_m - centre.east_m
        off.append(abs(math.hypot(north, east) - 10.0))
        swept += wrap_pi(math.atan2(east, north) - last)
        last = math.atan2(east, north)
    assert sum(off) / len(off) < 0.7
    assert max(off) < 2.0
    assert (1 - 2 * direction) * swept > 1.2 * 80 / 10 * 0.8


def tell_where(lead: Peer, rig: Rig, at: Point, north_m_s: float, east_m_s: float) -> None:
    place = rig.scenario.frame.to_global(at)
    heading = round(math.degrees(math.atan2(east_m_s, north_m_s)) * 100) % 36000
    lead.send(
        dialect.MAVLink_global_position_int_message(
            0, deg_to_e7(place.lat_deg), deg_to_e7(place.lon_deg), 0, 0,
            round(north_m_s * 100), round(east_m_s * 100), 0, heading,
        )
    )  # fmt: skip


def test_follow_keeps_its_place_astern_and_stays_when_the_lead_falls_silent() -> None:
    rig = Rig().ready()
    lead = rig.connect(Address(2, 1))
    assert rig.set_mode(FOLLOW) != OK
    assert "FOLLOW: no vehicle is heard" in rig.peer.texts
    begin_s = rig.now_s
    at = Point(10.0, 0.0)

    def sail(seconds: float) -> None:
        nonlocal at
        for _ in range(round(seconds / 0.2)):
            turned = rig.now_s - begin_s > 60.0
            north, east = (0.0, 1.2) if turned else (1.2, 0.0)
            at = Point(at.north_m + north * 0.2, at.east_m + east * 0.2)
            tell_where(lead, rig, at, north, east)
            rig.run(0.2)

    sail(0.4)
    assert rig.set_mode(FOLLOW) == OK
    assert rig.arm() == OK
    sail(50.0)
    assert rig.offset_m(at.north_m - 10.0, at.east_m) < 1.5
    sail(60.0)
    assert rig.offset_m(at.north_m, at.east_m - 10.0) < 2.0
    rig.until(lambda: any("FOLLOW: no vehicle is heard, keeping" in text for text in rig.peer.texts), 5.0)
    here = rig.world.truth
    rig.run(20.0)
    assert rig.offset_m(here.north_m, here.east_m) < 5.0


def test_smart_rtl_sails_back_the_way_it_came() -> None:
    rig = armed(GUIDED)
    home = rig.world.truth
    for north_m, east_m in ((40.0, 0.0), (40.0, 40.0), (0.0, 40.0)):
        place = rig.scenario.frame.to_global(Point(north_m, east_m))
        rig.peer.forget()
        rig.peer.command_int(192, -1, 1, 0, math.nan, x=deg_to_e7(place.lat_deg), y=deg_to_e7(place.lon_deg))
        rig.until(lambda: any("GUIDED: arrived" in text for text in rig.peer.texts), 60.0)
    assert len(rig.boat.vehicle.track.points) < 15
    assert rig.set_mode(SMART_RTL) == OK
    furthest_m = 0.0
    corners = [False, False]
    while not any("SMART_RTL: arrived" in text for text in rig.peer.texts):
        rig.run(0.5)
        truth = rig.world.truth
        track = min(abs(truth.east_m), abs(truth.north_m - 40.0), abs(truth.east_m - 40.0))
        furthest_m = max(furthest_m, track)
        corners = [corners[0] or rig.offset_m(40.0, 40.0) < 4, corners[1] or rig.offset_m(40.0, 0.0) < 4]
        assert rig.now_s < 300.0
    assert corners == [True, True]
    assert furthest_m < 5.0  # comparing its motors carries the boat off the way
    assert rig.offset_m(home.north_m, home.east_m) < 3.0
    rig.run(20.0)
    assert rig.offset_m(home.north_m, home.east_m) < 3.0


def test_smart_rtl_that_has_no_track_says_why() -> None:
    rig = Rig().ready()
    assert rig.set_mode(SMART_RTL) != OK
    assert "SMART_RTL: no track, the boat was not armed" in rig.peer.texts
