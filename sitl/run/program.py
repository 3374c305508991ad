"""The boat's program on its simulated computer. It restarts when the power returns."""

from collections.abc import Callable

from companion.boat import Boat
from sitl.world.world import World


class Program:
    """One `Boat` after another in the same world.

    build: makes a boat from what survives a power cut. close_program: closes the links and threads of a boat
    after a power cut, without storing anything. host_load: the share of a tick that the program takes on the
    host, reported as the boat's own load unless the simulated one is higher.
    """

    def __init__(
        self, world: World, build: Callable[[], Boat], close_program: Callable[[Boat], None]
    ) -> None:
        self.boat = build()
        self._world = world
        self._computer = world.electronics.computer
        self._build = build
        self._close_program = close_program
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
            self._close_program(self.boat)
