"""The camera's images: how many, when and where."""

import pytest
from boat_rig import FRAME, nav_at

from companion.core.geo import Point
from companion.payload.actions import CaptureByDistance, StartCapture
from companion.payload.camera import Camera, Image

TICK_S = 0.02


class Shutter:
    """A capture program that takes run_s on the test's clock."""

    def __init__(self, run_s: float = 0.5) -> None:
        self.now_s = 0.0
        self.run_s = run_s
        self.fault = ""
        self.starts: list[float] = []
        self._has_told = True

    @property
    def is_running(self) -> bool:
        return bool(self.starts) and self.now_s < self.starts[-1] + self.run_s

    def start(self) -> str:
        assert not self.is_running
        self.starts.append(self.now_s)
        self._has_told = False
        return f"image-{len(self.starts)}.jpg"

    def poll(self) -> str | None:
        if self._has_told or self.is_running:
            return None
        self._has_told = True
        return self.fault

    def space_mb(self) -> tuple[float, float]:
        return 0.0, 0.0

    def end(self) -> None:
        """Nothing to end."""

    def close(self) -> None:
        """Nothing to release."""


class Rig:
    def __init__(self, run_s: float = 0.5) -> None:
        self.shutter = Shutter(run_s)
        self.camera = Camera(self.shutter)
        self.images: list[Image] = []
        self.north_m = 0.0

    def run(self, seconds: float, speed_m_s: float = 0.0) -> None:
        for _ in range(round(seconds / TICK_S)):
            self.shutter.now_s += TICK_S
            self.north_m += speed_m_s * TICK_S
            place = FRAME.to_global(Point(self.north_m, 0.0))
            self.camera.tick(self.shutter.now_s, nav_at(self.north_m), place)
            self.images += self.camera.take_images()


def test_a_series_is_counted_and_evenly_spaced() -> None:
    rig = Rig()
    rig.camera.perform(StartCapture(3, 2.0), 0.0)
    rig.run(20.0)
    assert [one.index for one in rig.images] == [0, 1, 2]
    assert rig.shutter.starts == pytest.approx([0.02, 2.0, 4.0], abs=0.021)
    assert not rig.camera.has_series


def test_a_second_single_image_during_the_first_is_refused() -> None:
    rig = Rig()
    rig.camera.perform(StartCapture(), 0.0)
    rig.run(0.1)
    assert rig.camera.perform(StartCapture(), 0.1) == "the camera is still taking an image"


def test_images_by_distance_and_one_at_once() -> None:
    rig = Rig()
    rig.camera.perform(CaptureByDistance(10.0, now=True), 0.0)
    rig.run(21.0, speed_m_s=2.0)
    assert len(rig.images) == 5
    rig.camera.perform(CaptureByDistance(0.0), rig.shutter.now_s)
    rig.run(20.0, speed_m_s=2.0)
    assert len(rig.images) == 5
