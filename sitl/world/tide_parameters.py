"""A tidal stream as parameters, to be changed while the boat sails: ArduPilot's names, and its sense."""

import math
from collections.abc import Callable

from companion.config.parameters import ParameterHook, ParameterRow, ParameterType
from sitl.world.environment import Current


class TideParameters:
    """A stream on top of the scenario's own current, the same everywhere. As in ArduPilot its direction is
    where it comes from."""

    def __init__(self, current: Current, on_change: Callable[[], None]) -> None:
        """on_change: called once the current is another."""
        self._current = current
        self._on_change = on_change
        self._speed_m_s = self._from_rad = 0.0
        self.parameter_hooks = (
            ParameterHook(
                ParameterRow(
                    "SIM_TIDE_SPEED", ParameterType.REAL32, "Tidal stream", unit="m/s", low=0.0, high=10.0
                ),
                self._strengthen,
            ),
            ParameterHook(
                ParameterRow(
                    "SIM_TIDE_DIR",
                    ParameterType.REAL32,
                    "Where the tidal stream comes from",
                    unit="deg",
                    low=-360.0,
                    high=360.0,
                ),
                self._turn,
            ),
        )

    def _strengthen(self, speed_m_s: float) -> None:
        self._speed_m_s = speed_m_s
        self._flow()

    def _turn(self, from_deg: float) -> None:
        self._from_rad = math.radians(from_deg)
        self._flow()

    def _flow(self) -> None:
        speed_m_s, from_rad = self._speed_m_s, self._from_rad
        self._current.stream(-speed_m_s * math.cos(from_rad), -speed_m_s * math.sin(from_rad))
        self._on_change()
