"""The camera's images: how many, when and where."""

import pytest
from boat_rig import FRAME, nav_at

from companion.config.boat_config import decode_config
from companion.core.geo import Point
from companion.payload.actions import CaptureByDistance, StartCapture
from companion.payload.camera import Camera, Image
from sitl.world.payload import SimCapture, SimPayload

TICK_S = 0.02


class Rig:
    def __init__(self) -> None:
        self.sim = SimPayload(decode_config({}, "test"))
        self.shutter = SimCapture(self.sim, "camera")
        self.camera = Camera(self.shutter)
        self.images: list[Image] = []
        self.now_s = self.north_m = 0.0

    def run(self, seconds: float, speed_m_s: float = 0.0) -> None:
        for _ in range(round(seconds / TICK_S)):
            self.now_s += TICK_S
            self.sim.step(self.now_s)
            self.north_m += speed_m_s * TICK_S
            place = FRAME.to_global(Point(self.north_m, 0.0))
            self.camera.tick(self.now_s, nav_at(self.north_m), place)
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
    rig.run(22.0, speed_m_s=2.0)
    assert len(rig.images) == 5
    rig.camera.perform(CaptureByDistance(0.0), rig.now_s)
    rig.run(20.0, speed_m_s=2.0)
    assert len(rig.images) == 5
