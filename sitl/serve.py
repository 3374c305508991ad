"""The emulator in real time: the boat behind TCP and UDP ports, for any ground station."""

import logging
from collections.abc import Callable, Collection, Sequence
from contextlib import ExitStack
from pathlib import Path

import msgspec

from companion.app import open_log, open_ports
from companion.boat import TICK_S, Boat
from companion.clock import Clock
from companion.config import BoatConfig, LinkConfig
from companion.hal.interfaces import Port
from companion.log.logbook import Logbook
from companion.mavlink.signing import timestamp_at
from companion.router.configured_port import ConfiguredPort
from companion.runner import Runner
from companion.status_file import StatusFile
from companion.storage import FolderStorage, MemoryStorage, Storage
from sitl.computer import Computer
from sitl.disk import Disk, file_writer
from sitl.link import Air, AirPort
from sitl.program import Program
from sitl.recorder import NO_LEG, Recorder
from sitl.scenario import Scenario
from sitl.world import World

logger = logging.getLogger(__name__)

RECORD_EVERY = 5  # ticks between two rows of a written trajectory: ten a second


class Server:
    """One boat in its water, in step with the wall clock times `speedup`."""

    def __init__(
        self,
        scenario: Scenario,
        links: Sequence[str | LinkConfig],
        clock: Clock,
        *,
        speedup: float = 1.0,
        state_folder: str = "",
        record: bool = False,
        status_path: Path | None = None,
        unix_offset_s: float = 0.0,
    ) -> None:
        """Open the ports. unix_offset_s: what to add to the clock for today's date, where links are signed.

        Raises:
            ConfigError, LinkError: a url that cannot be read, or that the system refuses.
            StorageError: the folder cannot be used.
        """
        self.recorder = Recorder()
        self.world = World(scenario)
        self._clock = clock
        self._unix_offset_s = unix_offset_s
        self._record = record  # a trajectory grows for as long as the boat runs
        self._links = [LinkConfig(url=link) if isinstance(link, str) else link for link in links]
        self._config = stretched(scenario.vehicle, speedup)
        self._state_folder = state_folder
        self._status_path = status_path
        self._status: StatusFile | None = None
        self._logbook: Logbook | None = None
        computer = self.world.electronics.computer
        self._air = Air(scenario.link, scenario.seed, computer, lambda: self.world.time_s)
        self._storage = _open_storage(state_folder, computer)
        with ExitStack() as undo:
            undo.callback(self._storage.close)
            self._program = Program(self.world, self._build, self._let_go)
            undo.pop_all()
        self.port_names = [link.url for link in self._links]
        self._runner = Runner(
            clock,
            TICK_S / speedup,
            self._step,
            self._receive,
            self._filenos,
            skip_missed=False,
            has_more=lambda: self.boat.channels.has_more,
        )
        self._time_ticks()

    @property
    def boat(self) -> Boat:
        """The boat's program; another one after a power cut."""
        return self._program.boat

    def run(self, should_stop: Callable[[], bool]) -> None:
        """Run until told to stop, or until the boat `wants_restart`; then close everything."""
        try:
            self._runner.run(lambda: should_stop() or self.boat.wants_restart)
        finally:
            self.boat.close()
            if self._status is not None:
                self._status.close()

    def _build(self) -> Boat:
        """Open everything that ends with the program. A port that the system has chosen is kept."""
        with ExitStack() as undo:
            ports = open_ports(self._links, self._clock.now_s)
            for port in ports:
                undo.callback(port.close)
            self._links = [
                msgspec.structs.replace(link, url=port.name)
                for link, port in zip(self._links, ports, strict=True)
            ]
            aired: list[Port] = [
                ConfiguredPort(AirPort(port, self._air), port.policy)
                for port in ports
                if isinstance(port, ConfiguredPort)
            ]
            self._logbook = logbook = open_log(self._config, self._state_folder)
            boat = Boat(self._config, self.world.hardware, aired, self._storage, logbook=logbook)
            undo.pop_all()
        if self._status_path is not None:
            self._status = StatusFile(self._status_path, boat.channels)
        return boat

    def _let_go(self, boat: Boat) -> None:
        boat.channels.close()
        boat.endpoint.close()
        if self._logbook is not None:
            self._logbook.close()
        if self._status is not None:
            self._status.close()

    def _time_ticks(self) -> None:
        if self._logbook is not None and self._logbook.onboard is not None:
            self._logbook.onboard.timing = self._runner.ticks

    def _step(self, _: int) -> None:
        boat = self.boat
        if self._unix_offset_s:  # the simulated receiver has a day of its own, and stations live today
            boat.signing.stamps.follow(timestamp_at(self._clock.now_s() + self._unix_offset_s))
        boat.load = self._runner.load
        self._program.step()
        if self.boat is not boat:
            self._time_ticks()
        if self._status is not None and self._program.is_running:
            self._status.tick(self.world.time_s, self._runner.ticks, self._runner.load)
        truth = self.world.step(TICK_S)
        if self._record:
            self.recorder.record(truth, NO_LEG)

    def _filenos(self) -> list[int]:
        return self.boat.channels.filenos() if self._program.is_running else []

    def _receive(self, ready: Collection[int]) -> int:
        return self.boat.receive(self.world.clock_s, ready) if self._program.is_running else 0


def _open_storage(folder: str, computer: Computer) -> Storage:
    """Memory that survives the program, or memory that survives power cuts alone when no folder is named.

    Raises:
        StorageError: the folder cannot be used.
    """
    if folder:
        return FolderStorage(Path(folder).expanduser(), file_writer(computer))
    return Disk(MemoryStorage(), computer)


def stretched(config: BoatConfig, speedup: float) -> BoatConfig:
    """The configuration with the timers that wait for people and programs stretched.

    They live by the wall clock: a heartbeat a second is one in `speedup` seconds of the boat's time.
    """
    replace = msgspec.structs.replace
    failsafe = replace(
        config.failsafe,
        gcs_timeout_s=config.failsafe.gcs_timeout_s * speedup,
        manual_timeout_s=config.failsafe.manual_timeout_s * speedup,
    )
    mavlink = replace(
        config.mavlink,
        retry_s=config.mavlink.retry_s * speedup,
        item_retry_s=config.mavlink.item_retry_s * speedup,
    )
    modes = replace(config.modes, set_point_timeout_s=config.modes.set_point_timeout_s * speedup)
    follow = replace(config.follow, timeout_s=config.follow.timeout_s * speedup)
    external = replace(config.external, timeout_s=config.external.timeout_s * speedup)
    return replace(config, failsafe=failsafe, mavlink=mavlink, modes=modes, follow=follow, external=external)
