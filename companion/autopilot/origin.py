"""The origin of the local frame, which estimator and external sensors share."""

from collections.abc import Callable

from companion.core.status_text import Severity
from companion.estimation.estimator import Estimator
from companion.sensors.external import ExternalSensors


class OriginMonitor:
    """Moves the origin of a disarmed boat that was carried beyond the frame; warns while it is armed."""

    def __init__(self, estimator: Estimator, external: ExternalSensors) -> None:
        self._estimator = estimator
        self._external = external
        self._far_m = 0.0  # how far beyond the frame every fix lies, 0 within

    def share_frame(self) -> None:
        """Whichever of both has a frame gives it to the other. Before the estimator's update."""
        if self._estimator.frame is None:
            self._estimator.preset_frame = self._external.frame
        elif self._external.frame is None:
            self._external.frame = self._estimator.frame

    def check(self, armed: bool, notify: Callable[[int, str], None]) -> float:
        """How far the origin has been moved, 0 if it has not. After the estimator's update."""
        far_m, was_far = self._estimator.far_m, self._far_m > 0.0
        self._far_m = far_m if armed else 0.0
        if far_m == 0.0 or armed:
            if far_m > 0.0 and not was_far:
                text = f"GPS: {far_m / 1e3:.0f} km from where the boat was, not used until disarmed"
                notify(Severity.WARNING, text)
            return 0.0
        if self._external.frame is self._estimator.frame:
            self._external.frame = None
        self._estimator.reset_origin()
        return far_m
