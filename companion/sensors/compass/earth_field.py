"""The earth's magnetic field where the boat is, from the world magnetic model (WMM) of NOAA and BGS.

The model is valid for five years and is good for about half a degree of declination; after its end the error
grows by a few tenths of a degree a year in most places.
"""

import logging
import math
from datetime import UTC, datetime
from typing import Final

from msgspec import Struct
from pygeomag import GeoMag

from companion.core.geo import LatLon
from companion.core.status_text import Severity, StatusText

_log = logging.getLogger(__name__)

_MG_PER_NT: Final = 0.01
_FAR_DEG: Final = 0.1  # 11 km, over which the declination changes by less than 0.1° but near the poles
_LATER_S: Final = 86400.0
_LEAST_MG: Final = 20.0  # WMM's blackout zones round the magnetic poles: no compass works there


class EarthField(Struct, frozen=True):
    """declination_rad: from true to magnetic north, east positive. horizontal_mg, down_mg: strength."""

    declination_rad: float
    horizontal_mg: float
    down_mg: float


class EarthFieldModel:
    """The field at the boat. `field` is None until a position and a date are known."""

    def __init__(self) -> None:
        self.field: EarthField | None = None
        self._model = GeoMag()
        self._position: LatLon | None = None
        self._unix_s = 0.0

    def load(self) -> None:
        """Load the coefficients, which takes some ticks on a Pi."""
        self._model.calculate(0.0, 0.0, 0.0, self._model.life_span[0])

    def update(self, position: LatLon, unix_s: float) -> list[StatusText]:
        """Call at any rate; it calculates again when the boat is far from the last place, or a day later.
        unix_s: 0 if unknown. Returns what to tell the operator.
        """
        if unix_s <= 0.0 or not self._is_due(position, unix_s):
            return []
        is_first = self._position is None
        self._position, self._unix_s = position, unix_s
        year = decimal_year(unix_s)
        found = self._model.calculate(
            position.lat_deg, position.lon_deg, 0.0, year, allow_date_outside_lifespan=True
        )
        declination_deg = float(found.d)
        self.field = EarthField(math.radians(declination_deg), found.h * _MG_PER_NT, found.z * _MG_PER_NT)
        _log.info("declination %.2f° (%s, %.2f)", declination_deg, self._model.model, year)
        if not is_first:
            return []
        side = "east" if declination_deg >= 0.0 else "west"
        text = f"Compass: declination {abs(declination_deg):.1f} degrees {side} ({self._model.model})"
        texts = [StatusText(Severity.INFO, text)]
        begin, end = self._model.life_span
        if not begin <= year < end:
            told = f"Compass: {self._model.model} is for {begin:.0f} to {end:.0f}; update the boat's software"
            texts.append(StatusText(Severity.WARNING, told))
        if self.field.horizontal_mg < _LEAST_MG:
            texts.append(StatusText(Severity.WARNING, "Compass: too near a magnetic pole"))
        return texts

    def _is_due(self, position: LatLon, unix_s: float) -> bool:
        before = self._position
        return (
            before is None
            or abs(unix_s - self._unix_s) > _LATER_S
            or abs(position.lat_deg - before.lat_deg) > _FAR_DEG
            or abs((position.lon_deg - before.lon_deg + 180.0) % 360.0 - 180.0) > _FAR_DEG
        )


def decimal_year(unix_s: float) -> float:
    """The date as a year and its fraction."""
    date = datetime.fromtimestamp(unix_s, UTC)
    begin = datetime(date.year, 1, 1, tzinfo=UTC)
    end = datetime(date.year + 1, 1, 1, tzinfo=UTC)
    return date.year + (date - begin) / (end - begin)
