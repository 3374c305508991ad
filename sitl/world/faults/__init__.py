"""Faults of the boat's parts: what can go wrong, when it does, and what it does to the part."""
