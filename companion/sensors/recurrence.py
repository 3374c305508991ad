"""Detects an event that recurs: running share of the observations that show it."""


class Recurrence:
    """is_often: with hysteresis, set above too_often and cleared below seldom."""

    def __init__(self, share: float, too_often: float, seldom: float) -> None:
        """share: weight of one observation in the running mean."""
        self.is_often = False
        self._mean = 0.0
        self._share, self._too_often, self._seldom = share, too_often, seldom

    def update(self, happens: bool) -> None:
        """Add an observation: whether the event happens."""
        self._mean += self._share * (happens - self._mean)
        if self._mean > self._too_often:
            self.is_often = True
        elif self._mean < self._seldom:
            self.is_often = False
