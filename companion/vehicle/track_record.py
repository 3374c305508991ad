"""SMART_RTL's track on disk, so that it survives a power cut.

It is written when the track turns or grows: at most every ten seconds, and at most a kilobyte per second on
average, which an SD card endures for years. After a power cut the end of the track is known to about 45 m at
2 m/s; a straight line from there to the boat is assumed.
"""

import math
from collections.abc import Sequence
from typing import Annotated

import msgspec
from msgspec import Meta, Struct

from companion.core.geo import LatLon, LocalFrame, Point, distance_m
from companion.core.storage import Saving, Storage
from companion.core.units import deg_to_e7, e7_to_deg
from companion.vehicle.track import MOST_POINTS, SailedTrack
from companion.vehicle.voyage_record import load

FILE = "trail.json"
SOONEST_S = 10.0
BYTES_S = 1000.0
ON_M = 25.0  # distance from the last record that is worth a new one without a turn

_Place = tuple[
    Annotated[int, Meta(ge=-900_000_000, le=900_000_000)],
    Annotated[int, Meta(ge=-1_800_000_000, le=1_800_000_000)],
]


class _Record(Struct, frozen=True, forbid_unknown_fields=True):
    """voyage: its number. places: latitude and longitude in 1e-7 degrees, oldest first."""

    voyage: int
    places: Annotated[tuple[_Place, ...], Meta(max_length=MOST_POINTS + 1)]


class TrackRecord:
    """Stores the trail of an armed boat, and restores it once there is a frame."""

    def __init__(self, storage: Storage, trail: SailedTrack, cut_voyage: int | None) -> None:
        """cut_voyage: the voyage interrupted by a power cut, or None."""
        self._storage = storage
        self._trail = trail
        self._kept: tuple[_Place, ...] = ()
        self.loss = ""  # the lost part of the stored track, and its substitute
        if cut_voyage is not None:
            record, self.loss = load(storage, FILE, _Record)
            # Written before the voyage's own record, it may be of the next voyage, which continues this one
            if record is not None and record.voyage in (cut_voyage, cut_voyage + 1):
                self._kept = record.places
        self._points: list[Point] = []  # points with known places,
        self._places: list[_Place] = []  # and these
        self._sign: tuple[int, Point | None] = (-1, None)
        self._due_s = -math.inf
        self._saving: Saving | None = None

    def leads_home(self, at: Point | None) -> bool:
        """Whether a boat armed here continues the interrupted track."""
        return bool(self._kept) or (at is not None and self._trail.continues_from(at))

    def restore(self, frame: LocalFrame | None, armed: bool) -> None:
        """Restore the interrupted track. An armed boat has started another."""
        if not self._kept or (frame is None and not armed):
            return
        if frame is not None and not armed:
            self._trail.restore(
                [frame.to_local(LatLon(e7_to_deg(lat), e7_to_deg(lon))) for lat, lon in self._kept]
            )
        self._kept = ()

    def update(self, voyage: int, frame: LocalFrame, now_s: float) -> None:
        """Store the track of an armed boat if it has changed enough. voyage: its number."""
        if self._saving is not None:
            if not self._saving.is_done():
                return
            if self._saving.error():
                self._sign = (-1, None)
            self._saving = None
        if now_s < self._due_s or not self._has_changed():
            return
        trail = self._trail
        points = [] if trail.is_incomplete else [*trail.points]
        if points and trail.latest is not None and trail.latest != points[-1]:
            points.append(trail.latest)
        content = msgspec.json.encode(_Record(voyage, self._placed(points, frame)))
        self._sign = (len(trail.points), points[-1] if points else None)
        self._due_s = now_s + max(SOONEST_S, len(content) / BYTES_S)
        self._saving = self._storage.save(FILE, content)

    def begin(self) -> None:
        """A new voyage: its first record is due at once."""
        self._due_s, self._sign = -math.inf, (-1, None)

    def _has_changed(self) -> bool:
        trail, (count, end) = self._trail, self._sign
        if len(trail.points) != count or end is None:
            return len(trail.points) != count
        latest = trail.latest
        return latest is not None and distance_m(latest, end) >= ON_M

    def _placed(self, points: Sequence[Point], frame: LocalFrame) -> tuple[_Place, ...]:
        """Places of the points; only new ones are computed."""
        same = 0
        for old, new in zip(self._points, points, strict=False):
            if old is not new:
                break
            same += 1
        del self._points[same:], self._places[same:]
        for point in points[same:]:
            place = frame.to_global(point)
            self._points.append(point)
            self._places.append((deg_to_e7(place.lat_deg), deg_to_e7(place.lon_deg)))
        return tuple(self._places)
