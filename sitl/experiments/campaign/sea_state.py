"""The waves that the runs of a campaign draw: none, ripples of a pond and a lake's fetch in a breeze."""

import math
from typing import Any, Final

from sitl.world.sampling import generator

HEIGHTS_M: Final = (0.0, 0.1, 0.3)
PERIODS_S: Final = (1.8, 3.0)


def draw_waves(seed: int) -> dict[str, Any]:
    """Settings of a scenario, the same for every run with this seed. Waves come from any direction."""
    random = generator(seed, "campaign/waves")
    height_m, period_s = random.choice(HEIGHTS_M), random.choice(PERIODS_S)
    from_deg = math.degrees(random.uniform(0.0, math.tau))
    return {"environment": {"wave_height_m": height_m, "wave_period_s": period_s, "wave_from_deg": from_deg}}
