"""What surrounds the hull: the water's own motion, wind and waves."""

from sitl.world.environment.current import Current
from sitl.world.environment.settings import Environment, Gyre, River, Tide
from sitl.world.environment.waves import Waves
from sitl.world.environment.wind import Wind

__all__ = ["Current", "Environment", "Gyre", "River", "Tide", "Waves", "Wind"]
