"""Plans over HTTP with the real planner on a real map; what is written is read by the formats' own rules."""

import asyncio
import csv
import io
import json
import re
from contextlib import AbstractAsyncContextManager
from itertools import pairwise
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import msgspec
import pytest
import shapely
from shore_server import FakeBoats, Server, answer, serving, until

from companion.mavlink.items import MissionItem
from mission_tools.shore.plans.plan_request import Lists, MadePlan
from mission_tools.shore.plans.plan_service import MOST_BYTES, Sources
from mission_tools.shore.plans.plan_store import MOST_PLANS, PlanStore, StoredPlan
from mission_tools.station.messages import Place
from mission_tools.station.outcome import Accepted

pytest_plugins = ("server_fixtures",)
pytestmark = pytest.mark.slow

POND = Path("sitl/scenarios/maps/mill_pond.geojson").resolve()
LAKE = Sources(POND, "lake")
HERE = Place(lat=49.99865, lon=-1.2027)
GOAL = [-1.1975, 50.0017]
NO_FENCE: dict[str, Any] = {"type": "FeatureCollection", "features": []}
GPX = "{http://www.topografix.com/GPX/1/1}"
KML = "{http://www.opengis.net/kml/2.2}"


@pytest.fixture
def lake() -> AbstractAsyncContextManager[Server]:
    """A server with the map of the mill pond and the lake's boat."""
    return serving(sources=LAKE)


def prepare(server: Server, **values: Any) -> FakeBoats:  # noqa: ANN401 (fields of a Snapshot)
    """A boat on the pond."""
    server.boats.lists["fence"] = NO_FENCE
    server.boats.change(**({"place": HERE, "cruise_m_s": 2.0} | values))
    return server.boats


async def plan(server: Server, wanted: dict[str, Any]) -> tuple[int, dict[str, Any]]:
    async with server.client.post("/api/boats/1/plan", json=wanted, headers=server.own) as response:
        return response.status, await response.json()


async def read(server: Server, name: str, body: bytes | io.BytesIO) -> tuple[int, dict[str, Any]]:
    path = f"/api/boats/1/plan/import?name={name}"
    async with server.client.post(path, data=body, headers=server.own) as response:
        return response.status, await response.json()


async def get(server: Server, path: str) -> tuple[int, bytes, str]:
    async with server.client.get(path) as response:
        return response.status, await response.read(), response.headers.get("Content-Disposition", "")


def water() -> shapely.Geometry:
    """Of the pond, by shapely's own reader."""
    features = json.loads(POND.read_text("utf-8"))["features"]
    shapes = [(one["properties"].get("kind", "water"), one["geometry"]) for one in features]
    wet = shapely.union_all([shapely.geometry.shape(shape) for kind, shape in shapes if kind == "water"])
    dry = [shapely.geometry.shape(shape) for kind, shape in shapes if kind not in ("water", "landmark")]
    return wet.difference(shapely.union_all(dry))


async def test_a_route_keeps_to_the_water_and_says_what_it_costs(lake: Server) -> None:
    await lake.log_in()
    prepare(lake)
    status, route = await plan(lake, {"task": "route", "goals": [GOAL], "speed_m_s": 1.0})
    assert status == 200
    assert shapely.LineString(route["points"]).within(water())
    assert route["points"][0] == [HERE.lon, HERE.lat]
    assert route["points"][-1] == GOAL
    assert 500 < route["length_m"] < 560
    assert route["time_s"] == pytest.approx(route["length_m"], rel=0.1)
    assert 1 < route["charge_percent"] < 30
    assert (route["fits"], route["has_areas"], route["task"]) == (True, False, "route")
    assert route["clearance_m"] >= 4.0
    assert all(a != b for a, b in pairwise(route["points"]))
    assert route["items"] == len(route["points"])  # the speed is one more, home is one less


async def test_the_boats_fence_is_kept_to(lake: Server) -> None:
    ring = [
        [-1.2040, 49.9980],
        [-1.1990, 49.9980],
        [-1.1990, 50.0020],
        [-1.2040, 50.0020],
        [-1.2040, 49.9980],
    ]
    geometry = {"type": "Polygon", "coordinates": [ring]}
    feature = {"type": "Feature", "properties": {"seq": 0, "command": 5001}, "geometry": geometry}
    await lake.log_in()
    boats = prepare(lake)
    boats.lists["fence"] = {"type": "FeatureCollection", "features": [feature]}
    status, refused = await plan(lake, {"task": "route", "goals": [GOAL]})
    assert status == 422
    assert "fence" in refused["error"]
    inside = {"task": "route", "goals": [[-1.1999, 50.0003]]}
    status, route = await plan(lake, inside)
    assert status == 200
    assert shapely.LineString(route["points"]).within(shapely.Polygon(ring))


async def test_without_a_map_routes_are_straight_and_without_a_boat_file_nothing_is_said_of_the_charge(
    server: Server,
) -> None:
    await server.log_in()
    prepare(server)
    _, route = await plan(server, {"task": "route", "goals": [GOAL]})
    assert route["points"] == [[HERE.lon, HERE.lat], GOAL]
    assert (route["charge_percent"], route["fits"], route["clearance_m"]) == (None, None, None)
    assert route["time_s"] == pytest.approx(route["length_m"] / 2.0)


async def test_where_there_is_no_plan_the_planners_own_sentence_says_why(lake: Server) -> None:
    await lake.log_in()
    prepare(lake)
    wishes: list[tuple[dict[str, Any], str]] = [
        ({"task": "route", "goals": [[-1.5, 50.0]]}, "lies outside the map"),
        ({"task": "route", "goals": [GOAL], "clearance_m": 30}, "clearance"),
    ]
    for wanted, said in wishes:
        status, refused = await plan(lake, wanted)
        assert status == 422
        assert said in refused["error"]
        assert not re.search("Traceback|/tmp/|--", refused["error"])
    prepare(lake, place=None)
    status, refused = await plan(lake, {"task": "route", "goals": [GOAL]})
    assert (status, refused["key"]) == (422, "planner.no_boat")


async def files_of(server: Server, path: str) -> dict[str, bytes]:
    """Each format of a plan, saved under a plain name."""
    found = {}
    for kind in ("plan", "waypoints", "kml", "gpx", "geojson"):
        status, body, disposition = await get(server, f"{path}.{kind}")
        assert status == 200, kind
        assert re.fullmatch(rf'attachment; filename="[A-Za-z0-9-]+\.{kind}"', disposition)
        found[kind] = body
    return found


def check_files(files: dict[str, bytes], points: list[list[float]]) -> None:
    """By the rules of the formats, each file has this line."""
    tree = json.loads(files["plan"])
    assert (tree["fileType"], tree["version"], tree["mission"]["version"]) == ("Plan", 1, 2)
    lines = {"plan": [item["params"][5:3:-1] for item in tree["mission"]["items"] if item["command"] == 16]}
    rows = list(csv.reader(files["waypoints"].decode().splitlines()[1:], delimiter="\t"))
    assert [int(row[0]) for row in rows] == list(range(len(rows)))
    lines["waypoints"] = [[float(row[9]), float(row[8])] for row in rows[1:] if row[3] == "16"]
    gpx = ElementTree.fromstring(files["gpx"])  # noqa: S314 (our own)
    assert (gpx.tag, gpx.get("version")) == (f"{GPX}gpx", "1.1")
    route = gpx.findall(f"{GPX}rte/{GPX}rtept")
    lines["gpx"] = [[float(at.attrib["lon"]), float(at.attrib["lat"])] for at in route][1:]
    kml = ElementTree.fromstring(files["kml"])  # noqa: S314 (our own)
    text = kml.findtext(f"{KML}Document/{KML}Placemark/{KML}LineString/{KML}coordinates") or ""
    lines["kml"] = [[float(value) for value in at.split(",")[:2]] for at in text.split()][1:]
    features = json.loads(files["geojson"])["features"]
    lines["geojson"] = next(
        one["geometry"]["coordinates"] for one in features if one["geometry"]["type"] == "LineString"
    )[1:]
    for kind, line in lines.items():
        assert line == [pytest.approx(at, abs=2e-7) for at in points[1:]], kind


async def test_a_plan_is_downloaded_in_every_format_and_reads_back_the_same(lake: Server) -> None:
    await lake.log_in()
    prepare(lake)
    wanted = {"task": "route", "goals": [GOAL, [-1.1995, 50.0005]], "speed_m_s": 1.5}
    _, route = await plan(lake, wanted)
    files = await files_of(lake, f"/api/plans/{route['id']}")
    check_files(files, route["points"])
    for kind in ("plan", "kml"):
        status, again = await read(lake, f"voyage.{kind}", files[kind])
        assert status == 200, again
        assert again["points"] == [pytest.approx(at, abs=2e-7) for at in route["points"]], kind
        assert (again["name"], again["task"]) == ("voyage", "import")
        assert again["length_m"] == pytest.approx(route["length_m"], abs=0.1)


async def test_the_mission_on_board_is_downloaded_with_its_fence(server: Server) -> None:
    points = [[-1.2027, 49.99865], [-1.2, 49.9995], GOAL]
    items = tuple(
        MissionItem(frame=0 if n == 0 else 3, command=16, x=round(lat * 1e7), y=round(lon * 1e7))
        for n, (lon, lat) in enumerate(points)
    )
    ring = [[-1.21, 49.99], [-1.19, 49.99], [-1.19, 50.01], [-1.21, 49.99]]
    fence = {
        "type": "Feature",
        "properties": {"seq": 0, "command": 5001},
        "geometry": {"type": "Polygon", "coordinates": [ring]},
    }
    boats = prepare(server)
    assert (await get(server, "/api/boats/1/mission.plan"))[0] == 403
    await server.log_in()
    assert (await get(server, "/api/boats/1/mission.plan"))[0] == 404
    boats.items_on_board = items
    boats.lists["fence"] = {"type": "FeatureCollection", "features": [fence]}
    _, body, _ = await get(server, "/api/boats/1/mission.plan")
    tree = json.loads(body)
    assert [item["params"][5:3:-1] for item in tree["mission"]["items"]] == points[1:]
    assert (await get(server, "/api/boats/1/mission.waypoints"))[0] == 200
    (area,) = tree["geoFence"]["polygons"]
    assert area["polygon"] == [[pytest.approx(lat), pytest.approx(lon)] for lon, lat in ring[:-1]]


async def test_an_imported_route_over_land_is_warned_of(lake: Server) -> None:
    body = (
        b'<gpx xmlns="http://www.topografix.com/GPX/1/1" creator="BaseCamp" version="1.1"><rte>'
        b'<rtept lat="49.9987" lon="-1.2026"/><rtept lat="50.0005" lon="-1.2"/></rte></gpx>'
    )
    await lake.log_in()
    prepare(lake)
    status, route = await read(lake, "Across%20the%20isle.gpx", body)
    assert status == 200
    assert route["name"] == "Across the isle"
    assert any("crosses land" in warning for warning in route["warnings"])
    assert route["items"] == 2


async def test_a_file_that_is_no_plan_is_refused_in_a_sentence(lake: Server) -> None:
    await lake.log_in()
    prepare(lake)
    files = [
        ("x.gpx", b'<!DOCTYPE g [<!ENTITY a "aaaa"><!ENTITY b "&a;&a;">]><gpx>&b;</gpx>', "DOCTYPE"),
        ("x.plan", b"{}", "not a QGroundControl plan"),
        ("..%2F..%2Fetc%2Fpasswd", b"", "name"),
        ("x.exe", b"MZ", "name"),
        ("", b"", "name"),
    ]
    for name, body, said in files:
        status, refused = await read(lake, name, body)
        assert status == 422
        assert said in refused["error"]
        assert not re.search("\n|/tmp/", refused["error"])


async def test_a_file_may_have_two_megabytes_and_no_more(server: Server) -> None:
    await server.log_in()
    prepare(server)
    assert (await read(server, "x.gpx", io.BytesIO(bytes(MOST_BYTES + 1))))[0] == 413
    assert (await read(server, "x.gpx", io.BytesIO(b" " * MOST_BYTES)))[0] == 422


def test_the_latest_plans_are_kept_and_their_files_go_with_the_server() -> None:
    store = PlanStore()
    plan = MadePlan(
        id="", name="route", task="route", items=1, points=[], length_m=1.0, time_s=None, charge_percent=None,
        fits=None, clearance_m=None, has_areas=False, warnings=[],
    )  # fmt: skip
    idents = [str(number) for number in range(MOST_PLANS + 1)]
    for ident in idents:
        store.keep(StoredPlan(msgspec.structs.replace(plan, id=ident), Lists(()), store.new_folder()))
    found = [store.find(ident) for ident in idents]
    assert [one is not None for one in found] == [False] + [True] * MOST_PLANS
    last = found[-1]
    assert last is not None
    root = last.folder.parent
    assert len(list(root.iterdir())) == MOST_PLANS
    store.close()
    assert not root.exists()


async def test_the_planner_ends_when_the_page_leaves(lake: Server) -> None:
    await lake.log_in()
    prepare(lake)
    call = asyncio.create_task(plan(lake, {"task": "survey", "footprint_m": 1}))
    planner = lake.hub.plans.planner
    await until(lambda: planner._process is not None)
    process = planner._process
    assert process is not None
    call.cancel()
    await asyncio.gather(call, return_exceptions=True)
    await process.wait()
    assert process.returncode == -9
    await until(lambda: planner._asked == 0)


async def test_a_plan_is_uploaded_as_it_is_and_areas_only_if_asked_for(server: Server) -> None:
    params = ((178, 2, [1, 0.7, -1, 0, 0, 0, 0]), (16, 3, [9, 0, 0, None, 49.999, -1.202, 0]))
    items = [{"type": "SimpleItem", "command": a, "frame": b, "params": c} for a, b, c in params]
    square = {"polygon": [[49.99, -1.21], [49.99, -1.19], [50.01, -1.2]], "inclusion": True}
    tree: dict[str, Any] = {
        "fileType": "Plan", "version": 1,
        "mission": {"version": 2, "plannedHomePosition": [49.99865, -1.2027, 0], "items": items},
        "geoFence": {"version": 2, "polygons": [square], "circles": []},
        "rallyPoints": {"version": 2, "points": [[49.9987, -1.2026, 0]]},
    }  # fmt: skip
    await server.log_in()
    boats = prepare(server, armed=False)
    _, given = await read(server, "x.plan", json.dumps(tree).encode())
    assert given["has_areas"]
    live = await server.live()
    for areas, kinds in ((False, ["mission"]), (True, ["fence", "rally", "mission"])):
        request = {"plan": given["id"], "start": True, "with_areas": areas}
        ident = f"u{areas}"
        await live.send_json({"type": "do", "id": ident, "boat": 1, "what": "upload_plan", "with": request})
        await until(lambda: bool(boats.uploads))
        upload, answered = boats.uploads.pop()
        assert [part.kind for part in upload.parts] == kinds
        assert upload.start is not None
        mission = upload.parts[-1].items
        assert [(one.command, one.param1) for one in mission] == [(16, 0.0), (178, 1.0), (16, 9.0)]
        answered(Accepted("The boat sails the plan"))
        told = await answer(live)
        assert (told["id"], told["ok"], told["result"]) == (ident, True, {"items": 2})
        assert told["text"] == "The boat sails the plan as soon as it is armed"


async def test_an_upload_of_nothing_is_answered(server: Server) -> None:
    await server.log_in()
    live = await server.live()
    wrong: list[dict[str, Any]] = [
        {},
        {"plan": "gone"},
        {"plan": 3},
        {"plan": "x", "start": "yes"},
        {"plan": "x", "y": 1},
    ]
    for number, asked in enumerate(wrong):
        request = {"type": "do", "id": str(number), "boat": 1, "what": "upload_plan", "with": asked}
        await live.send_json(request)
        told = await answer(live)
        assert (told["id"], told["ok"]) == (str(number), False)
        assert told["text"]
    assert server.boats.uploads == []


async def test_a_place_on_land_is_named_by_its_number(lake: Server) -> None:
    await lake.log_in()
    prepare(lake)
    land = [-1.203690, 49.998654]
    status, told = await plan(lake, {"task": "route", "goals": [land, GOAL]})
    assert status == 422
    assert told["error"].startswith("Place 1 ")
