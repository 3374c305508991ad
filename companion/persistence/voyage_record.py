"""Where the boat was when the power went: kept on disk while it is armed, and taken up after the restart.

A record is written when mode, arming or item change, and now and then along a leg, off the control loop.
After a restart of a boat that was under way, the mission stands at the item and on the leg that it was on,
home is where it was, and SMART_RTL knows its track (`trail_record.py`). The boat says so until it is armed;
it goes on by itself only where FS_RESUME says that.
"""

import hashlib
import logging
import math

import msgspec
from msgspec import Struct

from companion.core.geo import LatLon
from companion.core.modes import Mode
from companion.core.requests import Arm, ChangeMode
from companion.core.status_text import Severity
from companion.persistence.storage import Saving, Storage
from companion.persistence.track_record import TrackRecord
from companion.vehicle.mission.steps import Mission
from companion.vehicle.vehicle import Vehicle

logger = logging.getLogger(__name__)

FILE = "voyage.json"
PERIOD_S = 0.5  # how often it looks whether there is something to write
LOOK_S = 0.1  # and whether mode, arming or item have changed, which is written at once
ALONG_M = 5.0  # further along the leg is worth a new record,
ALONG_S = 10.0  # but not more often than this
REPEAT_S = 30.0
WARNING_S = 10.0  # between saying that the boat will go on by itself, and going on
_VOYAGE, _TRACK = "voyage record", "track of SMART_RTL"  # their names among the losses
_FORGET, _ASK, _GO_ON = 0, 1, 2  # FS_RESUME


class Voyage(Struct, frozen=True, forbid_unknown_fields=True):
    """One record. plan names the mission by its content; places are latitude and longitude in degrees."""

    plan: str
    mode: int
    is_armed: bool
    item: int
    along_m: float = 0.0
    leg_start: tuple[float, float] | None = None
    home: tuple[float, float] | None = None
    speed_m_s: float | None = None
    jumps: dict[int, int] = {}
    number: int = 0  # of the voyage: one more each time the boat is armed


def plan_id(mission: Mission) -> str:
    """Names a mission by what is sailed; sequence 0, which is home, does not count."""
    return hashlib.sha256(repr(mission[1:]).encode()).hexdigest()[:16]


class Resume:
    """Keeps the record, and the offer to go on after a restart. The mission must have been loaded before.

    fault: why the latest record could not be written, "" when it could.
    """

    __slots__ = (
        "_countdown_s",
        "_due_s",
        "_is_coming_inside",
        "_look_s",
        "_mission",
        "_number",
        "_offer",
        "_plan",
        "_saved",
        "_saved_s",
        "_saving",
        "_sign",
        "_storage",
        "_tell_s",
        "_trail",
        "_vehicle",
        "fault",
    )

    def __init__(self, storage: Storage, vehicle: Vehicle) -> None:
        self.fault = ""
        self._due_s = self._look_s = 0.0
        self._sign = (vehicle.mode, vehicle.armed, 0)
        self._storage = storage
        self._vehicle = vehicle
        self._mission: Mission = ()
        self._plan = plan_id(())
        self._saved, loss = _load(storage)
        self._saved_s = -math.inf
        self._saving: Saving | None = None
        self._tell_s = 0.0
        self._countdown_s = math.nan
        self._is_coming_inside = False  # armed by itself, and not on its mission yet
        self._offer = self._restore()
        saved = self._saved
        self._number = 0 if saved is None else saved.number
        goes_on = saved is not None and saved.is_armed and vehicle.config.failsafe.resume != _FORGET
        self._trail = TrackRecord(storage, vehicle.track, self._number if goes_on else None)
        for name, what in ((_VOYAGE, loss), (_TRACK, self._trail.loss)):
            if what:
                vehicle.losses.add(name, what, "Arming begins a new one")

    def tick(self, now_s: float) -> None:
        """Write what is worth it; say, or do, what there is to take up."""
        if now_s < self._look_s:
            return
        self._look_s = now_s + LOOK_S
        vehicle = self._vehicle
        sign = (vehicle.mode, vehicle.armed, vehicle.progress.current_seq)
        if now_s < self._due_s and sign == self._sign:
            return
        if vehicle.armed and not self._sign[1]:
            self._number += 1
            self._trail.begin()
            vehicle.losses.end(_VOYAGE)
            vehicle.losses.end(_TRACK)
        self._due_s, self._sign = now_s + PERIOD_S, sign
        self._trail.restore(vehicle.frame, vehicle.armed)
        if vehicle.armed and vehicle.frame is not None:
            self._trail.update(self._number, vehicle.frame, now_s)
        if self._offer is not None:
            self._follow_up(self._offer, now_s)
        self._save(now_s)

    # The record

    def _save(self, now_s: float) -> None:
        if self._saving is not None:
            if not self._saving.is_done():
                return
            self.fault, self._saving = self._saving.error(), None
        if self._offer is not None:
            return  # what was lost is still to be taken up, after another restart too
        saved, armed = self._saved, self._vehicle.armed
        if not armed and (saved is None or not saved.is_armed) and not self.fault:
            return
        voyage = self._voyage()
        if saved is not None and not self._is_news(saved, voyage, now_s):
            return
        self._saved, self._saved_s = voyage, now_s
        self._saving = self._storage.save(FILE, msgspec.json.encode(voyage))

    def _is_news(self, saved: Voyage, voyage: Voyage, now_s: float) -> bool:
        if self.fault:
            return now_s - self._saved_s >= ALONG_S
        if msgspec.structs.replace(voyage, along_m=saved.along_m) != saved:
            return True
        return now_s - self._saved_s >= ALONG_S and abs(voyage.along_m - saved.along_m) >= ALONG_M

    def _voyage(self) -> Voyage:
        vehicle, progress = self._vehicle, self._vehicle.progress
        if progress.mission is not self._mission:
            self._mission, self._plan = progress.mission, plan_id(progress.mission)
        start, along_m = None, 0.0
        if vehicle.nav is not None and vehicle.frame is not None and vehicle.mode is Mode.AUTO:
            line = progress.leg_line()
            if line is not None:
                start = vehicle.frame.to_global(line.start)
                along_m = round(line.along_and_cross_track_m(vehicle.nav.point)[0], 1)
        is_under_way = vehicle.armed and not (vehicle.mode is Mode.AUTO and progress.finished)
        return Voyage(
            self._plan,
            int(vehicle.mode),
            is_under_way,
            progress.current_seq,
            along_m,
            None if start is None else (start.lat_deg, start.lon_deg),
            None if vehicle.home is None else (vehicle.home.lat_deg, vehicle.home.lon_deg),
            progress.speed_m_s,
            dict(progress.jumps),
            self._number,
        )

    # The offer

    def _restore(self) -> Voyage | None:
        """Put mission and home back as they were, where that can be; what there is to offer then."""
        voyage, vehicle = self._saved, self._vehicle
        if voyage is None or not voyage.is_armed or vehicle.config.failsafe.resume == _FORGET:
            return None
        if voyage.mode not in (Mode.AUTO, Mode.RTL, Mode.SMART_RTL):
            return None
        try:
            home = None if voyage.home is None else LatLon(*voyage.home)
            start = None if voyage.leg_start is None else LatLon(*voyage.leg_start)
        except ValueError:
            return None
        progress = vehicle.progress
        if voyage.plan == plan_id(progress.mission):
            taken = progress.take_up(voyage.item, start, voyage.speed_m_s, voyage.jumps)
        else:
            taken = False
        if voyage.mode == Mode.AUTO and not taken:
            return None
        if home is not None:
            vehicle.set_home(home)
        return voyage

    def _follow_up(self, offer: Voyage, now_s: float) -> None:
        vehicle = self._vehicle
        is_mission = offer.mode == Mode.AUTO
        if vehicle.armed and self._is_coming_inside:
            self._continue_inside()
            return
        if vehicle.armed or (is_mission and vehicle.progress.current_seq != offer.item):
            self._offer = None
            return
        if now_s >= self._tell_s:
            self._tell_s = now_s + REPEAT_S
            what = f"at item {offer.item}, {offer.along_m:.0f} m along" if is_mission else "on the way home"
            then = "MISSION_START" if is_mission else self._way_home(offer).name
            vehicle.notify(Severity.WARNING, f"Power lost {what}: arm and {then} to resume")
        if vehicle.config.failsafe.resume == _GO_ON:
            self._continue(Mode.AUTO if is_mission else self._way_home(offer), now_s)

    def _way_home(self, offer: Voyage) -> Mode:
        nav = self._vehicle.nav
        leads_home = self._trail.leads_home(None if nav is None else nav.point)
        return Mode.SMART_RTL if offer.mode == Mode.SMART_RTL and leads_home else Mode.RTL

    def _continue(self, mode: Mode, now_s: float) -> None:
        """Once the boat may be armed, a warning and a pause; then arm and sail, unless somebody objects.

        What has drifted over the fence meanwhile comes back inside before it goes on with its mission.
        """
        vehicle = self._vehicle
        first = Mode.LOITER if mode is Mode.AUTO and vehicle.is_outside else mode
        if math.isnan(self._countdown_s):
            if vehicle.can_enter(mode) and vehicle.change_mode(first, "power is back").accepted:
                if vehicle.arming_faults():
                    return
                self._countdown_s = now_s
                vehicle.is_resuming = True
                vehicle.notify(Severity.CRITICAL, f"Resuming in {WARNING_S:.0f} s: keep clear")
        elif not vehicle.is_resuming:
            self._offer = None
            vehicle.notify(Severity.NOTICE, "Resume cancelled")
        elif now_s - self._countdown_s >= WARNING_S and vehicle.can_enter(mode):
            vehicle.change_mode(first, "power is back")
            if vehicle.arming_faults():
                return
            vehicle.request(ChangeMode(first))
            vehicle.request(Arm())
            self._is_coming_inside = vehicle.is_resuming = first is not mode
            if self._is_coming_inside:
                vehicle.notify(Severity.WARNING, "Outside the fence: returning inside first")
            else:
                self._offer = None

    def _continue_inside(self) -> None:
        """The mission, once the boat is back; nothing any more if somebody has objected."""
        vehicle, nav = self._vehicle, self._vehicle.nav
        if not vehicle.is_resuming or vehicle.mode is not Mode.LOITER:
            self._offer, self._is_coming_inside = None, False
        elif nav is not None and vehicle.fence.margin_m(nav.point) >= vehicle.config.fence.margin_m:
            self._offer, self._is_coming_inside = None, False
            vehicle.request(ChangeMode(Mode.AUTO))


def _load(storage: Storage) -> tuple[Voyage | None, str]:
    """The record, and what of it is lost."""
    content = storage.load(FILE)
    loss = storage.damage(FILE)
    if not content:
        return None, loss
    try:
        return msgspec.json.decode(content, type=Voyage), loss
    except (msgspec.DecodeError, UnicodeDecodeError, RecursionError) as error:
        logger.warning("%s ignored: %s", FILE, error)
        return None, f"{FILE} cannot be read, none is in use"
