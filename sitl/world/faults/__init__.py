"""Faults of the boat's parts: what can go wrong, when it does, and what it does to the part."""

from sitl.world.faults.catalogue import CATALOGUE, FaultSetting
from sitl.world.faults.schedule import Faults

__all__ = ["CATALOGUE", "FaultSetting", "Faults"]
