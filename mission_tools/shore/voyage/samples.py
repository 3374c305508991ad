"""A voyage's samples, thinned while they are read, so that a long log takes no more memory."""

from typing import Final, NamedTuple

from mission_tools.station.geojson import apart_m

MOST_SAMPLES: Final = 2000


class Sample(NamedTuple):
    """At a position of the log. None: not known then."""

    at_s: float
    lon: float
    lat: float
    speed_m_s: float | None
    wanted_m_s: float | None
    voltage_v: float | None
    percent: float | None
    obstacle_m: float | None


class Samples:
    """Every n-th sample, and the length of the way through all of them.

    step_m: a shorter movement is not counted until it adds up: noise would lengthen the way.
    """

    def __init__(self, step_m: float) -> None:
        self.distance_m = 0.0
        self.kept: list[Sample] = []
        self._step_m = step_m
        self._every = 1
        self._count = 0
        self._last: Sample | None = None
        self._counted: tuple[float, float] | None = None

    def add(self, sample: Sample) -> None:
        """The next one. What is not later than the one before is left out."""
        if self._last is not None and sample.at_s <= self._last.at_s:
            return
        self._last = sample
        here = sample.lon, sample.lat
        moved_m = 0.0 if self._counted is None else apart_m(self._counted, here)
        if self._counted is None or moved_m >= self._step_m:
            self._counted = here
            self.distance_m += moved_m
        if self._count % self._every == 0:
            self.kept.append(sample)
        self._count += 1
        if len(self.kept) >= MOST_SAMPLES:
            del self.kept[1::2]
            self._every *= 2

    def finish(self) -> list[Sample]:
        """Those kept, with the last one."""
        if self._last is not None and self.kept[-1] is not self._last:
            self.kept.append(self._last)
        return self.kept
