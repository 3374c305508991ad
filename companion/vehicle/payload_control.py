"""The payload's place in the tick: actions of the mission, safe states, messages and log."""

from companion.config.boat_config import BoatConfig
from companion.core.geo import LatLon
from companion.core.status_text import Severity
from companion.failsafe.table import Condition
from companion.hal.interfaces import Capture, PayloadParts
from companion.payload.actions import CaptureByDistance, PayloadAction, StartCapture, StopCapture
from companion.payload.camera import Camera, Image
from companion.payload.fitted import FittedPayload
from companion.payload.payloads import Payloads, Written
from companion.vehicle.vehicle import Vehicle


class PayloadControl:
    """What the boat carries. Actions come from the mission and, through `perform`, from stations."""

    def __init__(self, config: BoatConfig, parts: PayloadParts | None, vehicle: Vehicle) -> None:
        self.setting = config.camera
        settings = () if parts is None else config.payload
        self.fitted = FittedPayload(
            settings,
            None if parts is None else config.camera,
            is_skipped=config.mission.absent_payload == "skip",
        )
        self.units = Payloads(settings, parts)
        self.capture: Capture | None = None if parts is None else parts.capture
        self.camera = Camera(self.capture)
        self._is_fitted = self.capture is not None or bool(settings)
        self.images: list[Image] = []  # of the latest tick
        self.written: list[Written] = []  # values of the latest tick
        self._vehicle = vehicle

    def perform(self, action: PayloadAction, now_s: float) -> str:
        """Begin an action that `fitted` has accepted. Returns why it cannot be done now, or empty."""
        if isinstance(action, StartCapture | StopCapture | CaptureByDistance):
            return self.camera.perform(action, now_s)
        return self.units.perform(action, now_s)

    @property
    def has_news(self) -> bool:
        """Whether the latest tick wrote a value or took an image."""
        return bool(self.written or self.images)

    @property
    def position(self) -> LatLon | None:
        """Where the boat is."""
        nav, frame = self._vehicle.nav, self._vehicle.frame
        return None if nav is None or frame is None else frame.to_global(nav.point)

    def tick(self, now_s: float) -> None:
        """Do what the mission asks for, and go on with everything."""
        vehicle = self._vehicle
        for action in vehicle.progress.take_actions():
            if fault := self.perform(action, now_s):
                vehicle.notify(Severity.WARNING, f"Mission: {fault}")
        if not self._is_fitted:
            return
        is_lost = vehicle.failsafes.is_active(Condition.OPERATOR_LOST)
        self.units.tick(now_s, is_armed=vehicle.armed, is_operator_lost=is_lost)
        if self.capture is not None:
            self.camera.tick(now_s, vehicle.nav, self.position)
        self.images, self.written = self.camera.take_images(), self.units.take_written()
        for image in self.images:
            if image.fault:
                vehicle.notify(Severity.WARNING, f"Camera: image {image.index}: {image.fault}")
        for text in self.units.take_status_texts():
            vehicle.notify(*text)
