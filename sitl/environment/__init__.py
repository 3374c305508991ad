"""What surrounds the hull: the water's own motion and the wind."""

from sitl.environment.settings import Environment
from sitl.environment.wind import Wind

__all__ = ["Environment", "Wind"]
