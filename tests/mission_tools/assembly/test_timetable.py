"""When waypoints are passed, and which departure is best, in a stream that turns."""

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from benchmarks.planning.tide import Water, swinging
from companion.core.geo import Point
from mission_tools.assembly.timetable import Timetable, Tried, fixed_route
from mission_tools.cli.plan import run_program as run_plan
from mission_tools.costs.current import UniformCurrent
from mission_tools.costs.departure import Departure, posix_s
from mission_tools.costs.travel import BoatSpeed, TravelTime
from mission_tools.errors import NoRoute
from mission_tools.geojson import collection, feature

ROUTE = (Point(0.0, 0.0), Point(0.0, 300.0), Point(0.0, 900.0))
LAKE = ("--boat", "lake", "--one-way")
AT_S = posix_s("2026-06-01T23:50Z")
TURNING = TravelTime(BoatSpeed(1.0, 1.2), Water(swinging(1.5, 90.0, 7200.0)))  # strongest with it at 0


def test_a_route_in_still_water_is_timed_with_its_holds() -> None:
    found = fixed_route(TravelTime(BoatSpeed(2.0, 3.0)), ROUTE, Departure(50.0, 50.0), (5.0, 10.0, 60.0))
    assert found == Timetable(50.0, (205.0, 515.0))
    assert found.lines() == ["times: 7 min 45 s under way; waypoint 1 2 min 35 s, 2 7 min 45 s"]


def test_dates_are_said_and_the_day_where_it_changes() -> None:
    found = Timetable(AT_S, (AT_S + 60.0, AT_S + 900.0), is_dated=True, wait_s=300.0)
    assert found.lines() == [
        "times: 15 min 00 s under way, leaves 2026-06-01 23:50Z; "
        "waypoint 1 23:51:00Z, 2 2026-06-02 00:05:00Z",
        "leaves 5 min 00 s later than asked: the current is too strong before",
    ]
    assert found.as_json()["arrive"] == ["2026-06-01T23:51:00Z", "2026-06-02T00:05:00Z"]
    assert found.sailed((70.0, 930.0)).arrive_s == (AT_S + 70.0, AT_S + 930.0)


def test_of_many_waypoints_only_the_last_is_said() -> None:
    assert Timetable(0.0, tuple(range(1, 14))).lines() == ["times: 13 s under way; waypoint 13 13 s"]


def test_the_best_departure_is_when_the_stream_helps() -> None:
    found = fixed_route(TURNING, ROUTE, Departure(1800.0, 9000.0))
    assert len(found.tried) == 49
    assert found.depart_s == pytest.approx(7200.0 - 300.0, abs=300.0)  # slack is at 5400
    assert found.arrive_s[-1] - found.depart_s == pytest.approx(min(one.cost for one in found.tried))
    assert any(math.isinf(one.cost) for one in found.tried)
    assert all(
        one.arrive_s == pytest.approx(one.depart_s + one.cost) for one in found.tried if one.cost < math.inf
    )
    assert "best of 49 departures, " in found.lines()[-1]
    listed: Any = found.as_json()["departures"]
    assert listed[-1][0] == 9000.0
    assert [None, None] in [row[1:] for row in listed]


def test_what_the_worst_departure_takes_is_said_in_its_unit() -> None:
    tried = (Tried(0.0, 9.0, 120.0), Tried(60.0, 70.0, 240.0), Tried(90.0, math.inf, math.inf))
    found = Timetable(0.0, (9.0,), tried=tried, unit="mAh")
    assert found.lines()[-1] == (
        "best of 3 departures, 1 against too strong a current; worst: 1 min 00 s, 240 mAh"
    )


def test_a_leg_that_cannot_be_sailed_is_named_with_the_time_and_a_departure_that_would_do() -> None:
    with pytest.raises(NoRoute, match=r"leg 2 cannot .* at 42 min \d\d s; .* --depart \d+") as refused:
        fixed_route(TURNING, ROUTE, Departure(2000.0, 2000.0), (0.0, 100.0, 0.0))
    departure = float(str(refused.value).split()[-1])
    assert fixed_route(TURNING, ROUTE, Departure(departure, departure)).arrive_s[-1] < departure + 2000.0
    ahead = TravelTime(BoatSpeed(1.0, 1.2), Water(swinging(-9.0, 90.0, 1e9)))
    with pytest.raises(NoRoute, match=r"leg 1 cannot .* at 0 s, nor by leaving within 25 h after that"):
        fixed_route(ahead, ROUTE, Departure())
    with pytest.raises(NoRoute, match=r"leg 1 cannot be sailed against current or wind$"):
        fixed_route(TravelTime(BoatSpeed(1.0, 1.2), UniformCurrent(0.0, -2.0)), ROUTE, Departure())


@pytest.fixture
def pond(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A pond of 143 × 222 m, and a stream along it that turns every hour, for a day."""
    monkeypatch.setattr("mission_tools.costs.cheapest.LATTICE_CELLS", 1_500)
    monkeypatch.setattr("mission_tools.assembly.planned_costs.PLANNED_DEPARTURES", 2)
    ring = [[-1.2, 50.0], [-1.198, 50.0], [-1.198, 50.002], [-1.2, 50.002], [-1.2, 50.0]]
    (tmp_path / "pond.geojson").write_text(json.dumps(collection([feature("Polygon", [ring], kind="water")])))
    rows = ["lat_deg,lon_deg,time_utc,current_east_m_s,current_north_m_s"]
    for minutes in range(0, 24 * 60, 10):
        north = 4.0 * math.cos(math.pi * minutes / 60.0)
        at = f"2026-06-01T{minutes // 60:02d}:{minutes % 60:02d}Z"
        rows += [f"{lat},{lon},{at},0,{north:.3f}" for lat in (50.0, 50.002) for lon in (-1.2, -1.198)]
    (tmp_path / "tide.csv").write_text("\n".join(rows))
    monkeypatch.chdir(tmp_path)


def planned(capsys: pytest.CaptureFixture[str], *arguments: str) -> tuple[int, dict[str, Any]]:
    places = ["--start", "50.0002,-1.1990", "--goal", "50.0018,-1.1990", "--clearance", "3", "--speed", "1"]
    code = run_plan(["pond.geojson", *places, "--json", *arguments])
    return code, json.loads(capsys.readouterr().out)


@pytest.mark.usefixtures("pond")
def test_a_window_finds_the_fair_tide(capsys: pytest.CaptureFixture[str]) -> None:
    window = "2026-06-01T03:30Z..2026-06-01T05:30Z"
    code, report = planned(capsys, "--current", "tide.csv", "--depart", window, "--out", "out.html")
    assert code == 0
    table = report["timetable"]
    assert "2026-06-01T03:50:00Z" <= table["depart"] <= "2026-06-01T04:10:00Z"
    assert len(table["departures"]) == 49
    assert table["under_way_s"] < 80.0  # 178 m
    assert report["plan"]["length_m"] == pytest.approx(178.0, abs=2.0)


@pytest.mark.usefixtures("pond")
def test_against_the_tide_it_leaves_later(capsys: pytest.CaptureFixture[str]) -> None:
    code, report = planned(capsys, "--current", "tide.csv", "--depart", "2026-06-01T03:00Z", *LAKE)
    assert code == 0
    assert 600.0 < report["timetable"]["wait_s"] < 1800.0
    assert report["budget"]["time_s"] == pytest.approx(report["timetable"]["under_way_s"], abs=1.0)


@pytest.mark.usefixtures("pond")
def test_a_tour_that_meets_the_tide_is_refused_with_a_departure_that_would_do(
    capsys: pytest.CaptureFixture[str],
) -> None:
    tour = ["--current", "tide.csv", "--return"]
    code, report = planned(capsys, *tour, "--depart", "2026-06-01T03:00Z")
    assert code == 1
    assert (
        "leg 1 cannot be sailed against current or wind at 2026-06-01 03:00Z; the route can be"
        in report["error"]
    )
    departure = report["error"].split()[-1]
    code, report = planned(capsys, *tour, "--depart", departure)
    assert (code, report["timetable"]["depart"]) == (0, departure)
    assert len(report["timetable"]["arrive"]) == len(report["waypoints"])


@pytest.mark.usefixtures("pond")
def test_a_voyage_after_the_end_of_the_file_is_noted(capsys: pytest.CaptureFixture[str]) -> None:
    for more in ((), ("--hold", "5", "--wind", "2@0", "--boat", "lake", "--one-way")):
        _, report = planned(capsys, "--current", "tide.csv", "--depart", "2026-06-02T03:00Z", *more)
        assert any(
            "known from 2026-06-01 00:00Z to 2026-06-01 23:50Z only" in note for note in report["notes"]
        )


@pytest.mark.usefixtures("pond")
def test_a_date_alone_gives_times_in_still_water(capsys: pytest.CaptureFixture[str]) -> None:
    _, report = planned(capsys, "--depart", "2026-06-01T03:00Z")
    assert report["timetable"]["arrive"] == ["2026-06-01T03:02:58Z"]
    assert np.isclose(report["timetable"]["under_way_s"], 178.0, atol=1.0)
