"""What a vehicle says is taken in, whatever it says."""

import asyncio
import io
import json
from collections.abc import AsyncIterator
from typing import Any, cast

import shapely

from companion.core.geo import LatLon, LocalFrame
from mission_tools.maps.chart import build_chart
from mission_tools.mission.mission import Mission
from mission_tools.vehicle.follow import Lookout
from mission_tools.vehicle.vehicle import Vehicle
from mission_tools.watch.watcher import Watcher
from mission_tools.wording import Printer

HERE = {"lat": 500000000, "lon": 100000000, "hdg": 0}
RANGES = {"distances": [300], "increment": 5, "min_distance": 20, "max_distance": 500}


class TalkingVehicle:
    """Says what it is given."""

    def __init__(self, said: list[object]) -> None:
        self._said = said

    async def messages(self, name: str) -> AsyncIterator[str]:
        for fields in self._said:
            yield json.dumps(fields)


def hear(watcher: Watcher, name: str, *said: object) -> None:
    lookout = Lookout(cast(Vehicle, TalkingVehicle([*said])), watcher, Printer(io.StringIO()), lambda: 0.0)
    asyncio.run(lookout.hear(name))


class RecordingWatcher(Watcher):
    """Keeps what it took in without an error."""

    def take(self, name: str, fields: Any, now_s: float) -> None:  # noqa: ANN401  as JSON has it
        super().take(name, fields, now_s)
        self.taken = fields


def test_messages_that_make_no_sense_do_not_end_the_listening() -> None:
    chart = build_chart("pond", LocalFrame(LatLon(50.0, 10.0)), shapely.box(-50, -50, 50, 50), ())
    watcher = RecordingWatcher(chart, Mission(()), 2.0)
    hear(watcher, "GLOBAL_POSITION_INT", {}, [], None, HERE | {"lat": 10**12}, HERE | {"hdg": None}, HERE)
    assert watcher.taken == HERE
    wrong = ({"frame": float("inf")}, {"min_distance": float("nan")}, {"distances": None}, {"increment": "5"})
    hear(watcher, "OBSTACLE_DISTANCE", *(RANGES | one for one in wrong), RANGES)
    assert watcher.taken == RANGES
