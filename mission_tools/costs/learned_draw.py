"""What a boat draws at which speed through the water, from logs of its voyages.

Stretches of STRETCH_S at a steady speed give a mean speed and a mean current, which are sorted into bands of
speed. Where a faster band draws less than a slower one, both become their mean (isotonic regression by
pooling adjacent violators: Ayer and others, *An empirical distribution function for sampling with incomplete
information*, Annals of Mathematical Statistics 26, 1955).
"""

import math
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Final, NamedTuple

from mission_tools.errors import MapError
from mission_tools.files.dataflash import Log

STRETCH_S: Final = 10.0
"""Longer than the boat takes to follow a change of thrust, and a few waves."""
STEADY_SHARE: Final = 0.15
"""How much the speed may vary in a stretch, of its mean: noise of the estimate, and waves."""
BAND: Final = 1.12
"""Fastest over slowest speed of a band."""
_FEWEST: Final = 2  # stretches in a band
_FRESH_S: Final = 2.0  # an older speed is not that of a current
_SLOWEST_SHARE: Final = 0.1  # of the fastest: a boat that drifts says nothing about its motors
_WANTED: Final = {
    "BAT": ("TimeUS", "Curr", "Inst"),
    "XKF1": ("TimeUS", "VN", "VE", "C"),
    "EST": ("TimeUS", "CurN", "CurE"),
}


class Stretch(NamedTuple):
    """At a steady speed through the water."""

    speed_m_s: float
    drawn_a: float


class LearnedDraw(NamedTuple):
    """pairs: speed in m/s and current in A, as [battery] draw wants them. steady_s: seen at steady speeds."""

    pairs: tuple[tuple[float, float], ...]
    steady_s: float

    def lines(self, cruise_m_s: float) -> list[str]:
        """As TOML for the boat's file."""
        pairs = ", ".join(f"[{speed_m_s:.3g}, {drawn_a:.3g}]" for speed_m_s, drawn_a in self.pairs)
        lines = ["[battery]", f"draw = [{pairs}]  # m/s through still water, A; from {self.steady_s:.0f} s"]
        if self.pairs[-1][0] < cruise_m_s:
            lines.append(
                f"# slower than {cruise_m_s:g} m/s, the cruise speed: sail faster, up to full throttle"
            )
        return lines


def learn_draw(logs: Sequence[Path], idle_a: float = 0.0) -> LearnedDraw:
    """The draw of a boat by its logs in ArduPilot's DataFlash format. idle_a: with the motors stopped. Raises
    MapError: a log that cannot be read, or no steady speed in any.
    """
    found = sorted(stretch for log in logs for stretch in _stretches(log) if stretch.drawn_a > idle_a)
    fastest_m_s = found[-1].speed_m_s if found else 0.0
    bands: list[list[Stretch]] = []
    for stretch in found:
        if stretch.speed_m_s < _SLOWEST_SHARE * fastest_m_s:
            continue
        if not bands or stretch.speed_m_s > BAND * bands[-1][0].speed_m_s:
            bands.append([])
        bands[-1].append(stretch)
    pooled: list[list[Stretch]] = []
    for band in (band for band in bands if len(band) >= _FEWEST):
        pooled.append(band)
        while len(pooled) > 1 and _mean(pooled[-1]).drawn_a <= _mean(pooled[-2]).drawn_a:
            pooled[-2:] = [[*pooled[-2], *pooled[-1]]]
    if not pooled:
        raise MapError(
            f"{', '.join(map(str, logs))}: no speed that was steady for {_FEWEST * STRETCH_S:.0f} s, with a "
            "current (BAT) and a velocity (XKF1): sail straight legs at several speeds"
        )
    return LearnedDraw(tuple(map(_mean, pooled)), STRETCH_S * sum(map(len, pooled)))


def _mean(band: Sequence[Stretch]) -> Stretch:
    speeds, currents = zip(*band, strict=True)
    return Stretch(math.fsum(speeds) / len(band), math.fsum(currents) / len(band))


def _stretches(log: Path) -> Iterator[Stretch]:
    """Of one log, one after the other."""
    try:
        data = log.read_bytes()
    except OSError as error:
        raise MapError(f"{log}: cannot be read: {error.strerror}") from None
    stretch: list[Stretch] = []
    begun_s = -math.inf
    for at_s, sample in _samples(data):
        if at_s - begun_s > STRETCH_S:
            if stretch and begun_s + STRETCH_S + _FRESH_S > at_s:
                mean_m_s, drawn_a = _mean(stretch)
                speeds = [one.speed_m_s for one in stretch]
                if max(speeds) - min(speeds) <= STEADY_SHARE * mean_m_s:
                    yield Stretch(mean_m_s, drawn_a)
            begun_s, stretch = at_s, []
        stretch.append(sample)


def _samples(data: bytes) -> Iterator[tuple[float, Stretch]]:
    """Seconds since boot, and the speed through the water at each reading of the current."""
    flow, velocity, known_s = (0.0, 0.0), (0.0, 0.0), -math.inf
    for name, (time_us, *values) in Log(data, _WANTED).records():
        one, other = values[:2]
        if not (isinstance(time_us, int | float) and isinstance(one, int | float)):
            continue
        at_s = 1e-6 * time_us
        if name == "BAT" and not other:
            if at_s - known_s < _FRESH_S:
                yield at_s, Stretch(math.hypot(velocity[0] - flow[0], velocity[1] - flow[1]), one)
        elif not isinstance(other, int | float):
            continue
        elif name == "EST":
            flow = one, other
        elif name == "XKF1" and not values[2]:
            velocity, known_s = (one, other), at_s
