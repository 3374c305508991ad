"""Vessels with AIS: which are near, where they are by now, and how far they extend."""

import math

import pytest
from avoidance_rig import boat
from msgspec.structs import replace

from companion.config.boat_config import BoatConfig, with_value
from companion.core.geo import LatLon, LocalFrame, Point
from companion.core.readings import AisReading, AisVessel
from companion.obstacles.perception.vessels import Vessel, vessels_near

FRAME = LocalFrame(LatLon(50.0, -1.2))
CONFIG = BoatConfig()
NOW_S = 1000.0
SHIP = AisVessel(
    235_000_001, NOW_S, LatLon(50.0, -1.2), 5.0, math.radians(90.0), math.radians(90.0), error_m=10.0,
    bow_m=30, stern_m=10, port_m=2, starboard_m=6, name="SHIP",
)  # fmt: skip
YACHT = replace(SHIP, mmsi=235_000_002, is_class_b=True)


def at(report: AisVessel, north_m: float, east_m: float, age_s: float = 0.0, **changes: object) -> AisVessel:
    place = FRAME.to_global(Point(north_m, east_m))
    return replace(report, position=place, time_s=NOW_S - age_s, **changes)


def near(*reports: AisVessel, config: BoatConfig = CONFIG) -> list[Vessel]:
    return vessels_near(AisReading(NOW_S, reports), FRAME, boat(), config, NOW_S)


def only(*reports: AisVessel) -> Vessel:
    (one,) = near(*reports)
    return one


def test_a_vessel_is_where_its_course_and_speed_have_brought_the_middle_of_its_hull() -> None:
    one = only(at(SHIP, 20.0, -50.0, age_s=4.0))
    # 20 m in 4 s eastward, the middle 10 m ahead of the antenna and 2 m to starboard, south
    assert one.at == pytest.approx((18.0, -20.0), abs=0.01)
    assert (one.north_m_s, one.east_m_s) == pytest.approx((0.0, 5.0))
    assert (one.half_length_m, one.half_beam_m, one.name) == (20.0, 4.0, "SHIP")


def test_the_error_of_its_place_grows_with_its_age_and_by_five_degrees_of_its_speed() -> None:
    one = only(at(SHIP, 20.0, -50.0, age_s=4.0))
    assert one.variance_m2(0.0) == pytest.approx(
        (10.0 / 2.45) ** 2 + (4.0 * (0.0514 + 5.0 * 0.0873)) ** 2, rel=1e-3
    )
    assert one.variance_m2(6.0) == pytest.approx(
        (10.0 / 2.45) ** 2 + (10.0 * (0.0514 + 5.0 * 0.0873)) ** 2, rel=1e-3
    )
    coarse = only(at(SHIP, 20.0, -50.0, age_s=4.0, error_m=13.0))
    assert coarse.variance_m2(0.0) > one.variance_m2(0.0) + 10.0


@pytest.mark.parametrize(
    ("changes", "half_m"),
    [
        ({"bow_m": 0, "stern_m": 0, "port_m": 0, "starboard_m": 0}, (50.0, 10.0)),
        ({"bow_m": 0, "stern_m": 0, "port_m": 0, "starboard_m": 0, "is_class_b": True}, (24.0, 6.0)),
        ({"bow_m": 0, "stern_m": 15, "port_m": 0, "starboard_m": 5}, (15.0, 5.0)),
        ({"heading_rad": None}, (20.0, 4.0)),
        ({"heading_rad": None, "course_rad": None}, (30.0, 30.0)),
        ({"heading_rad": None, "speed_m_s": 0.5}, (30.0, 30.0)),
    ],
)
def test_what_is_not_known_makes_a_vessel_larger(
    changes: dict[str, object], half_m: tuple[float, float]
) -> None:
    one = only(at(SHIP, 20.0, -50.0, **changes))  # type: ignore[arg-type]
    assert (one.half_length_m, one.half_beam_m) == half_m


@pytest.mark.parametrize("changes", [{"speed_m_s": None}, {"course_rad": None, "heading_rad": None}])
def test_a_vessel_without_speed_or_course_stands(changes: dict[str, object]) -> None:
    one = only(at(SHIP, 20.0, -50.0, age_s=30.0, **changes))
    assert (one.north_m_s, one.east_m_s) == (0.0, 0.0)


@pytest.mark.parametrize(
    ("report", "changes", "life_s"),
    [
        (SHIP, {}, 60.0),
        (SHIP, {"status": 1, "speed_m_s": 0.0}, 600.0),
        (SHIP, {"status": 5, "speed_m_s": 0.0}, 600.0),
        (SHIP, {"status": 5}, 60.0),
        (YACHT, {}, 180.0),
        (YACHT, {"speed_m_s": 0.5}, 600.0),
    ],
)
def test_a_report_is_used_for_six_intervals_of_its_class(
    report: AisVessel, changes: dict[str, object], life_s: float
) -> None:
    way_m = life_s * float(changes.get("speed_m_s", 5.0))  # type: ignore[arg-type]
    assert near(at(report, 30.0, -way_m, age_s=life_s, **changes))
    assert not near(at(report, 30.0, -way_m, age_s=life_s + 0.1, **changes))


def test_only_vessels_that_the_boat_may_meet_within_a_minute_are_near() -> None:
    reach_m = 20.0 + CONFIG.avoidance.vessel_margin_m + 2.0 * 10.0 / 2.45
    reach_m += 60.0 * (5.0 + CONFIG.handling.top_speed_m_s)
    assert near(at(SHIP, 0.0, -reach_m - 9.0))
    assert not near(at(SHIP, 0.0, -reach_m - 11.0)), "10 m from the antenna to the middle"
    assert not near(at(SHIP, 0.0, 200.0)), "it goes away faster than the boat"
    assert near(at(SHIP, 0.0, 200.0, speed_m_s=0.0))
    wide = with_value(CONFIG, "avoidance.vessel_margin_m", 7.0)
    assert near(at(SHIP, 0.0, -reach_m - 11.0), config=wide)


def test_of_many_vessels_the_four_that_are_met_soonest_are_used() -> None:
    reports = [at(SHIP, 0.0, -60.0 - 20.0 * number, mmsi=number, name=str(number)) for number in range(9)]
    assert [one.name for one in near(*reversed(reports))] == ["0", "1", "2", "3"]


def test_without_a_receiver_or_a_position_of_the_boat_there_are_none() -> None:
    reading = AisReading(NOW_S, (at(SHIP, 20.0, 0.0),))
    assert vessels_near(None, FRAME, boat(), CONFIG, NOW_S) == []
    assert vessels_near(reading, None, boat(), CONFIG, NOW_S) == []
    assert vessels_near(reading, FRAME, None, CONFIG, NOW_S) == []
