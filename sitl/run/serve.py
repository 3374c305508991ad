"""The emulator in real time: boats behind TCP and UDP ports, for any ground station."""

from collections.abc import Callable, Collection, Sequence
from operator import attrgetter

from companion.app.runner import Clock, Runner
from companion.boat import TICK_S
from companion.config.boat_config import BoatConfig, with_value
from sitl.run.simulated_boat import SimulatedBoat

PHASES = round(1.0 / TICK_S)  # ticks over which once-a-second work is spread
RECORD_EVERY = 5  # ticks between two rows of a written trajectory: ten a second
_OF_STATIONS_S = (
    "failsafe.gcs_timeout_s",
    "failsafe.manual_timeout_s",
    "mavlink.retry_s",
    "modes.set_point_timeout_s",
    "follow.timeout_s",
    "external.timeout_s",
    "arming.repeat_s",
)
MEMORY = -1  # the descriptor of links that have none: those between boats of one process


class Server:
    """Boats in step with the wall clock times `speedup`."""

    def __init__(
        self,
        boats: Sequence[SimulatedBoat],
        clock: Clock,
        speedup: float = 1.0,
        report: Callable[[str], None] = lambda line: None,
    ) -> None:
        """boats: at least one. report: called with one line if the host cannot keep up with `speedup`."""
        self.boats = tuple(boats)
        self._clock = clock
        self._pace = SpeedMonitor(speedup, report)
        self._by_fileno: dict[int, SimulatedBoat] = {}
        self._runner = Runner(
            clock,
            TICK_S / speedup,
            self._step,
            self._receive,
            self._filenos,
            skip_missed=False,
            has_more=lambda: any(boat.has_more for boat in self.boats),
        )
        for boat in self.boats:
            boat.time_ticks(self._runner)

    @property
    def load(self) -> float:
        """Share of the time that the boats take."""
        return self._runner.load

    @property
    def wants_restart(self) -> bool:
        """Whether a single boat was asked to restart; each of several restarts by itself."""
        return len(self.boats) == 1 and self.boats[0].boat.wants_restart

    def run(self, should_stop: Callable[[], bool]) -> None:
        """Run until told to stop, or until the boat `wants_restart`; then close everything."""
        try:
            self._runner.run(lambda: should_stop() or self.wants_restart)
        finally:
            for boat in self.boats:
                boat.close()

    def _step(self, number: int) -> None:
        for place, boat in enumerate(self.boats):
            # One more boat every tick, so that their once-a-second work falls into different ticks
            if place % PHASES <= number:
                boat.step(self._runner, len(self.boats))
        self._pace.tick(self._clock.now_s(), TICK_S)

    def _filenos(self) -> list[int]:
        if len(self.boats) == 1:
            return self.boats[0].filenos()
        self._by_fileno = {number: boat for boat in self.boats for number in boat.filenos()}
        return sorted(self._by_fileno)

    def _receive(self, ready: Collection[int]) -> int:
        if len(self.boats) == 1:
            return self.boats[0].receive(ready)
        heard = {self._by_fileno[number] for number in ready if number in self._by_fileno}
        taken = sum(boat.receive(ready) for boat in self.boats if boat in heard or boat.has_more)
        if taken:
            # What one boat has passed on to another over memory is answered before the next tick, too
            for boat in (*self.boats, self.boats[0]):
                boat.receive((MEMORY,))
        return taken


def stretched(config: BoatConfig, speedup: float) -> BoatConfig:
    """The configuration with timeouts of stations multiplied by speedup, as stations use the wall clock."""
    for path in _OF_STATIONS_S:
        config = with_value(config, path, attrgetter(path)(config) * speedup)
    return config


WINDOW_S = 5.0  # of wall-clock time; shorter pauses of a busy host even out
SLOW_SHARE = 0.8  # of the speed asked for; above it the voyage takes at most a quarter longer


class SpeedMonitor:
    """Compares simulated time with the clock, window by window, and calls `report` at most once.

    The emulator skips no tick, so on a busy host simulated time runs slower. The boat itself cannot notice.
    """

    def __init__(self, speedup: float, report: Callable[[str], None]) -> None:
        """report: called with one line for the user."""
        self._speedup = speedup
        self._report = report
        self._is_reported = False
        self._began_s: float | None = None
        self._simulated_s = 0.0

    def tick(self, now_s: float, tick_s: float) -> None:
        """Another tick of simulated time has passed; now_s: the host's clock."""
        if self._is_reported:
            return
        if self._began_s is None:
            self._began_s = now_s
        self._simulated_s += tick_s
        elapsed_s = now_s - self._began_s
        if elapsed_s < WINDOW_S:
            return
        reached = self._simulated_s / elapsed_s
        if reached < SLOW_SHARE * self._speedup:
            self._is_reported = True
            self._report(
                f"this computer is too slow or too busy for {self._speedup:g} × real time: simulated time "
                f"runs at {reached:.2g} × and everything takes longer; the boat itself is not affected"
            )
        self._began_s, self._simulated_s = now_s, 0.0
