"""Whether something that may happen once happens again and again: the running share of looks that show it."""


class Recurrence:
    """is_often: from when it is shown by more than too_often of the looks until by less than seldom."""

    __slots__ = ("_mean", "_seldom", "_share", "_too_often", "is_often")

    def __init__(self, share: float, too_often: float, seldom: float) -> None:
        """share: of one look in the running mean."""
        self.is_often = False
        self._mean = 0.0
        self._share, self._too_often, self._seldom = share, too_often, seldom

    def update(self, happens: bool) -> None:
        """Take the next look."""
        self._mean += self._share * (happens - self._mean)
        if self._mean > self._too_often:
            self.is_often = True
        elif self._mean < self._seldom:
            self.is_often = False
