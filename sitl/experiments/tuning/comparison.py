"""Whether tuned gains are better than the original ones, on seeds that the search did not use."""

import math
from collections.abc import Sequence
from statistics import fmean, stdev
from typing import NamedTuple


class GainComparison(NamedTuple):
    """ratio: the mean of costs relative to the baseline; uncertainty: two standard errors of that mean."""

    ratio: float
    uncertainty: float

    @property
    def is_better(self) -> bool:
        """Significantly better; a false positive once in forty times."""
        return self.ratio + self.uncertainty < 1.0


def compare(ratios: Sequence[float]) -> GainComparison:
    """ratios: of the costs of at least two runs, in the same water with the same seed."""
    return GainComparison(fmean(ratios), 2.0 * stdev(ratios) / math.sqrt(len(ratios)))
