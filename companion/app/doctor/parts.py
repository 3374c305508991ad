"""Checks of the configured parts, one after the other, with their live readings."""

from collections.abc import Callable, Mapping
from contextlib import ExitStack, closing
from functools import partial
from shutil import which
from types import MappingProxyType
from typing import Any, Protocol

from companion.app import parts
from companion.app.clock import Clock
from companion.app.doctor.compass import check_compass_calibration
from companion.app.doctor.findings import Examined, Finding, Verdict
from companion.app.doctor.readings import in_words
from companion.app.status_file import RUNTIME_DIRECTORY, BoatStatus, find_status, read_status
from companion.config.boat_config import BoatConfig
from companion.config.parts.payload import CommandPayload
from companion.config.parts.probes import ProbePart
from companion.core.errors import BoatError
from companion.hal.interfaces import ReportingPart

_PATIENCE_S = (
    10.0  # for a first reading: a BNO055 starts in 0.7 s, a receiver without a fix speaks every second
)
_POLL_S = 0.1


class LivePart(Protocol):
    """What every open part can do."""

    def read(self) -> Any: ...  # noqa: ANN401 — each kind has a reading of its own
    def close(self) -> None: ...


Open = Callable[[BoatConfig, Callable[[], float]], LivePart]

# By the part's section: below `parts`, or of the file
PARTS: Mapping[str, Open] = MappingProxyType(
    {
        "gnss": parts.open_gnss,
        "compass": parts.open_compass,
        "sonar": parts.open_sonar,
        "battery": parts.open_battery,
        "hull": parts.open_hull_sensor,
        "depth": parts.open_depth,
        "rc": parts.open_rc,
    }
)


def driver_of(config: BoatConfig, name: str) -> str:
    """The driver of a part's section."""
    return str((getattr(config.parts, name, None) or getattr(config, name)).driver)


def check_part(name: str, open_part: Open, config: BoatConfig, clock: Clock, driver: str = "") -> Finding:
    """Open a part, wait for its first reading, and close it. driver: default: that of the section."""
    driver = driver or driver_of(config, name)
    if driver == "none":
        return Finding(name, Verdict.SKIPPED, "not fitted")
    try:
        part = open_part(config, clock.now_s)
    except BoatError as error:
        return Finding(name, Verdict.FAILED, str(error))
    give_up_s = clock.now_s() + _PATIENCE_S
    with closing(part):
        reading = part.read()
        while (reading is None or reading == []) and clock.now_s() < give_up_s:
            clock.sleep(_POLL_S)
            reading = part.read()
        texts = [one.text for one in part.take_texts()] if isinstance(part, ReportingPart) else []
    said = "".join(f"; {text}" for text in texts)
    if reading is None or reading == []:
        text = f"{driver}: no reading within {_PATIENCE_S:g} s{said}"
        return Finding(name, Verdict.FAILED, text, "check its supply, wires, port and baud rate")
    verdict, words = in_words(reading, config)
    return Finding(name, verdict, f"{driver}: {words}{said}")


def check_probes(config: BoatConfig, clock: Clock) -> list[Finding]:
    """Each probe, one after the other."""
    return [
        check_part(
            f"probe {one.name}",
            partial(_open_probe, one),
            config,
            clock,
            one.driver,
        )
        for one in config.probe
    ]


def _open_probe(part: ProbePart, config: BoatConfig, now: Callable[[], float]) -> LivePart:  # noqa: ARG001
    return parts.open_probe_group((part,), now)[0]


def check_payload(config: BoatConfig) -> Finding:
    """Open the payload's outputs, which puts them in their safe state, and look for the owner's programs."""
    if not config.payload:
        return Finding("payload", Verdict.SKIPPED, "not fitted")
    missing = [
        one.run[0] for one in config.payload if isinstance(one, CommandPayload) and not which(one.run[0])
    ]
    if missing:
        return Finding("payload", Verdict.FAILED, f"no such programs: {', '.join(missing)}")
    try:
        with ExitStack() as opened:
            for one in config.payload:
                if not isinstance(one, CommandPayload):
                    opened.enter_context(closing(parts.open_payload_output(one, config.parts.pca9685)))
    except BoatError as error:
        return Finding("payload", Verdict.FAILED, str(error))
    return Finding("payload", Verdict.FINE, ", ".join(one.title for one in config.payload))


def running_boat(examined: Examined) -> BoatStatus | None:
    """The status of the boat that uses the parts now, None without one."""
    try:
        status = read_status(find_status(examined.config, examined.target.path(RUNTIME_DIRECTORY)))
    except BoatError:
        return None
    return status if examined.path(f"/proc/{status.process}").exists() else None


def part_findings(examined: Examined, clock: Clock) -> list[Finding]:
    """All parts except the motors."""
    if (boat := running_boat(examined)) is not None:
        missing = [Finding(name, Verdict.FAILED, fault) for name, fault in boat.missing.items()]
        text = "the running boat uses " + ("the others" if missing else "them")
        return [*missing, Finding("parts", Verdict.SKIPPED, text, "sudo systemctl stop mavboat")]
    found = [check_part(name, open_part, examined.config, clock) for name, open_part in PARTS.items()]
    found += check_compass_calibration(examined)
    return [*found, *check_probes(examined.config, clock), check_payload(examined.config)]
