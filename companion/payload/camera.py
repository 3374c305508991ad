"""The camera's images: single, in series, and by distance. Time and place are those of the shutter."""

import math
from dataclasses import dataclass, replace

from companion.core.geo import LatLon, Point, distance_m
from companion.core.state import NavState
from companion.hal.interfaces import Capture
from companion.payload.actions import CameraAction, CaptureByDistance, StartCapture, StopCapture


@dataclass(frozen=True, slots=True)
class Image:
    """index: from 0. fault: empty if the image was taken. heading_rad: NaN if unknown."""

    index: int
    time_s: float
    position: LatLon | None
    heading_rad: float
    path: str
    fault: str


class Camera:
    """Starts the capture program. count: taken since the start; left: to take, infinite until stopped."""

    def __init__(self, capture: Capture | None) -> None:
        self.count = 0
        self.left = 0.0
        self.interval_s = 0.0
        self.distance_m = 0.0  # between two images; 0: not by distance
        self._capture = capture
        self._due_s = math.inf
        self._last_point: Point | None = None
        self._present: Image | None = None
        self._images: list[Image] = []

    @property
    def is_capturing(self) -> bool:
        """Whether an image is being taken."""
        return self._present is not None

    @property
    def has_series(self) -> bool:
        """Whether more images follow by themselves."""
        return self.left > 0.0 and self.interval_s > 0.0

    def perform(self, action: CameraAction, now_s: float) -> str:
        """Begin an action. Returns why it cannot be done now, or empty."""
        match action:
            case StartCapture(count, interval_s):
                if self.is_capturing and count == 1:
                    return "the camera is still taking an image"
                self.left, self.interval_s, self._due_s = float(count or math.inf), interval_s, now_s
            case StopCapture():
                self.left, self._due_s = 0.0, math.inf
            case CaptureByDistance(metres, now):
                self.distance_m, self._last_point = metres, None
                if now and not self.has_series:
                    self.left, self._due_s = 1.0, now_s
        return ""

    def tick(self, now_s: float, nav: NavState | None, position: LatLon | None) -> None:
        """Take what is due, and note what has been taken. An image that is due during another one waits."""
        capture = self._capture
        if capture is None:
            return
        if self._present is not None and (fault := capture.poll()) is not None:
            self._images.append(replace(self._present, fault=fault))
            self._present = None
        if self._last_point is None and nav is not None:
            self._last_point = nav.point
        if self.is_capturing or not (self._is_due(now_s) or self._has_moved(nav)):
            return
        heading_rad = math.nan if nav is None else nav.heading_rad
        path = capture.start()
        self._present = Image(self.count, now_s, position, heading_rad, path, "")
        self.count += 1

    def take_images(self) -> list[Image]:
        """Images since the last call."""
        images, self._images = self._images, []
        return images

    def _is_due(self, now_s: float) -> bool:
        if now_s < self._due_s:
            return False
        self.left -= 1.0
        self._due_s = max(self._due_s + self.interval_s, now_s) if self.has_series else math.inf
        return True

    def _has_moved(self, nav: NavState | None) -> bool:
        before = self._last_point
        if self.distance_m <= 0.0 or nav is None or before is None:
            return False
        if distance_m(before, nav.point) < self.distance_m:
            return False
        self._last_point = nav.point
        return True
