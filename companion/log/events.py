"""Log records of changes: mode, arming, home, items, failsafes."""

from collections.abc import Callable, Iterator, Sequence
from operator import attrgetter
from typing import Final

from companion import __version__
from companion.autopilot.snapshot import Snapshot
from companion.config.boat_config import BoatConfig
from companion.config.parameters import Parameters
from companion.core.geo import LatLon
from companion.core.modes import Mode
from companion.core.units import deg_to_e7
from companion.failsafe.table import Condition
from companion.log import records as r
from companion.log.samples import text, time_us
from companion.mavlink.items import MissionItem
from companion.vehicle.vehicle import Vehicle

# LogEvent, LogErrorSubsystem and their codes, with ArduPilot's numbers
_ARMED, _DISARMED, _SET_HOME = 10, 11, 25
_COMPASS, _RADIO, _BATTERY, _OPERATOR, _GNSS = 3, 5, 6, 8, 11
_RESOLVED = 0
_ERROR_CODES: Final = {_COMPASS: 4, _RADIO: 1, _BATTERY: 1, _OPERATOR: 1, _GNSS: 2}
_ORIGIN, _HOME = 0, 1
_ROVER = 1  # build type
_VERSION: Final = tuple(int(part) for part in __version__.split(".")[:3])


class EventWatch:
    """Remembers the logged state. A new one reports everything."""

    def __init__(self) -> None:
        self._mode: Mode | None = None
        self._armed: bool | None = None
        self._home: LatLon | None = None
        self._origin: LatLon | None = None
        self._seq = 0
        self._reason = ""
        self._errors: set[int] = set()

    def has_news(self, vehicle: Vehicle) -> bool:
        """Whether `changes` has records; called every tick."""
        progress = vehicle.progress
        return (
            vehicle.mode is not self._mode
            or vehicle.armed is not self._armed
            or vehicle.home is not self._home
            or progress.current_seq != self._seq
            or bool(progress.reached)
        )

    def changes(self, now: Snapshot, items: Callable[[], Sequence[MissionItem]]) -> Iterator[bytes]:
        """Changes that are logged at once."""
        vehicle = now.vehicle
        if vehicle.mode is not self._mode:
            self._mode = vehicle.mode
            yield r.MODE.pack(time_us(now.now_s), vehicle.mode, vehicle.mode, 0)
        if vehicle.armed is not self._armed:
            us, self._armed = time_us(now.now_s), vehicle.armed
            yield r.EV.pack(us, _ARMED if vehicle.armed else _DISARMED)
            yield r.ARM.pack(us, vehicle.armed, now.config.arming.check, 0, 0)
        if vehicle.home is not self._home and vehicle.home is not None:
            us, self._home = time_us(now.now_s), vehicle.home
            yield r.EV.pack(us, _SET_HOME)
            yield _place(us, _HOME, vehicle.home)
        if vehicle.progress.reached:
            for seq in vehicle.progress.reached:
                yield from text(time_us(now.now_s), f"Reached item {seq}")
        if vehicle.progress.current_seq != self._seq:
            self._seq = seq = vehicle.progress.current_seq
            held = items()
            if seq < len(held):
                yield command(r.MISE.pack, time_us(now.now_s), held, seq)

    def slow_changes(self, now: Snapshot) -> Iterator[bytes]:
        """Changes that are logged less often."""
        us = time_us(now.now_s)
        if now.command.reason != self._reason:
            self._reason = now.command.reason
            yield from text(us, f"Motors: {self._reason or 'running'}")
        if now.vehicle.frame is not None and now.vehicle.frame.origin is not self._origin:
            self._origin = now.vehicle.frame.origin
            yield _place(us, _ORIGIN, self._origin)
        errors = set(_errors(now))
        if errors != self._errors:
            for subsystem in sorted(errors ^ self._errors):
                yield r.ERR.pack(us, subsystem, _ERROR_CODES[subsystem] if subsystem in errors else _RESOLVED)
            self._errors = errors


def _errors(now: Snapshot) -> Iterator[int]:
    nav, limit_s = now.vehicle.nav, now.config.motors.estimate_timeout_s
    if nav is None or nav.heading_age_s > limit_s:
        yield _COMPASS
    if nav is None or nav.position_age_s > limit_s:
        yield _GNSS
    if now.vehicle.failsafes.pack_is_low:
        yield _BATTERY
    if now.vehicle.failsafes.is_active(Condition.OPERATOR_LOST):
        yield _OPERATOR
    if now.vehicle.failsafes.is_active(Condition.RC_LOST):
        yield _RADIO


def introduction(us: int) -> Iterator[bytes]:
    """Identification of the log. Readers take mode names from the build type and the word Rover."""
    major, minor, patch = _VERSION
    name = f"mavboat {__version__}"
    yield r.VER.pack(us, 0, 0, major, minor, patch, 255, 0, name.encode(), 0, _ROVER)
    yield from text(us, f"{name}, a boat after ArduPilot Rover's conventions")


def parameters(us: int, held: Parameters) -> Iterator[bytes]:
    """All parameters with their defaults."""
    for row in held.rows:
        yield r.PARM.pack(us, row.name.encode("ascii"), held.value(row), held.default(row))


def changed_parameters(us: int, held: Parameters, before: BoatConfig, after: BoatConfig) -> Iterator[bytes]:
    """The parameters that differ between two configurations."""
    for row in held.rows:
        if row.path and (value := attrgetter(row.path))(before) != value(after):
            yield r.PARM.pack(us, row.name.encode("ascii"), held.value(row), held.default(row))


def mission(us: int, items: Sequence[MissionItem]) -> Iterator[bytes]:
    for seq in range(len(items)):
        yield command(r.CMD.pack, us, items, seq)


def command(pack: Callable[..., bytes], us: int, items: Sequence[MissionItem], seq: int) -> bytes:
    item = items[seq]
    return pack(
        us, len(items), seq, item.command, item.param1, item.param2, item.param3, item.param4, item.x, item.y,
        item.z, item.frame,
    )  # fmt: skip


def _place(us: int, kind: int, place: LatLon) -> bytes:
    return r.ORGN.pack(us, kind, deg_to_e7(place.lat_deg), deg_to_e7(place.lon_deg), 0)
