"""What the planner is asked for, and what the page gets of its report, without the planner."""

import asyncio
import json
from pathlib import Path
from typing import Any

import pytest
from shore_server import FakeBoats

from mission_tools.shore.plans.plan_request import PlanRequest, PlanRequestError, charge_percent, distance
from mission_tools.shore.plans.plan_service import PlanService, Sources
from mission_tools.shore.plans.plan_store import file_name
from mission_tools.shore.plans.process import Planner, PlannerError
from mission_tools.station.messages import Place

HERE = Place(lat=50.0, lon=-1.2)
GOAL = (-1.1975, 50.0017)
BUDGET = {"time_s": 90.0, "charge_mah": 500.0, "home_mah": 300.0, "capacity_mah": 4000.0, "suffices": True}
AREA = {
    "type": "Feature", "properties": {"seq": 0, "command": 5001},
    "geometry": {"type": "Polygon", "coordinates": [[[0, 0], [0, 1], [1, 1], [0, 0]]]},
}  # fmt: skip


class FakePlanner(Planner):
    """Notes what it is asked for; answers with the report, or says no."""

    def __init__(self) -> None:
        super().__init__()
        self.asked: list[list[str]] = []
        self.refusals: list[str] = []
        self.files: dict[str, bytes] = {}
        route = {"length_m": 120.0, "hold_s": 30.0, "min_clearance_m": 4.5}
        row = [0, 16, 1, 0, 0, 0, None, 500000000, -12000000, 0]
        self.report: dict[str, Any] = {
            "plan": None, "task": route, "file": route, "budget": None, "notes": [], "home": [0, 0],
            "waypoints": [[50.0, -1.2], [50.0017, -1.1975]],
            "items": {"mission": [row, row, row], "fence": [row], "rally": []},
        }  # fmt: skip

    async def run(self, arguments: list[str], folder: Path) -> dict[str, Any]:
        self.asked.append(arguments)
        if self.refusals:
            raise PlannerError(self.refusals.pop())
        self.files = {one.name: one.read_bytes() for one in folder.iterdir()}
        (folder / "new.plan").write_text("{}")
        return self.report


class PlanRig:
    """A service of plans with its boat and planner."""

    def __init__(self, sources: Sources | None = None) -> None:
        self.boats = FakeBoats()
        self.boats.change(place=HERE, cruise_m_s=2.0)
        self.planner = FakePlanner()
        self.service = PlanService(self.boats, sources or Sources(), self.planner)

    def plan(self, **wanted: Any) -> Any:  # noqa: ANN401 (a MadePlan)
        return asyncio.run(self.service.plan(1, PlanRequest(**wanted)))

    def read(self, name: str) -> Any:  # noqa: ANN401 (a MadePlan)
        return asyncio.run(self.service.read(1, name, b"content"))

    def folders(self) -> list[Path]:
        root = self.service.store._root
        return [] if root is None else list(root.iterdir())


@pytest.fixture
def rig() -> Any:  # noqa: ANN401
    made = PlanRig()
    yield made
    made.service.close()


def test_a_route_is_asked_for_with_every_option(rig: PlanRig) -> None:
    rig.boats.lists["fence"] = {"features": [AREA]}
    rig.plan(
        task="route", start=Place(lat=1.0, lon=2.0), goals=[(3.0, 4.0), GOAL], any_order=True, is_return=True,
        clearance_m=2.5, speed_m_s=1.2,
    )  # fmt: skip
    assert rig.planner.asked == [
        [
            "open.toml", "--start-at=1.0000000,2.0000000", "--via=4.0000000,3.0000000",
            "--goal=50.0017000,-1.1975000", "--any-order", "--return", "--clearance=2.5", "--speed=1.2",
            "--fence", "fence.geojson", "--out", "new.plan",
        ]
    ]  # fmt: skip
    assert b"lat_deg = 1.0000000\nlon_deg = 2.0000000" in rig.planner.files["open.toml"]
    assert len(json.loads(rig.planner.files["fence.geojson"])["features"]) == 1


def test_a_wind_is_asked_for_with_where_it_comes_from() -> None:
    rig = PlanRig(Sources(Path("water.geojson"), "lake"))
    rig.plan(task="route", goals=[GOAL], wind_m_s=4.5, wind_from_deg=270.0)
    rig.plan(task="route", goals=[GOAL], wind_m_s=4.0)
    rig.plan(task="route", goals=[GOAL], wind_from_deg=90.0)
    winds = [[word for word in asked if word.startswith("--wind")] for asked in rig.planner.asked]
    assert winds == [["--wind=4.5@270"], ["--wind=4@0"], []]
    rig.service.close()


def test_a_survey_is_asked_for_with_its_area_or_of_all_the_water() -> None:
    rig = PlanRig(Sources(Path("water.geojson"), "lake"))
    area = [(0.0, 0.0), (0.0, 1.0), (1.0, 1.0)]
    rig.plan(task="survey", footprint_m=4.0, overlap=0.2, angle_deg=90.0, area=area)
    rig.plan(task="survey", footprint_m=4.0)
    water = str(Path("water.geojson").resolve())
    start = [water, "--start-at=50.0000000,-1.2000000", "--survey"]
    end = ["--boat", "lake", "--beyond-range", "--out", "new.plan"]
    options = ["--footprint=4.0", "--overlap=0.2", "--angle=90.0"]
    assert rig.planner.asked == [
        [*start, "area.geojson", *options, *end],
        [*start, "all", "--footprint=4.0", *end],
    ]
    rig.service.close()


def test_a_report_becomes_a_plan_of_the_page(rig: PlanRig) -> None:
    made = rig.plan(task="route", goals=[GOAL])
    assert (made.name, made.task, made.items, made.length_m) == ("Route 120 m", "route", 2, 120.0)
    assert (made.time_s, made.charge_percent, made.fits) == (90.0, None, None)  # at 2 m/s, and 30 s of stay
    assert (made.points, made.clearance_m, made.has_areas) == ([(-1.2, 50.0), GOAL], 4.5, False)
    assert len(made.warnings) == 1
    assert "fence" in made.warnings[0]
    rig.planner.report |= {"budget": BUDGET, "notes": [f"Note {n}" for n in range(15)], "home": [49.0, -1.0]}
    rig.boats.lists["fence"] = {"features": []}
    made = rig.plan(task="route", goals=[GOAL])
    assert (made.time_s, made.charge_percent, made.fits) == (90.0, 20.0, True)
    assert made.points[0] == (-1.0, 49.0)
    assert made.warnings[:12] == [f"Note {n}" for n in range(12)]
    assert len(made.warnings) == 13
    assert "3" in made.warnings[12]
    kept = rig.service.store.find(made.id)
    assert kept is not None
    assert [one.name for one in kept.folder.iterdir()] == ["Route-120-m.plan"]
    assert [len(one) for one in kept.lists] == [3, 0, 0]


def test_without_a_speed_no_time_is_known_and_without_a_draw_no_charge(rig: PlanRig) -> None:
    rig.boats.change(cruise_m_s=None)
    assert rig.plan(task="route", goals=[GOAL]).time_s is None
    assert rig.plan(task="route", goals=[GOAL], speed_m_s=1.0).time_s == 150.0
    for missing in ("charge_mah", "home_mah", "capacity_mah"):
        assert charge_percent({"budget": BUDGET | {missing: None}}) is None
    assert [distance(one) for one in (9_999.4, 10_000.0)] == ["9999 m", "10.0 km"]


def test_a_refusal_names_a_place_by_its_number_and_leaves_no_folder(rig: PlanRig) -> None:
    for said, told in (
        ("Via point 2 50.1,-1.2 is on land", "Place 2 is on land"),
        ("Goal 50.1,-1.2 is on land", "Place 3 is on land"),
    ):
        rig.planner.refusals = [said]
        with pytest.raises(PlannerError, match=told):
            rig.plan(task="route", goals=[GOAL] * 3)
    assert rig.folders() == []
    rig.boats.change(place=None)
    with pytest.raises(PlanRequestError):
        rig.plan(task="route", goals=[GOAL])


@pytest.mark.parametrize("name", ["x", "x.exe", ".", ""])
def test_a_file_of_another_kind_is_not_read(rig: PlanRig, name: str) -> None:
    with pytest.raises(PlanRequestError):
        rig.read(name)
    assert rig.planner.asked == []


def test_a_file_is_read_on_the_water_within_the_fence(rig: PlanRig) -> None:
    rig.boats.lists["fence"] = {"features": [AREA]}
    made = rig.read(" my trip.GPX")
    start, fence = "--start-at=50.0000000,-1.2000000", ["--fence", "fence.geojson"]
    out = ["--out", "new.plan", start]
    assert rig.planner.asked == [["my-trip.gpx", "--check-on", "none", "--as-route", *fence, *out]]
    assert (made.name, made.task, made.has_areas, made.time_s) == ("my trip", "import", False, 90.0)
    rig.planner.asked.clear()
    made = rig.read("x.waypoints")
    assert rig.planner.asked == [["x.waypoints", "--check-on", "none", *fence, *out]]


@pytest.mark.parametrize("has_own", [False, True])
def test_a_plan_keeps_its_own_fence_and_is_checked_against_the_boats_otherwise(
    rig: PlanRig, has_own: bool
) -> None:
    rig.boats.lists["fence"] = {"features": [AREA]}
    rig.planner.report["items"]["fence"] = rig.planner.report["items"]["mission"] if has_own else []
    made = rig.read("x.plan")
    assert ["--fence" in one for one in rig.planner.asked] == ([False] if has_own else [False, True])
    assert made.has_areas == has_own


def test_a_budget_that_cannot_be_made_is_left_out() -> None:
    rig = PlanRig(Sources(None, "lake"))
    rig.planner.refusals = ["it ends on land"]
    rig.read("x.gpx")
    assert [("--boat" in one, "--beyond-range" in one) for one in rig.planner.asked] == [
        (True, True),
        (False, False),
    ]
    rig.boats.change(place=None)
    rig.read("x.gpx")
    assert not any("--start-at" in option for option in rig.planner.asked[-1])
    rig.service.close()


@pytest.mark.parametrize(
    ("name", "file"),
    [("Route 1.2 km", "Route-1-2-km"), ("../é/", "plan"), ("a" * 99, "a" * 60), ("-", "plan")],
)
def test_a_plan_has_a_plain_file_name(name: str, file: str) -> None:
    assert file_name(name) == file
