"""The boat's program on its simulated computer. It restarts when the power returns."""

from collections.abc import Callable

from companion.boat import Boat
from sitl.world.world import World


class Program:
    """One `Boat` after another in the same world.

    build: makes a boat from what survives a power cut. on_end: called after one, once the boat's links and
    threads are closed; nothing is stored. host_load: the share of a tick that the program takes on the
    host, reported as the boat's own load unless the simulated one is higher.
    """

    def __init__(
        self, world: World, build: Callable[[], Boat], on_end: Callable[[], None] = lambda: None
    ) -> None:
        self.boat = build()
        self._world = world
        self._computer = world.electronics.computer
        self._build = build
        self._on_end = on_end
        self._boots = self._computer.boots
        self.is_running = True  # there is a boat to talk to
        self.host_load = 0.0

    def step(self) -> None:
        """One tick of the boat, if there is power."""
        computer = self._computer
        if not computer.has_power:
            self._end()
            return
        if computer.boots != self._boots:
            self._end()
            self.boat = self._build()
            self._boots, self.is_running = computer.boots, True
        boat = self.boat
        boat.load = max(self.host_load, computer.load)
        boat.step(self._world.clock_s)
        if boat.wants_restart:
            computer.begin(self._world.time_s)

    def _end(self) -> None:
        if self.is_running:
            self.is_running = False
            self.boat.channels.close()
            self.boat.endpoint.close()
            self._on_end()
