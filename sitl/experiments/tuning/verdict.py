"""Whether gains that were found are better than those of before, on runs that the search has not seen."""

import math
from collections.abc import Sequence
from statistics import fmean, stdev
from typing import NamedTuple


class TuningVerdict(NamedTuple):
    """ratio: the mean of costs relative to the baseline; doubt: two standard errors of that mean."""

    ratio: float
    doubt: float

    @property
    def is_better(self) -> bool:
        """Beyond doubt; chance alone says so once in forty times."""
        return self.ratio + self.doubt < 1.0


def judge(ratios: Sequence[float]) -> TuningVerdict:
    """ratios: of the costs of at least two runs, in the same water with the same seed."""
    return TuningVerdict(fmean(ratios), 2.0 * stdev(ratios) / math.sqrt(len(ratios)))
