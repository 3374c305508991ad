"""The water's own motion over ground by place and time: uniform, river, gyre, tide, and from a file.

All that a scenario names is summed. The hull takes each step's current as uniform over its length and over
the step: that holds while the current changes little along a boat's length (a river of 20 m width and 1 m/s
does, by 0.2 m/s at its edge). It makes the model in relative velocity valid (see `sitl.world.hull`).
"""

import math
from pathlib import Path

from sitl.world.environment.grid import read_grid
from sitl.world.environment.settings import Environment, Gyre, River, Tide


class Current:
    """All of it. is_uniform: one velocity, the same everywhere and always."""

    def __init__(self, environment: Environment) -> None:
        """Read the file, if there is one. Raises ConfigError: the file cannot be used."""
        self._uniform = (environment.current_north_m_s, environment.current_east_m_s)
        self._north_m_s, self._east_m_s = self._uniform
        self._river, self._gyre, self._tide = environment.river, environment.gyre, environment.tide
        self._grid = read_grid(Path(environment.current_file)) if environment.current_file else None
        self.is_uniform = (
            self._river is None and self._gyre is None and self._tide is None and self._grid is None
        )

    def stream(self, north_m_s: float, east_m_s: float) -> None:
        """Add a uniform stream to the scenario's current."""
        self._north_m_s, self._east_m_s = self._uniform[0] + north_m_s, self._uniform[1] + east_m_s

    def at(self, north_m: float, east_m: float, time_s: float) -> tuple[float, float]:
        """North and east velocity of the water at a place and a time."""
        north_m_s, east_m_s = self._north_m_s, self._east_m_s
        if self._river is not None:
            north, east = river(self._river, north_m, east_m)
            north_m_s, east_m_s = north_m_s + north, east_m_s + east
        if self._gyre is not None:
            north, east = gyre(self._gyre, north_m, east_m)
            north_m_s, east_m_s = north_m_s + north, east_m_s + east
        if self._tide is not None:
            north, east = tide(self._tide, time_s)
            north_m_s, east_m_s = north_m_s + north, east_m_s + east
        if self._grid is not None:
            north, east = self._grid.at(north_m, east_m, time_s)
            north_m_s, east_m_s = north_m_s + north, east_m_s + east
        return north_m_s, east_m_s


def river(setting: River, north_m: float, east_m: float) -> tuple[float, float]:
    """The parabola of a straight channel: full speed on its middle line, none at its banks and beyond."""
    course = math.radians(setting.to_deg)
    cos, sin = math.cos(course), math.sin(course)
    off = 2.0 * ((east_m - setting.through[0]) * cos - (north_m - setting.through[1]) * sin) / setting.width_m
    speed_m_s = setting.speed_m_s * max(0.0, 1.0 - off * off)
    return speed_m_s * cos, speed_m_s * sin


def gyre(setting: Gyre, north_m: float, east_m: float) -> tuple[float, float]:
    """A round eddy without divergence: v = V (r/R) exp(½ − ½ (r/R)²), fastest at its radius R."""
    east, north = east_m - setting.centre[0], north_m - setting.centre[1]
    square = (east * east + north * north) / (setting.radius_m * setting.radius_m)
    per_m = setting.speed_m_s / setting.radius_m * math.exp(0.5 - 0.5 * square)
    if setting.clockwise:
        return -per_m * east, per_m * north
    return per_m * east, -per_m * north


def tide(setting: Tide, time_s: float) -> tuple[float, float]:
    """A stream that swings to and fro: the same everywhere, strongest at strongest_s."""
    speed_m_s = setting.speed_m_s * math.cos(
        2.0 * math.pi * (time_s - setting.strongest_s) / setting.period_s
    )
    course = math.radians(setting.to_deg)
    return speed_m_s * math.cos(course), speed_m_s * math.sin(course)
