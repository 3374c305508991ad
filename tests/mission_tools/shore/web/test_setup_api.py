"""The list of sensors over HTTP."""

import pytest
from shore_fakes import run, serving


def test_the_sensors_are_listed_without_a_pin() -> None:
    async def test() -> None:
        async with serving() as server, server.client.get("/api/boats/1/sensors") as response:
            assert response.status == 200
            (sensor,) = await response.json()
            assert (sensor["name"], sensor["verdict"], sensor["text"]) == ("gnss", "fine", "good")
            assert sensor["values"] == {"satellites": 12}

    run(test())


@pytest.mark.parametrize("path", ["/api/boats/7/sensors", "/api/boats/x/sensors", "/api/boats/1000/sensors"])
def test_a_boat_that_was_never_heard_has_no_sensors(path: str) -> None:
    async def test() -> None:
        async with serving() as server, server.client.get(path) as response:
            assert response.status == 404

    run(test())
