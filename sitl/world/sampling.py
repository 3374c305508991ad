"""When sensors sample, and where their random numbers come from."""

import random
from statistics import NormalDist
from typing import Annotated

from msgspec import Meta

EPOCH_UNIX_S = 1_767_225_600.0  # the simulated day is 1 January 2026, so that runs do not depend on the date
TIME_SLACK_S = 1e-6  # a sample that is due this soon is taken now: tick × dt need not hit a period exactly


# White noise for sensors that sample at every tick: NORMAL[int(NORMALS * random())] is a standard normal
# deviate at a third of the price of Random.gauss. The quantiles end at 3.7 deviations.
NORMALS = 4096
NORMAL = tuple(NormalDist().inv_cdf((number + 0.5) / NORMALS) for number in range(NORMALS))


MOST_SEED = 2**62
"""What is counted up from a seed, run by run, still fits the 64 bits of a record."""
Seed = Annotated[int, Meta(ge=-MOST_SEED, le=MOST_SEED)]


def generator(seed: int, name: str) -> random.Random:
    """A sensor's own random numbers."""
    return random.Random(f"{seed}/{name}")  # a string is hashed whole, and the same way in every process


def normal(numbers: random.Random) -> float:
    """A standard normal deviate."""
    return NORMAL[int(NORMALS * numbers.random())]
