"""A whole boat that fuzz targets talk to: fresh for each input, so that each input tells its whole story."""

import math
from collections.abc import Iterable
from functools import cache

from companion.boat import TICK_S, Boat
from companion.core.storage import MemoryStorage
from companion.links.memory import MemoryPort, memory_pair
from sitl.scenarios.scenario import load_scenario
from sitl.world.scenario import Scenario
from sitl.world.world import World

_QUEUE_FRAMES = 20_000


@cache
def _scenario() -> Scenario:
    return load_scenario("open", (), None)


def hear(frames: Iterable[bytes], ticks: int = 3) -> None:
    """Let a boat hear frames one by one, with some ticks before and after.

    Raises:
        AssertionError: a fault that the boat caught, a frame that does not pack, motors that are no number.
    """
    scenario = _scenario()
    world = World(scenario)
    near, far = memory_pair("fuzz", queue_frames=_QUEUE_FRAMES)
    boat = Boat(scenario.vehicle, world.hardware, [MemoryPort(near)], MemoryStorage())
    try:
        _step(boat, world, ticks)
        for number, frame in enumerate(frames):
            far.send(frame)
            boat.receive(world.time_s)
            if number % 8 == 7:
                _step(boat, world, 1)
        _step(boat, world, ticks)
        assert boat.endpoint.faults == 0, "the endpoint caught a fault"
        assert all(channel.faults == 0 for channel in boat.channels.open.values()), "a message did not pack"
        assert math.isfinite(boat.command.left + boat.command.right)
        assert len(far.receive()) < _QUEUE_FRAMES, "a flood of answers"
    finally:
        boat.close()


def _step(boat: Boat, world: World, ticks: int) -> None:
    for _ in range(ticks):
        boat.step(world.time_s)
        world.step(TICK_S)
