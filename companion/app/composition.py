"""The composition root: puts the boat together, and runs it."""

import logging
import os
from collections.abc import Callable, Collection, Sequence
from contextlib import ExitStack
from functools import partial
from pathlib import Path

from companion.app import garbage_collection as garbage
from companion.app.hardware import open_hardware
from companion.app.needs import check_needs
from companion.app.process import ServiceNotifier, only_program
from companion.app.runner import Runner, SystemClock
from companion.app.status_file import StatusFile, status_path
from companion.boat import COMPONENT_ID, TICK_S, Boat
from companion.config.board import read_model
from companion.config.boat_config import BoatConfig, LinkConfig
from companion.config.tuning import Rc
from companion.core.errors import ConfigError, StorageError
from companion.core.status_text import Severity
from companion.core.storage import FolderStorage, MemoryStorage, Storage
from companion.hal.interfaces import Hardware
from companion.links.interfaces import Port
from companion.links.port_url import open_port, parse_port_url
from companion.links.retried import PACE, Pace, RetriedPort, await_first
from companion.log.logbook import Logbook, open_logbook
from companion.mavlink.framing import begins_with_frame
from companion.mavlink.signing_key import read_key_file
from companion.router.policy import ConfiguredPort, Policy
from companion.sensors.external import Use

logger = logging.getLogger(__name__)

Now = Callable[[], float]

_MEMORY_EVERY = 50  # ticks between two looks at the computer's memory

# where stale frames are to be dropped they wait in the channel, which knows their age, not in the driver
_SHORT_QUEUE_BYTES = 512


def check_config(config: BoatConfig, model: str | None = None) -> None:
    """What can be said without hardware; a ConfigError names the key. model: default: of this computer."""
    for policy in policies_of(config.link_settings):
        if policy.setting.signing != "off" and policy.setting.key_file:
            read_key_file(Path(policy.setting.key_file).expanduser())
    if not config.links:
        raise ConfigError("links: a boat without a link cannot be reached; expected at least one")
    parts, external = config.parts, config.external
    if parts.motors.driver == "none":
        raise ConfigError("parts.motors.driver: the boat cannot sail without; expected a driver")
    if config.drive.has_rudder is not (parts.rudder.driver != "none"):
        raise ConfigError(
            f"parts.rudder.driver: drive.layout is {config.drive.layout!r}; expected a rudder in both or none"
        )
    if parts.compass.driver == "gnss" and parts.gnss.driver not in ("ubx", "nmea"):
        raise ConfigError(
            f"parts.compass.driver: 'gnss' needs parts.gnss.driver 'ubx' or 'nmea', not {parts.gnss.driver!r}"
        )
    for name, driver, use in (
        ("gnss", parts.gnss.driver, external.position),
        ("compass", parts.compass.driver, external.heading),
    ):
        if driver == "none" and use == Use.NEVER:
            raise ConfigError(
                f"parts.{name}.driver: the boat cannot sail without; expected a driver, or [external] instead"
            )
    if parts.battery.driver == "esc" and parts.motors.protocol == "none":
        raise ConfigError(
            "parts.battery.driver = 'esc': expected parts.motors.telemetry = 'kiss' or 'vesc', not 'none'"
        )
    if parts.depth.driver == "gnss" and parts.gnss.driver != "nmea":
        raise ConfigError(
            f"parts.depth.driver = 'gnss': expected parts.gnss.driver = 'nmea', not {parts.gnss.driver!r}"
        )
    check_autopilot(config)
    check_channels(config.rc)
    check_needs(config, read_model() if model is None else model)


def check_autopilot(config: BoatConfig) -> None:
    """What the parts behind an autopilot need of each other; a ConfigError names the key."""
    fitted = {name: getattr(config.parts, name) for name in config.parts.__struct_fields__} | {
        "rc": config.rc
    }
    behind = [name for name, part in fitted.items() if getattr(part, "driver", "") == "autopilot"]
    if behind and not config.parts.autopilot_part.url:
        raise ConfigError(f"parts.autopilot: {behind[0]} is behind it; expected its port url")
    if config.parts.autopilot_part.component == COMPONENT_ID:
        raise ConfigError(
            f"parts.autopilot.component = {COMPONENT_ID}: expected another than the boat's own, such as 25"
        )
    if "motors" not in behind:
        if "rudder" in behind:
            raise ConfigError("parts.rudder.driver = 'autopilot': expected parts.motors.driver = 'autopilot'")
        return
    if config.drive.layout == "differential_rudder" or (config.drive.has_rudder and "rudder" not in behind):
        raise ConfigError(
            "parts.motors.driver = 'autopilot': expected two motors, or one and a rudder, also behind it"
        )
    if "rc" in behind:
        raise ConfigError(
            "rc.driver = 'autopilot': motors behind it override the transmitter's channels; expected a "
            "receiver on this computer"
        )


def check_channels(setting: Rc) -> None:
    """No two things on one channel of the transmitter; a ConfigError names the key."""
    taken: dict[int, str] = {}
    for key in ("steering_channel", "throttle_channel", "arm_channel", "mode_channel"):
        channel = getattr(setting, key)
        if channel and channel in taken:
            raise ConfigError(f"rc.{key} = {channel}: expected another than rc.{taken[channel]}")
        taken[channel] = key


def policy_of(link: LinkConfig, key: str) -> Policy:
    """The rules of one link. A ConfigError names the url, or the key with a message that does not exist."""
    url = parse_port_url(link.url)
    is_loopback = url.place in ("localhost", "::1") or url.place.startswith("127.")
    baud = url.number if url.kind == "serial" else 0
    return Policy(link, key, baud, is_loopback, accepts_any_source=url.kind == "udpin")


def policies_of(links: Sequence[LinkConfig]) -> list[Policy]:
    """The rules of all links, as `policy_of`."""
    return [policy_of(link, f"links[{number}]") for number, link in enumerate(links)]


def open_ports(links: Sequence[LinkConfig], now: Now) -> list[Port]:
    """Open every link of a configuration, or none; a ConfigError or LinkError names the url."""
    with ExitStack() as undo:
        ports: list[Port] = []
        for policy in policies_of(links):
            ports.append(ConfiguredPort(_open_link(policy, now), policy))
            undo.callback(ports[-1].close)
        undo.pop_all()
    return ports


def retry_links(policies: Sequence[Policy], now: Now, pace: Pace = PACE) -> list[RetriedPort]:
    """Begin to open every link; those that can be opened are open on return."""
    with ExitStack() as undo:
        ports: list[RetriedPort] = []
        for policy in policies:
            opening = partial(_open_link, policy, now)
            ports.append(RetriedPort(str(parse_port_url(policy.setting.url)), opening, pace))
            undo.callback(ports[-1].close)
            ports[-1].start()
        await_first(ports, pace)
        undo.pop_all()
    return ports


def _open_link(policy: Policy, now: Now) -> Port:
    queue_bytes = _SHORT_QUEUE_BYTES if policy.stale_s else None
    port = open_port(policy.setting.url, now, queue_bytes, begins_with_frame)
    logger.info("listening on %s", port.name)
    return port


def open_storage(folder: str) -> Storage:
    """Memory that survives, or memory that does not when no folder is named. StorageError: it is unusable."""
    return FolderStorage(Path(folder).expanduser()) if folder else MemoryStorage()


def open_log(config: BoatConfig, folder: str) -> Logbook | None:
    """The boat's logbook beside what it stores; none without a folder. StorageError: it is unusable."""
    setting = config.log
    if not folder:
        return None
    return open_logbook(
        Path(folder).expanduser(),
        quota_mb=setting.quota_mb,
        min_free_mb=setting.min_free_mb,
        keeps_telemetry=setting.tlog,
    )


def run_boat(
    config: BoatConfig,
    should_stop: Callable[[], bool],
    clock: SystemClock | None = None,
    open_parts: Callable[[BoatConfig, Now], Hardware] = open_hardware,
) -> Boat:
    """Run the boat until told to stop, or until it `wants_restart`.

    Parts and links that cannot be opened join the boat later. Whatever happens, the motors are off when this
    returns or raises. Raises ConfigError, StorageError: the boat could not be put together. LinkError: no
    link can be opened, and no service manager waits for one.
    """
    check_config(config)
    clock = clock or SystemClock()
    with ExitStack() as undo:
        undo.enter_context(only_program(config.storage.folder))
        hardware = open_parts(config, clock.now_s)
        undo.callback(hardware.close)
        storage = open_storage(config.storage.folder)
        undo.callback(storage.close)
        policies = policies_of(config.link_settings)
        links = retry_links(policies, clock.now_s)
        ports = [ConfiguredPort(link, policy) for link, policy in zip(links, policies, strict=True)]
        for port in ports:
            undo.callback(port.close)
        notifier = ServiceNotifier(os.environ)
        undo.callback(notifier.close)
        faults = [link.error for link in links if link.error is not None]
        if len(faults) == len(links) and not notifier.is_supervised:
            raise faults[0]
        logbook, log_faults = None, dict[str, str]()
        try:
            logbook = open_log(config, config.storage.folder)
        except StorageError as error:  # a card that has become read-only, or is full
            log_faults["log"] = str(error)
        boat = Boat(config, hardware, ports, storage, clock.unix_offset_s(), logbook)
        undo.callback(boat.close)
        boat.endpoint.texts.logs_texts = True
        for name, fault in log_faults.items():
            boat.vehicle.notify(Severity.WARNING, f"No {name}: {fault}")

        def missing() -> dict[str, str]:
            return {one.name: one.fault for one in (*hardware.retried, *links) if one.fault} | log_faults

        path = status_path(config)
        status = None if path is None else StatusFile(path, boat, missing)
        if status is not None:
            undo.callback(status.close)

        def step(number: int) -> None:
            boat.load = runner.load
            if number % _MEMORY_EVERY == 0:
                boat.free_memory_bytes = os.sysconf("SC_AVPHYS_PAGES") * os.sysconf("SC_PAGESIZE")
            now_s = clock.now_s()
            boat.step(now_s)
            if status is not None:
                status.tick(now_s, runner.ticks, runner.load)
            notifier.tick(now_s, f"{boat.vehicle.mode.name}, {'' if boat.vehicle.armed else 'dis'}armed")

        def receive(ready: Collection[int]) -> int:
            return boat.receive(clock.now_s(), ready)

        runner = Runner(
            clock, TICK_S, step, receive, boat.channels.filenos, has_more=lambda: boat.channels.has_more
        )
        if logbook is not None and logbook.onboard is not None:
            logbook.onboard.timing = runner.ticks
        garbage.settle()
        undo.callback(lambda: notifier.restarting() if boat.wants_restart else notifier.stopping())
        runner.run(lambda: should_stop() or boat.wants_restart)
        ticks = runner.ticks
        logger.info("stopped after %d ticks, %d late, %d skipped", ticks.run, ticks.late, ticks.skipped)
    return boat
