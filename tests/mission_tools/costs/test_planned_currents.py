"""What the planner takes the water to do: every form of --current, and what is refused."""

import math
from pathlib import Path

import numpy as np
import pytest
import shapely

from companion.core.geo import LatLon, LocalFrame, Point
from mission_tools.assembly.planned_costs import room_to_shore
from mission_tools.costs.current import Current, River, UniformCurrent
from mission_tools.costs.current_source import open_current
from mission_tools.errors import MapError, UsageError
from mission_tools.maps import build_chart
from sitl.world.environment.current import river
from sitl.world.environment.grid import read_grid
from sitl.world.environment.settings import River as EmulatedRiver

FRAME = LocalFrame(LatLon(50.0, 10.0))
GRID = "east_m,north_m,current_east_m_s,current_north_m_s\n" + "".join(
    f"{east},{north},{0.1 * east + 0.01 * north},{-0.2 * north}\n"
    for east in (0, 10, 40)
    for north in (-5, 5)
)


def velocity(current: Current, north_m: float, east_m: float, time_s: float = 0.0) -> tuple[float, float]:
    north, east = current.at(np.array([north_m]), np.array([east_m]), np.array([time_s]))
    return float(north[0]), float(east[0])


def test_a_current_is_named_by_where_it_flows_to() -> None:
    assert velocity(open_current("0.5,90", FRAME), 3.0, 4.0) == pytest.approx((0.0, 0.5))
    assert velocity(open_current(" .4 , -180 ", FRAME), 3.0, 4.0) == pytest.approx((-0.4, 0.0))
    assert UniformCurrent.towards(1.0, 45.0).north_m_s == pytest.approx(math.sqrt(0.5))


@pytest.mark.parametrize("to_deg", [0.0, 90.0, 215.0])
@pytest.mark.parametrize("off_m", [-25.0, -12.0, 0.0, 3.0, 19.9])
def test_a_straight_river_is_that_of_the_emulator(to_deg: float, off_m: float) -> None:
    to_rad = math.radians(to_deg)
    middle = tuple(Point(along * math.cos(to_rad), along * math.sin(to_rad)) for along in (-50.0, 0.0, 80.0))
    for along in (-200.0, -20.0, 40.0, 300.0):
        north = along * math.cos(to_rad) - off_m * math.sin(to_rad)
        east = along * math.sin(to_rad) + off_m * math.cos(to_rad)
        emulated = river(EmulatedRiver(speed_m_s=1.2, width_m=40.0, to_deg=to_deg), north, east)
        assert velocity(River(middle, 40.0, 1.2), north, east) == pytest.approx(emulated, abs=1e-12)


def test_a_river_turns_with_its_middle_line() -> None:
    bent = River((Point(0.0, 0.0), Point(100.0, 0.0), Point(100.0, 100.0)), 20.0, 1.0)
    assert velocity(bent, 50.0, 0.0) == pytest.approx((1.0, 0.0))
    assert velocity(bent, 100.0, 50.0) == pytest.approx((0.0, 1.0))
    assert velocity(bent, -50.0, 0.0) == pytest.approx((1.0, 0.0))  # straight on beyond its ends
    assert velocity(bent, 100.0, 150.0) == pytest.approx((0.0, 1.0))
    assert velocity(bent, 95.0, 50.0) == pytest.approx((0.0, 0.75))
    assert velocity(bent, 50.0, 30.0) == (0.0, 0.0)


def test_a_grid_is_read_as_the_emulator_reads_it(tmp_path: Path) -> None:
    path = tmp_path / "flow.csv"
    path.write_text(GRID)
    planned, emulated = open_current(str(path), FRAME), read_grid(path)
    for north in (-20.0, -5.0, 0.3, 5.0, 9.0):
        for east in (-3.0, 0.0, 7.0, 22.0, 40.0, 99.0):
            assert velocity(planned, north, east) == pytest.approx(emulated.at(north, east, 0.0), abs=1e-12)


def test_a_grid_with_times_changes_as_in_the_emulator_and_stays_as_it_is_beyond_its_ends(
    tmp_path: Path,
) -> None:
    path = tmp_path / "flow.npz"
    rng = np.random.default_rng(3)
    north_m_s, east_m_s = rng.normal(size=(2, 3, 2, 4))
    np.savez(
        path,
        time_s=[10.0, 50.0, 130.0],
        north_m=[-5.0, 5.0],
        east_m=[0.0, 10.0, 20.0, 60.0],
        current_north_m_s=north_m_s,
        current_east_m_s=east_m_s,
    )
    planned, emulated = open_current(str(path), FRAME), read_grid(path)
    assert planned.times == (10.0, 130.0, False)
    for time_s in (-100.0, 10.0, 33.0, 50.0, 90.0, 130.0, 1e6):
        for north, east in ((-5.0, 0.0), (1.0, 7.0), (4.0, 33.0), (99.0, -99.0)):
            expected = pytest.approx(emulated.at(north, east, time_s), abs=1e-12)
            assert velocity(planned, north, east, time_s) == expected


def test_a_grid_in_degrees_lies_where_its_places_are(tmp_path: Path) -> None:
    path = tmp_path / "forecast.csv"
    rows = [
        f"{lat},{lon},{lon - 10.0},{lat - 50.0}"
        for lat in (49.99, 50.0, 50.01)
        for lon in (9.98, 10.0, 10.03)
    ]
    path.write_text("\n".join(["lat_deg,lon_deg,current_east_m_s,current_north_m_s", *rows]))
    at = FRAME.to_local(LatLon(50.004, 10.012))
    assert velocity(open_current(str(path), FRAME), *at) == pytest.approx((0.004, 0.012), abs=1e-5)


def test_a_toml_file_sums_what_it_names(tmp_path: Path) -> None:
    (tmp_path / "flow.csv").write_text(GRID)
    path = tmp_path / "flow.toml"
    path.write_text(
        'speed_m_s = 0.2\nto_deg = 0\nfile = "flow.csv"\n'
        "[river]\nspeed_m_s = 1.0\nwidth_m = 40\nmiddle = [[50.0, 10.0], [50.0, 10.01]]\n"
    )
    north, east = velocity(open_current(str(path), FRAME), 0.0, 20.0)
    assert north == pytest.approx(0.2, abs=1e-3)
    assert east == pytest.approx(2.0 + 1.0, abs=1e-3)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("fast", "expected SPEED,TO_DEG"),
        ("-1,90", "expected SPEED,TO_DEG"),
        ("25,90", "at most 20"),
        ("flow.kml", "expected SPEED,TO_DEG"),
    ],
)
def test_a_text_that_names_no_current_is_refused(text: str, message: str) -> None:
    with pytest.raises(UsageError, match=message):
        open_current(text, FRAME)


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("a.csv", "lat_deg,lon_deg\n1,2\n", "no current_east_m_s"),
        (
            "a.csv",
            "east_m,north_m,current_east_m_s,current_north_m_s\n1,2,x,4\n",
            "line 2: expected four numbers",
        ),
        ("a.npz", "no archive", "not a current"),
        ("a.toml", "to_deg = 3", "names no current"),
        ("a.toml", "speed = 3", "speed"),
        ("a.toml", "speed_m_s = -1", "speed_m_s"),
        ("a.toml", "[river]\nspeed_m_s = 1\nwidth_m = 10\nmiddle = [[1, 2]]", "middle"),
        ("a.toml", "speed_m_s = [", "a.toml"),
        ("a.toml", 'file = "none.csv"', "none.csv"),
    ],
)
def test_a_file_that_is_no_current_is_named_with_what_is_wrong(
    tmp_path: Path, name: str, content: str, message: str
) -> None:
    (tmp_path / name).write_text(content)
    with pytest.raises(MapError, match=message):
        open_current(str(tmp_path / name), FRAME)


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(MapError, match=r"gone\.toml: cannot be read"):
        open_current(str(tmp_path / "gone.toml"), FRAME)
    with pytest.raises(ValueError, match="two points"):
        River((Point(0.0, 0.0),), 10.0, 1.0)


def test_the_room_to_the_shore_is_that_of_the_whole_outline() -> None:
    ring = shapely.box(-80, -50, 80, 50).difference(shapely.Point(10.0, 5.0).buffer(20.0))
    water = shapely.union_all([ring, shapely.box(200, 0, 240, 30)])
    chart = build_chart("Two", FRAME, water, ())
    route = (Point(-40.0, -70.0), Point(25.0, 230.0))
    north_m, east_m = np.meshgrid(np.linspace(-50.0, 50.0, 25), np.linspace(-80.0, 240.0, 31))
    expected = shapely.distance(chart.shores, shapely.points(east_m, north_m))
    assert room_to_shore(chart, route)(north_m, east_m) == pytest.approx(expected, abs=0.5)  # cells of 0.73 m
    sea = build_chart("Sea", FRAME, None, ())
    assert np.isinf(room_to_shore(sea, route)(north_m, east_m)).all()
