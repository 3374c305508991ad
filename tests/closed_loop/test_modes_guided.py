"""GUIDED by set-points, CIRCLE, FOLLOW and SMART_RTL, on ground truth."""

import math

import pytest
from boat_rig import BOAT, OK, Peer, Rig
from sailing_rig import (
    CURRENT,
    VELOCITY,
    YAW,
    YAW_RATE,
    armed,
    drifted_m,
    keep_aiming,
    told,
)

from companion.core.geo import Point
from companion.core.modes import Mode
from companion.core.units import deg_to_e7, wrap_pi
from companion.mavlink.address import Address
from companion.mavlink.dialect import dialect


def test_a_velocity_is_made_good_in_a_current_and_not_repeated_ends_in_station_keeping() -> None:
    rig = armed(Mode.GUIDED, *CURRENT)
    keep_aiming(rig, 20.0, VELOCITY, velocity=(1.2, -0.9))
    before, t = rig.world.truth, rig.now_s
    keep_aiming(rig, 10.0, VELOCITY, velocity=(1.2, -0.9))
    north_m_s = (rig.world.truth.north_m - before.north_m) / (rig.now_s - t)
    east_m_s = (rig.world.truth.east_m - before.east_m) / (rig.now_s - t)
    assert math.hypot(north_m_s, east_m_s) == pytest.approx(1.5, abs=0.2)
    assert wrap_pi(math.atan2(east_m_s, north_m_s) - math.atan2(-0.9, 1.2)) == pytest.approx(0.0, abs=0.08)
    told(rig, "GUIDED: set-point is stale", 4.0)
    assert drifted_m(rig, 30.0) < 5.0
    assert rig.mode == "GUIDED"


def test_headings_rates_and_attitudes_are_kept() -> None:
    rig = armed(Mode.GUIDED)
    keep_aiming(rig, 10.0, YAW, yaw=2.0)
    assert wrap_pi(rig.world.truth.heading_rad - 2.0) == pytest.approx(0.0, abs=0.1)
    keep_aiming(rig, 5.0, YAW_RATE, rate=-0.3)
    assert rig.world.truth.yaw_rate_rad_s == pytest.approx(-0.3, abs=0.08)
    q = [math.cos(-0.5), 0.0, 0.0, math.sin(-0.5)]
    for _ in range(30):
        rig.peer.send(dialect.MAVLink_set_attitude_target_message(0, *BOAT, 0b00000111, q, 0, 0, 0, 0.3))
        rig.run(0.5)
    assert wrap_pi(rig.world.truth.heading_rad + 1.0) == pytest.approx(0.0, abs=0.1)
    assert rig.world.truth.surge_m_s == pytest.approx(1.0, abs=0.15)


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
    assert rig.set_mode(Mode.FOLLOW) != OK
    assert "FOLLOW: no vehicle is heard" in rig.peer.texts
    begin_s = rig.now_s
    at = Point(10.0, 0.0)

    def sail(seconds: float) -> None:
        nonlocal at
        for _ in range(round(seconds / 0.2)):
            turned = rig.now_s - begin_s > 45.0
            north, east = (0.0, 1.2) if turned else (1.2, 0.0)
            at = Point(at.north_m + north * 0.2, at.east_m + east * 0.2)
            tell_where(lead, rig, at, north, east)
            rig.run(0.2)

    sail(0.4)
    assert rig.set_mode(Mode.FOLLOW) == OK
    assert rig.arm() == OK
    sail(40.0)
    assert rig.offset_m(at.north_m - 10.0, at.east_m) < 1.5
    sail(45.0)
    assert rig.offset_m(at.north_m, at.east_m - 10.0) < 2.0
    told(rig, "FOLLOW: no vehicle is heard, keeping", 5.0)
    assert drifted_m(rig, 15.0) < 5.0
