"""One simulated boat in real time: world, computer, disk, links and program."""

from collections.abc import Callable, Collection, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path

import msgspec

from companion.app.composition import open_log, open_ports
from companion.app.runner import Clock, Runner
from companion.app.status_file import StatusFile
from companion.boat import TICK_S, Boat
from companion.config.boat_config import LinkConfig
from companion.core.storage import FolderStorage, MemoryStorage, Storage
from companion.links.interfaces import Port
from companion.log.logbook import Logbook
from companion.mavlink.signing import timestamp_at
from companion.router.policy import ConfiguredPort
from companion.vehicle import voyage_record as resume
from sitl.run.air import Air, AirPort
from sitl.run.program import Program
from sitl.run.recording.recorder import NO_LEG, Recorder
from sitl.world.computer import Disk, file_writer
from sitl.world.scenario import Scenario
from sitl.world.world import World


@dataclass(frozen=True, slots=True)
class BoatOptions:
    """Storage and extra links of a boat. ports: open links to other boats of the process.

    unix_offset_s: added to the clock for today's date, where links are signed.
    """

    state_folder: str = ""
    record: bool = False
    status_path: Path | None = None
    unix_offset_s: float = 0.0
    ports: tuple[Callable[[], Port], ...] = ()


class SimulatedBoat:
    """One boat. `step` is one tick of program and world; `receive` reads the links."""

    def __init__(
        self,
        scenario: Scenario,
        links: Sequence[str | LinkConfig],
        clock: Clock,
        options: BoatOptions | None = None,
    ) -> None:
        """Open the ports.

        Raises ConfigError, LinkError: a url that cannot be read, or that the system refuses; StorageError:
        the folder cannot be used.
        """
        self._options = options = options or BoatOptions()
        self.recorder = Recorder()  # of the truth, if options.record
        self.world = World(scenario)
        self._clock = clock
        self._links = [LinkConfig(url=link) if isinstance(link, str) else link for link in links]
        self._config = scenario.vehicle
        self._status: StatusFile | None = None
        self._logbook: Logbook | None = None
        computer = self.world.electronics.computer
        self._air = Air(scenario.link, scenario.seed, computer, lambda: self.world.time_s)
        self._storage: Storage = Disk(MemoryStorage(), computer)
        if options.state_folder:
            folder = Path(options.state_folder).expanduser()
            self._storage = FolderStorage(folder, file_writer(computer))
        with ExitStack() as undo:
            undo.callback(self._storage.close)
            self._program = Program(self.world, self._build, self._close_files)
            undo.pop_all()
        self.port_names = [link.url for link in self._links]

    @property
    def boat(self) -> Boat:
        """The boat's program; another one after a power cut."""
        return self._program.boat

    @property
    def has_more(self) -> bool:
        """Whether `receive` left data unread."""
        return self._program.is_running and self.boat.channels.has_more

    def step(self, runner: Runner, boats: int = 1) -> None:
        """One tick. boats: how many share the runner; each one's computer would have only itself to run."""
        boat = self.boat
        if self._options.unix_offset_s:  # the simulated receiver has a date of its own
            boat.signing.stamps.follow(timestamp_at(self._clock.now_s() + self._options.unix_offset_s))
        # A host that cannot keep up stretches the emulator's time; the emulated computer does not overrun
        self._program.host_load = min(runner.load / boats, 1.0)
        self._program.step()
        if self.boat is not boat:
            self.time_ticks(runner)
        if self._status is not None and self._program.is_running:
            self._status.tick(self.world.time_s, runner.ticks, runner.load)
        truth = self.world.step(TICK_S)
        if self._options.record:
            self.recorder.record(truth, NO_LEG)

    def time_ticks(self, runner: Runner) -> None:
        """Connect the loop's timing to the boat's log."""
        if self._logbook is not None and self._logbook.onboard is not None:
            self._logbook.onboard.timing = runner.ticks

    def filenos(self) -> list[int]:
        """Descriptors that become readable when there is something to do."""
        return self.boat.channels.filenos() if self._program.is_running else []

    def receive(self, ready: Collection[int]) -> int:
        """Read the links; returns the number of frames."""
        return self.boat.receive(self.world.clock_s, ready) if self._program.is_running else 0

    def close(self) -> None:
        """Close everything. Unlike after a power cut, the next start does not resume a mission."""
        self._storage.save(resume.FILE, b"")
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
            self._logbook = logbook = open_log(self._config, self._options.state_folder)
            own_ports = [*aired, *(open_port() for open_port in self._options.ports)]
            boat = Boat(self._config, self.world.hardware, own_ports, self._storage, logbook=logbook)
            undo.pop_all()
        if self._options.status_path is not None:
            self._status = StatusFile(self._options.status_path, boat)
        return boat

    def _close_files(self) -> None:
        if self._logbook is not None:
            self._logbook.close()
        if self._status is not None:
            self._status.close()
