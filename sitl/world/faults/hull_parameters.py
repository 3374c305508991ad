"""Water and heat in the hull by parameter, while the boat sails. ArduPilot has no names for these."""

from companion.config.parameters import ParameterHook, ParameterRow, ParameterType
from sitl.world.faults.parts import LeakPart
from sitl.world.sensors import HullSensorSettings, SimHull


class HullParameters:
    """Two parameters over the hull's probe and thermometer."""

    def __init__(self, hull: SimHull, leak: LeakPart, settings: HullSensorSettings) -> None:
        self._leak = leak
        self.parameter_hooks = (
            ParameterHook(
                ParameterRow(
                    "SIM_LEAK",
                    ParameterType.INT32,
                    "1: water at the probe in the hull",
                    default=0.0,
                    low=0.0,
                    high=1.0,
                ),
                self._soak,
            ),
            ParameterHook(
                ParameterRow(
                    "SIM_HULL_TEMP",
                    ParameterType.REAL32,
                    "How warm it is in the hull",
                    default=settings.temperature_c,
                    unit="degC",
                    low=-40.0,
                    high=150.0,
                ),
                hull.set_temperature,
            ),
        )

    def _soak(self, value: float) -> None:
        self._leak.soak(value == 1.0)
