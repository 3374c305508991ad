"""Faults of the boat's parts: what can go wrong, when it does, and what it does to the part."""

from sitl.faults.catalogue import CATALOGUE, FaultSetting
from sitl.faults.schedule import Faults

__all__ = ["CATALOGUE", "FaultSetting", "Faults"]
