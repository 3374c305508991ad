"""State of the voyage on disk, restored after a power cut.

A record is written when mode, arming or item change, and periodically along a leg, outside the control loop.
"""

import hashlib
import logging
import math
from typing import TypeVar

import msgspec
from msgspec import Struct

from companion.core.modes import Mode, mode_from_number
from companion.core.storage import Saving, Storage
from companion.vehicle.mission.steps import Mission
from companion.vehicle.vehicle import Vehicle

logger = logging.getLogger(__name__)
_Record = TypeVar("_Record", bound=Struct)

FILE = "voyage.json"
ALONG_M = 5.0  # progress along the leg that is worth a new record,
ALONG_S = 10.0  # at most this often


class Voyage(Struct, frozen=True, forbid_unknown_fields=True):
    """One record. plan: hash of the mission. number: count of armings. Places: latitude, longitude in °.

    left_at: where on its leg the charge called the boat home; None: it did not, or the mission went on since.
    """

    plan: str
    mode: int
    is_armed: bool
    item: int
    along_m: float = 0.0
    leg_start: tuple[float, float] | None = None
    home: tuple[float, float] | None = None
    speed_m_s: float | None = None
    jumps: dict[int, int] = {}
    number: int = 0
    left_at: tuple[float, float] | None = None

    @property
    def resumes(self) -> Mode | None:
        """The mode to go on with; AUTO also for a boat that its charge has called home."""
        mode = mode_from_number(self.mode)
        if self.left_at is not None and not self.is_armed:
            return Mode.AUTO
        return mode if self.is_armed and mode is not None and mode.rules.is_resumable else None


def plan_id(mission: Mission) -> str:
    """The mission's hash, without item 0, which is home."""
    return hashlib.sha256(repr(mission[1:]).encode()).hexdigest()[:16]


class VoyageRecord:
    """voyage: the latest record. loss: why the stored one is lost. fault: why the latest was not written."""

    def __init__(self, storage: Storage) -> None:
        self.fault = ""
        self.voyage, self.loss = load(storage, FILE, Voyage)
        self._storage = storage
        self._saved_s = -math.inf
        self._saving: Saving | None = None
        self._mission: Mission = ()
        self._plan = plan_id(())

    def is_ready(self, is_armed: bool) -> bool:
        """Whether the latest write is complete, and there is a voyage to record."""
        if self._saving is not None:
            if not self._saving.is_done():
                return False
            self.fault, self._saving = self._saving.error(), None
        return is_armed or bool(self.fault) or (self.voyage is not None and self.voyage.is_armed)

    def update(self, vehicle: Vehicle, number: int, now_s: float) -> None:
        """Write a record if it differs enough from the latest. Only while `is_ready`."""
        progress, nav, frame, home = vehicle.progress, vehicle.nav, vehicle.frame, vehicle.home
        if progress.mission is not self._mission:
            self._mission, self._plan = progress.mission, plan_id(progress.mission)
        start, along_m = None, 0.0
        line = progress.leg_line() if vehicle.mode is Mode.AUTO else None
        if nav is not None and frame is not None and line is not None:
            start = frame.to_global(line.start)
            along_m = round(line.along_and_cross_track_m(nav.point)[0], 1)
        left = progress.left
        if left is not None:
            start = left.start
        place = None if left is None else left.place
        voyage = Voyage(
            self._plan,
            int(vehicle.mode),
            vehicle.armed and not (vehicle.mode is Mode.AUTO and progress.finished),
            progress.current_seq,
            along_m,
            None if start is None else (start.lat_deg, start.lon_deg),
            None if home is None else (home.lat_deg, home.lon_deg),
            progress.speed_m_s,
            dict(progress.jumps),
            number,
            None if place is None else (place.lat_deg, place.lon_deg),
        )
        if self._has_changed(voyage, now_s):
            self.voyage, self._saved_s = voyage, now_s
            self._saving = self._storage.save(FILE, msgspec.json.encode(voyage))

    def _has_changed(self, voyage: Voyage, now_s: float) -> bool:
        saved = self.voyage
        if saved is None:
            return True
        if self.fault:
            return now_s - self._saved_s >= ALONG_S
        if msgspec.structs.replace(voyage, along_m=saved.along_m) != saved:
            return True
        return now_s - self._saved_s >= ALONG_S and abs(voyage.along_m - saved.along_m) >= ALONG_M


def load(storage: Storage, file: str, kind: type[_Record]) -> tuple[_Record | None, str]:
    """A record of this kind, and why it is lost."""
    content, loss = storage.load(file), storage.damage(file)
    if not content:
        return None, loss
    try:
        return msgspec.json.decode(content, type=kind), loss
    except (msgspec.DecodeError, UnicodeDecodeError, RecursionError) as error:
        logger.warning("%s ignored: %s", file, error)
        return None, f"{file} cannot be read, none is in use"
