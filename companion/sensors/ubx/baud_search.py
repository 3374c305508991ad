"""Candidates for the baud rate of a receiver."""

from typing import Final

# Factory rates (u-blox 9: 38,400; before: 9600), then those that people set
BAUD_RATES: Final = (9600, 38400, 115200, 57600, 230400, 19200, 460800, 4800)


class BaudSearch:
    """Goes round all rates, the present one first, then the wanted one."""

    def __init__(self, present: int | None, wanted: int | None) -> None:
        """None for a line without a baud rate."""
        self._rates: list[int | None] = [present]
        if present is not None:
            others = dict.fromkeys((wanted, *BAUD_RATES))
            self._rates += [rate for rate in others if rate != present]
        self._tried = 0

    def next(self) -> int | None:
        """The candidate after the present one."""
        self._tried += 1
        return self._rates[self._tried % len(self._rates)]

    @property
    def is_round(self) -> bool:
        """Whether all rates have been tried equally often."""
        return self._tried % len(self._rates) == 0
