"""The boat's program on its simulated computer: it runs while there is power, and begins anew after that."""

from collections.abc import Callable

from companion.boat import Boat
from sitl.world.world import World


class Program:
    """One `Boat` after another over the same world.

    build: makes a boat from what survives a power cut. let_go: takes its links and threads from one that is
    no more; nothing is stored on the way, as nothing is when the power goes. host_load: the share of a tick
    that the program takes on the host, reported as the boat's own load unless the simulated one is higher.
    """

    __slots__ = ("_boots", "_build", "_computer", "_is_running", "_let_go", "_world", "boat", "host_load")

    def __init__(self, world: World, build: Callable[[], Boat], let_go: Callable[[Boat], None]) -> None:
        self.boat = build()
        self._world = world
        self._computer = world.electronics.computer
        self._build = build
        self._let_go = let_go
        self._boots = self._computer.boots
        self._is_running = True
        self.host_load = 0.0

    @property
    def is_running(self) -> bool:
        """Whether there is a boat to talk to."""
        return self._is_running

    def step(self) -> None:
        """One tick of the boat, if there is power."""
        computer = self._computer
        if not computer.has_power:
            self._end()
            return
        if computer.boots != self._boots:
            self._end()
            self.boat = self._build()
            self._boots, self._is_running = computer.boots, True
        boat = self.boat
        boat.load = max(self.host_load, computer.load)
        boat.step(self._world.clock_s)
        if boat.wants_restart:
            computer.begin(self._world.time_s)

    def _end(self) -> None:
        if self._is_running:
            self._is_running = False
            self._let_go(self.boat)
