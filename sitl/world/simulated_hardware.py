"""The boat's hardware, simulated: what `companion.hal.interfaces` asks for, over a world in memory.

The motors' inputs are here; receiver, compass, sonar and battery monitor are in `sensors`.
"""

import math

from companion.core.units import clamp


class SimMotors:
    """Two motor inputs that keep the last command, as an H-bridge does."""

    def __init__(self) -> None:
        self.left = self.right = 0.0

    def write(self, left: float, right: float) -> None:
        """Take a command, −1..1 per side; a value that is not finite stops both."""
        if math.isfinite(left) and math.isfinite(right):
            self.left, self.right = clamp(left, -1.0, 1.0), clamp(right, -1.0, 1.0)
        else:
            self.stop()

    def stop(self) -> None:
        """Cut both."""
        self.left = self.right = 0.0

    def close(self) -> None:
        """Stop."""
        self.stop()


class SimRudder:
    """The input of a rudder's servo, which keeps the last command."""

    def __init__(self) -> None:
        self.share = 0.0

    def write(self, share: float) -> None:
        """Take a command, −1..1; a value that is not finite centres the rudder."""
        self.share = clamp(share, -1.0, 1.0) if math.isfinite(share) else 0.0

    def close(self) -> None:
        """Centre it."""
        self.share = 0.0
