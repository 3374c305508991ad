"""What surrounds the hull: the water's own motion, wind and waves."""

from sitl.environment.current import Current
from sitl.environment.settings import Environment, Gyre, River, Tide
from sitl.environment.waves import Waves
from sitl.environment.wind import Wind

__all__ = ["Current", "Environment", "Gyre", "River", "Tide", "Waves", "Wind"]
