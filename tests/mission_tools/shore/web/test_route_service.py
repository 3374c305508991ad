"""A way by the water, asked for from the page."""

from collections.abc import Mapping
from typing import Any

import pytest
from shore_server import FakeBoats, FakeChart, Server, answer, until

from mission_tools.shore.chart import Blocked, Way
from mission_tools.shore.web.route_service import RouteService
from mission_tools.station.messages import Answer, PageRequest, Place

pytest_plugins = ("server_fixtures",)

GOAL = {"lat": 1.0, "lon": 2.5}


def ask(service: RouteService, arguments: dict[str, Any]) -> list[Answer]:
    told: list[Answer] = []
    service.ask(PageRequest(id="a", boat=1, what="route", arguments=arguments), told.append)
    return told


@pytest.mark.parametrize(
    "goal",
    [{}, {"lat": 1.0}, {"lat": "1", "lon": 2.0}, {"lat": 90.1, "lon": 0.0}, {"lat": 0.0, "lon": -180.1}],
)
def test_a_goal_that_is_no_place_is_refused(goal: dict[str, Any]) -> None:
    (told,) = ask(RouteService(FakeBoats(), FakeChart()), goal)
    assert not told.ok
    assert told.key == "answer.no_goal"


def test_a_boat_without_a_position_has_no_way() -> None:
    boats = FakeBoats()
    boats.change(place=None)
    (told,) = ask(RouteService(boats, FakeChart()), GOAL)
    assert (told.ok, told.key) == (False, "answer.no_position")


async def test_a_way_comes_with_its_time_and_a_goal_ashore_with_the_nearest_water(
    server: Server, monkeypatch: pytest.MonkeyPatch
) -> None:
    found: list[Way | Blocked] = [
        Blocked("ashore", Place(lat=3.0, lon=4.0)),
        Way([(2.0, 1.0), (2.5, 1.0)], 100.0, 4.0),
        Way([(2.0, 1.0), (2.5, 1.0)], 100.0, 4.0),
    ]
    asked: list[tuple[Place, Place, Mapping[str, Any] | None]] = []

    def way(*places: Any) -> Way | Blocked:  # noqa: ANN401
        asked.append(places)
        return found.pop()

    monkeypatch.setattr(server.hub.chart, "way", way)
    server.boats.lists["fence"] = {"features": []}
    await server.log_in()
    live = await server.live()

    async def told(ident: str) -> dict[str, Any]:
        await live.send_json({"type": "do", "id": ident, "boat": 1, "what": "route", "with": GOAL})
        return await answer(live)

    first = await told("a")
    assert (first["ok"], first["result"]["time_s"]) == (True, None)
    assert (first["result"]["length_m"], first["result"]["clearance_m"]) == (100.0, 4.0)
    assert asked == [(Place(lat=1, lon=2), Place(lat=1.0, lon=2.5), {"features": []})]
    server.boats.change(cruise_m_s=2.0)
    assert (await told("b"))["result"]["time_s"] == 50.0
    last = await told("c")
    assert (last["ok"], last["text"], last["result"]) == (
        False,
        "ashore",
        {"nearest": {"lat": 3.0, "lon": 4.0}},
    )


async def test_only_a_few_searches_wait_at_once(server: Server) -> None:
    service = RouteService(server.boats, server.hub.chart)
    told = [ask(service, GOAL) for _ in range(5)]
    assert [len(one) for one in told] == [0, 0, 0, 0, 1]
    assert told[4][0].key == "answer.ways_busy"
    await until(lambda: all(told))
    assert [one[0].ok for one in told] == [True] * 4 + [False]
    assert ask(service, GOAL) == []
