"""The wind as parameters, to be changed while the boat sails: ArduPilot's names."""

import math

from companion.config.parameters import ParameterHook, ParameterRow, ParameterType
from sitl.world.environment import Environment, Wind


class WindParameters:
    """Mean and direction; gusts stay as far above the mean as the scenario has them."""

    def __init__(self, environment: Environment, wind: Wind) -> None:
        self._wind = wind
        self._mean_m_s = environment.wind_m_s
        self._from_rad = math.radians(environment.wind_from_deg)
        self._gust_m_s = max(0.0, environment.gust_m_s - environment.wind_m_s)
        self.parameter_hooks = (
            ParameterHook(
                ParameterRow(
                    "SIM_WIND_SPD",
                    ParameterType.REAL32,
                    "Mean wind at the hull",
                    default=environment.wind_m_s,
                    unit="m/s",
                    low=0.0,
                    high=60.0,
                ),
                self._strengthen,
            ),
            ParameterHook(
                ParameterRow(
                    "SIM_WIND_DIR",
                    ParameterType.REAL32,
                    "Where the wind comes from",
                    default=environment.wind_from_deg,
                    unit="deg",
                    low=-360.0,
                    high=360.0,
                ),
                self._turn,
            ),
        )

    def _strengthen(self, mean_m_s: float) -> None:
        self._mean_m_s = mean_m_s
        self._blow()

    def _turn(self, from_deg: float) -> None:
        self._from_rad = math.radians(from_deg)
        self._blow()

    def _blow(self) -> None:
        gust_m_s = self._mean_m_s + self._gust_m_s if self._gust_m_s else 0.0
        self._wind.blow(self._mean_m_s, self._from_rad, gust_m_s)
