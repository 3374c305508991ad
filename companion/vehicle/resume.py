"""Resuming a voyage after a power loss.

After a restart of an armed boat, the mission stands at the item and on the leg where it was, home is where it
was, and SMART_RTL has its track. The operator is told until the boat is armed. It resumes by itself only if
FS_RESUME says so.
"""

import math

from companion.core.geo import LatLon
from companion.core.modes import Mode
from companion.core.requests import Arm, ChangeMode, SetHome
from companion.core.status_text import Severity
from companion.core.storage import Storage
from companion.vehicle.mission.left_leg import LeftLeg
from companion.vehicle.track_record import TrackRecord
from companion.vehicle.vehicle import Vehicle
from companion.vehicle.voyage_record import Voyage, VoyageRecord, plan_id

PERIOD_S = 0.5  # how often the record is compared with the vehicle
CHECK_S = 0.1  # the same for mode, arming and item, whose changes are written at once
REPEAT_S = 30.0
WARNING_S = 10.0  # between the warning and resuming by itself
_VOYAGE, _TRACK = "voyage record", "track of SMART_RTL"  # their names among the losses
_FORGET, _BY_ITSELF = 0, 2  # of FS_RESUME


class VoyageResume:
    """Keeps the record, and offers to resume. The mission must have been loaded before."""

    def __init__(self, storage: Storage, vehicle: Vehicle) -> None:
        """Restore the mission's progress and home, where that is possible."""
        self._record = VoyageRecord(storage)
        self._due_s = self._check_s = self._tell_s = 0.0
        self._seen = (vehicle.mode, vehicle.armed, 0)
        self._countdown_s = math.nan  # when the countdown to resuming began
        self._returns_inside = False  # armed by itself, but not on its mission yet
        saved = self._record.voyage
        kept = None if vehicle.config.failsafe.resume == _FORGET else saved
        is_cut = kept is not None and kept.is_armed
        self._offer = kept if kept is not None and _restore(kept, vehicle) else None
        self._number = 0 if saved is None else saved.number
        self._track = TrackRecord(storage, vehicle.track, self._number if is_cut else None)
        for name, what in ((_VOYAGE, self._record.loss), (_TRACK, self._track.loss)):
            if what:
                vehicle.data_losses.add(name, what, "Arming begins a new one")

    @property
    def fault(self) -> str:
        """Why the latest record could not be written, empty when it could."""
        return self._record.fault

    def update(self, vehicle: Vehicle, now_s: float) -> None:
        """Write what has changed; offer to resume, or do it."""
        if now_s < self._check_s:
            return
        self._check_s = now_s + CHECK_S
        seen = (vehicle.mode, vehicle.armed, vehicle.progress.current_seq)
        if now_s < self._due_s and seen == self._seen:
            return
        if vehicle.armed and not self._seen[1]:
            self._number += 1
            self._track.begin()
            vehicle.data_losses.end(_VOYAGE)
            vehicle.data_losses.end(_TRACK)
        self._due_s, self._seen = now_s + PERIOD_S, seen
        self._track.restore(vehicle.frame, vehicle.armed)
        if vehicle.armed and vehicle.frame is not None:
            self._track.update(self._number, vehicle.frame, now_s)
        if self._offer is not None:
            self._follow_up(self._offer, vehicle, now_s)
        # An open offer stays on the medium, for another restart
        if self._record.is_ready(vehicle.armed) and self._offer is None:
            self._record.update(vehicle, self._number, now_s)

    def _follow_up(self, offer: Voyage, vehicle: Vehicle, now_s: float) -> None:
        is_mission = offer.resumes is Mode.AUTO
        if vehicle.armed and self._returns_inside:
            self._continue_inside(vehicle)
            return
        if vehicle.armed or (is_mission and vehicle.progress.current_seq != offer.item):
            self._offer = None
            return
        mode = Mode.AUTO if is_mission else self._mode_home(offer, vehicle)
        if now_s >= self._tell_s:
            self._tell_s = now_s + REPEAT_S
            what = f"at item {offer.item}, {offer.along_m:.0f} m along" if is_mission else "on the way home"
            what = f"Power lost {what}" if offer.is_armed else f"Charge ended on the leg to item {offer.item}"
            then = "MISSION_START" if is_mission else mode.name
            vehicle.notify(Severity.WARNING, f"{what}: arm and {then} to resume")
        if vehicle.config.failsafe.resume == _BY_ITSELF and offer.is_armed:
            self._resume(mode, vehicle, now_s)

    def _mode_home(self, offer: Voyage, vehicle: Vehicle) -> Mode:
        leads_home = self._track.leads_home(None if vehicle.nav is None else vehicle.nav.point)
        return Mode.SMART_RTL if offer.mode == Mode.SMART_RTL and leads_home else Mode.RTL

    def _resume(self, mode: Mode, vehicle: Vehicle, now_s: float) -> None:
        """Once the boat can be armed, warn and wait; then arm and sail, unless the operator intervenes.

        A boat that has drifted out of the fence returns inside before it continues its mission.
        """
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
            self._returns_inside = vehicle.is_resuming = first is not mode
            if self._returns_inside:
                vehicle.notify(Severity.WARNING, "Outside the fence: returning inside first")
            else:
                self._offer = None

    def _continue_inside(self, vehicle: Vehicle) -> None:
        """Continue the mission once the boat is inside, unless the operator has intervened."""
        nav, margin_m = vehicle.nav, vehicle.config.fence.margin_m
        if not vehicle.is_resuming or vehicle.mode is not Mode.LOITER:
            self._offer, self._returns_inside = None, False
        elif nav is not None and vehicle.fence.margin_m(nav.point) >= margin_m:
            self._offer, self._returns_inside = None, False
            vehicle.request(ChangeMode(Mode.AUTO))


def _restore(voyage: Voyage, vehicle: Vehicle) -> bool:
    """Restore the mission's progress and home. Whether there is a voyage to resume."""
    mode = voyage.resumes
    if mode is None:
        return False
    try:
        home = None if voyage.home is None else LatLon(*voyage.home)
        place = None if voyage.left_at is None else LatLon(*voyage.left_at)
        left = None if voyage.leg_start is None else LeftLeg(LatLon(*voyage.leg_start), place)
    except ValueError:
        return False
    progress = vehicle.progress
    is_same = voyage.plan == plan_id(progress.mission)
    is_restored = is_same and progress.restore(voyage.item, left, voyage.speed_m_s, voyage.jumps)
    if mode is Mode.AUTO and not is_restored:
        return False
    if home is not None:
        vehicle.request(SetHome(home))
    return True
