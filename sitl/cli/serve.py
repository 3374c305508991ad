"""`boat-sitl serve`: the boat in real time behind TCP and UDP."""

import logging
import shlex
import sys
from contextlib import closing, nullcontext
from pathlib import Path
from typing import Annotated

from companion.app import garbage_collection as garbage
from companion.app.process import Shutdown
from companion.app.runner import SystemClock
from companion.cli.command_line import Option, echo
from companion.cli.program_end import busy_port_explained
from companion.config.boat_config import LinkConfig
from companion.core.errors import BoatError, ConfigError
from companion.mavlink.signing import SigningPolicy
from sitl.cli.arguments import Case, Csv, Seed, Settings, Source, StartAt, scenario_from
from sitl.run.fleet import PORT_STEP, fleet, start_fleet
from sitl.run.serve import RECORD_EVERY, Server
from sitl.run.shore import LISTEN, ShorePage
from sitl.run.simulated_boat import BoatOptions, SimulatedBoat
from sitl.run.state_folder import NONE, default_folder, lock_folder


def serve(
    source: Source = "open",
    settings: Settings = None,
    case: Case = None,
    seed: Seed = None,
    start: StartAt = None,
    speedup: Annotated[float, Option(least=0.01, most=1000.0, help="times real time")] = 1.0,
    host: Annotated[str, Option(help="address that the TCP server listens on")] = "127.0.0.1",
    tcp: Annotated[int, Option(least=0, most=65535, help="TCP port; 0: the system's choice")] = 5760,
    no_tcp: Annotated[bool, Option("--no-tcp", help="no TCP server")] = False,
    udp: Annotated[str, Option(metavar="HOST:PORT", help="the station that UDP goes to")] = "127.0.0.1:14550",
    no_udp: Annotated[bool, Option("--no-udp", help="no UDP")] = False,
    link: Annotated[
        list[str] | None, Option(metavar="URL", help="a further link, as udpin:127.0.0.1:14560")
    ] = None,
    state: Annotated[
        str | None,
        Option(
            metavar="DIR",
            help="keep missions, parameters and logs here over restarts; none: forget them "
            "[a folder for scenario and TCP port under ~/.local/state/mavboat]",
        ),
    ] = None,
    sign_key: Annotated[
        Path | None, Option(metavar="FILE", help="sign what leaves by any link with this key")
    ] = None,
    signing: Annotated[
        SigningPolicy | None,
        Option(help="ask for signatures on every link [required with --sign-key, else off]"),
    ] = None,
    count: Annotated[
        int, Option(least=1, metavar="N", help="boats, with system ids and TCP ports counting up")
    ] = 1,
    one_port: Annotated[
        bool, Option("--one-port", help="all boats on the first one's links, which passes on for them")
    ] = False,
    csv: Csv = None,
    status: Annotated[
        Path | None, Option(metavar="FILE", help="write links and ticks in numbers here, as JSON")
    ] = None,
    shore: Annotated[
        bool, Option("--shore", help="serve the shore page too, a ground station for the browser")
    ] = False,
    shore_at: Annotated[
        str, Option(metavar="HOST:PORT", help="address of the shore page; port 0: the system's choice")
    ] = LISTEN,
    shore_options: Annotated[
        str, Option(metavar="TEXT", help="further options of boat-shore, as '--host pond.lan'")
    ] = "",
    verbose: Annotated[bool, Option("--verbose", "-v", help="log links coming and going")] = False,
) -> None:
    """Run the boat in real time until Ctrl-C, for QGroundControl, MAVProxy, MAVSDK and any other station.

    TCP on 5760 and UDP to 127.0.0.1:14550 by default. Nothing outside this machine can reach it unless
    --host, --udp or --link say so. Timers that wait for stations are stretched along with --speedup.

    Missions, parameters and logs outlive a restart; where, is said at the start. With --tcp 0 or --state none
    nothing is kept.

    With --count each boat has a TCP port of its own, 10 apart, and all of them talk to the one UDP station.
    Boats of a fleet neither see nor touch each other.

    With --shore a browser is all the ground station that you need: the page's address and its PIN are said at
    the start, and the page opens if there is a desktop.

    Example:  boat-sitl serve lake --speedup 5 --shore
    """
    logging.basicConfig(
        level=logging.INFO if verbose else logging.WARNING, format="%(levelname)s %(message)s"
    )
    scenario = scenario_from(source, settings, case, seed, start)
    scenarios = fleet(scenario, count)
    policy = signing or ("required" if sign_key is not None else "off")
    key_file = "" if sign_key is None else str(sign_key)
    links = [
        [
            LinkConfig(url=url, signing=policy, key_file=key_file)
            for url in _urls(number, None if no_tcp else (host, tcp), None if no_udp else udp, link, one_port)
        ]
        for number in range(count)
    ]
    shutdown = Shutdown()
    shutdown.install()
    folder, remark = _held_folder(state, default_folder(source, scenario.seed, None if no_tcp else tcp))
    extra, boat_file = _words(shore_options), scenario.boat_file
    page = ShorePage(scenario.chart, shore_at, _report, boat_file, extra) if shore else None
    with nullcontext() if page is None else closing(page):
        if page is not None:
            for own in links[: 1 if one_port else count]:
                own.append(LinkConfig(url=page.boat_link))
            status = status or page.status
        while True:
            clock = SystemClock()
            boat_options = [
                BoatOptions(
                    state_folder=""
                    if folder is None
                    else str(folder if count == 1 else folder / f"boat{number + 1}"),
                    record=csv is not None,
                    status_path=status if number == 0 else None,
                    unix_offset_s=0.0 if policy == "off" else clock.unix_offset_s(),
                )
                for number in range(count)
            ]
            with busy_port_explained("choose another port with --tcp (5770, or 0 for any free one)"):
                boats = start_fleet(scenarios, links, clock, boat_options, speedup)
            if page is not None and status is not None:
                page.start(status)
            server = Server(boats, clock, speedup, _report)
            names = _names(boats[0], page) or "no link"
            echo(f"boat-sitl: {scenario.title}, seed {scenario.seed}, {speedup:g} × real time, on {names}")
            for boat, sailed in zip(boats[1:], scenarios[1:], strict=True):
                names = _names(boat, page) or "the first boat's links"
                echo(f"boat-sitl: system {sailed.vehicle.identity.system_id} on {names}")
            echo(f"boat-sitl: {remark}")
            echo("boat-sitl: ready; Ctrl-C ends")
            sys.stdout.flush()
            garbage.settle()
            server.run(shutdown)
            if csv is not None:
                for boat, sailed in zip(boats, scenarios, strict=True):
                    number = sailed.vehicle.identity.system_id
                    path = csv if count == 1 else csv.with_stem(f"{csv.stem}_{number}")
                    boat.recorder.write_csv(path, every=RECORD_EVERY)
            if shutdown() or not server.wants_restart:
                return
            scenario = scenario_from(source, settings, case, seed, start)  # as its file is now
            scenarios = fleet(scenario, count)


def _held_folder(asked: str | None, usual: Path | None) -> tuple[Path | None, str]:
    """Where to store, if anywhere, and a line that says so.

    Raises StorageError, StateInUseError: a folder that was asked for cannot be used.
    """
    nothing = "missions, parameters and logs are forgotten at the end"
    if asked == NONE or (asked is None and usual is None):
        return None, f"{nothing} (--state DIR keeps them)"
    folder = Path(asked).expanduser() if asked is not None else usual
    assert folder is not None  # noqa: S101
    try:
        lock_folder(folder)
    except BoatError as error:
        if asked is not None:
            raise
        return None, f"{nothing}: {error}"
    return folder, f"missions, parameters and logs are kept in {folder} (--state none forgets them)"


def _words(options: str) -> list[str]:
    """As a shell divides them. Raises ConfigError: a quote is not closed."""
    try:
        return shlex.split(options)
    except ValueError as error:
        raise ConfigError(f"--shore-options: {error}") from None


def _report(line: str) -> None:
    echo(f"boat-sitl: {line}")
    sys.stdout.flush()


def _names(boat: SimulatedBoat, page: ShorePage | None) -> str:
    """The links of a boat, without the page's own."""
    return ", ".join(name for name in boat.port_names if page is None or name != page.boat_link)


def _urls(
    number: int, tcp: tuple[str, int] | None, udp: str | None, others: list[str] | None, one_port: bool
) -> list[str]:
    """One boat's links: TCP ports count up, all talk to one UDP station, others are the first boat's."""
    if number and one_port:
        return []
    urls = []
    if tcp is not None:
        host, port = tcp
        urls.append(f"tcpin:{host}:{port + PORT_STEP * number if port else 0}")
    if udp is not None:
        urls.append(f"udpout:{udp}")
    return urls if number else [*urls, *(others or [])]
