"""Switched on at home and carried to the water: positions begin anew there, and only while disarmed."""

from boat_rig import OK, Rig

from companion.core.geo import LatLon, LocalFrame
from companion.core.requests import SetHome

HOME, LAKE = LatLon(50.0, -1.2), LatLon(51.2, -1.2)  # 133 km
LOITER = 5


def carried(rig: Rig) -> None:
    """The receiver is at the lake."""
    gnss = rig.world.electronics._gnss
    gnss._frame = LocalFrame(LAKE)


def far_from_lake_m(place: LatLon | None) -> float:
    assert place is not None
    here = LocalFrame(LAKE).to_local(place)
    return float(abs(complex(here.north_m, here.east_m)))


def test_a_disarmed_boat_that_was_carried_far_knows_where_it_is_and_arms() -> None:
    rig = Rig().ready()
    rig.peer.heartbeat()
    carried(rig)
    rig.run(5.0)
    nav, frame, vehicle = rig.boat.nav, rig.boat.estimator.frame, rig.boat.vehicle
    assert nav is not None
    assert frame is not None
    assert nav.position_age_s < 0.5
    assert far_from_lake_m(frame.to_global(nav.point)) < 5.0
    assert far_from_lake_m(vehicle.home) < 5.0
    assert any("133 km away, origin moved" in text for text in rig.peer.texts)
    assert rig.set_mode(LOITER) == OK
    assert rig.arm() == OK
    assert far_from_lake_m(vehicle.home) < 5.0


def test_a_home_that_somebody_chose_stays_and_so_does_all_after_a_moments_wrong_fixes() -> None:
    rig = Rig().ready()
    frame, gnss = rig.boat.estimator.frame, rig.world.electronics._gnss
    there, gnss._frame = gnss._frame, LocalFrame(LAKE)
    rig.run(2.0)
    gnss._frame = there
    rig.run(3.0)
    assert rig.boat.estimator.frame is frame
    assert rig.boat.vehicle.request(SetHome(HOME)).accepted
    carried(rig)
    rig.run(5.0)
    assert rig.boat.estimator.frame is not frame
    assert rig.boat.vehicle.home == HOME


def test_an_armed_boat_keeps_its_frame_says_so_once_and_begins_anew_when_disarmed() -> None:
    rig = Rig().ready()
    assert rig.set_mode(LOITER) == OK
    assert rig.arm() == OK
    frame = rig.boat.estimator.frame
    carried(rig)
    rig.run(6.0)
    assert rig.boat.estimator.frame is frame
    assert [text for text in rig.peer.texts if "not used until disarmed" in text] == [
        "GPS: 133 km from where the boat was, not used until disarmed"
    ]
    rig.boat.vehicle.disarm("test")
    rig.run(5.0)
    assert rig.boat.estimator.frame is not None
    assert far_from_lake_m(rig.boat.estimator.frame.origin) < 5.0
