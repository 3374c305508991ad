"""The emulator in real time: the boat behind TCP and UDP ports, for any ground station."""

import logging
from collections.abc import Callable, Collection, Sequence
from contextlib import ExitStack
from pathlib import Path

import msgspec

from companion.app import open_log, open_ports, open_storage
from companion.boat import TICK_S, Boat
from companion.clock import Clock
from companion.config import BoatConfig, LinkConfig
from companion.mavlink.signing import timestamp_at
from companion.runner import Runner
from companion.status_file import StatusFile
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
        self._clock = clock
        self._unix_offset_s = unix_offset_s
        self._record = record  # a trajectory grows for as long as the boat runs
        with ExitStack() as undo:
            storage = open_storage(state_folder)
            undo.callback(storage.close)
            ports = open_ports(links, clock.now_s)
            for port in ports:
                undo.callback(port.close)
            self.port_names = [port.name for port in ports]
            self.world = World(scenario)
            config = stretched(scenario.vehicle, speedup)
            logbook = open_log(config, state_folder)
            self.boat = Boat(config, self.world.hardware, ports, storage, logbook=logbook)
            undo.pop_all()
        self._status = StatusFile(status_path, self.boat.channels) if status_path is not None else None
        self._runner = Runner(
            clock,
            TICK_S / speedup,
            self._step,
            self._receive,
            self.boat.channels.filenos,
            skip_missed=False,
            has_more=lambda: self.boat.channels.has_more,
        )
        if logbook is not None and logbook.onboard is not None:
            logbook.onboard.timing = self._runner.ticks

    def run(self, should_stop: Callable[[], bool]) -> None:
        """Run until told to stop, or until the boat `wants_restart`; then close everything."""
        try:
            self._runner.run(lambda: should_stop() or self.boat.wants_restart)
        finally:
            self.boat.close()
            if self._status is not None:
                self._status.close()

    def _step(self, _: int) -> None:
        if self._unix_offset_s:  # the simulated receiver has a day of its own, and stations live today
            self.boat.signing.stamps.follow(timestamp_at(self._clock.now_s() + self._unix_offset_s))
        self.boat.load = self._runner.load
        self.boat.step(self.world.time_s)
        if self._status is not None:
            self._status.tick(self.world.time_s, self._runner.ticks, self._runner.load)
        truth = self.world.step(TICK_S)
        if self._record:
            self.recorder.record(truth, NO_LEG)

    def _receive(self, ready: Collection[int]) -> int:
        return self.boat.receive(self.world.time_s, ready)


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
