"""Simulated receivers: from the truth to what the boat's parts would have said, by tick and seed alone.

Each sensor owns a random number generator seeded by the scenario's seed and the sensor's name, so that a
sensor more or less never shifts what another one hears. Settings are in the units of a scenario file
(degrees); everything handed on is in SI and radians.
"""
