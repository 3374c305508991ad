"""From soundings to a chart and its figures."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Final

import numpy as np
import shapely
from shapely.geometry.base import BaseGeometry

from mission_tools.bathymetry.blocks import along_track_m, thinned, white_noise_m
from mission_tools.bathymetry.cleaning import CleaningSettings, Codes, cleaned, counts
from mission_tools.bathymetry.crossings import GAP_M, LEAST, Crossings, crossings
from mission_tools.bathymetry.kriging import BAND_SD
from mission_tools.bathymetry.reduction import Corrections, Reduced, reduced
from mission_tools.bathymetry.s44 import ORDERS, tvu_m
from mission_tools.bathymetry.soundings import Flags, Floats, Soundings
from mission_tools.bathymetry.surface import Surface, SurfaceSettings, interpolated, sounded_water
from mission_tools.errors import UsageError
from mission_tools.maps.chart import Chart

CONFIDENCE: Final = 0.95  # at which S-44 states its uncertainties
CONFIDENCE_SD: Final = 1.96  # half of that band of a normal distribution
HYPSOGRAPHY: Final = 20  # levels between the surface and the deepest place
_TRACK_STEP_M: Final = 1.0
_LINE_POINTS: Final = 50  # of a piece of track that is widened at once: long lines that cross are slow


@dataclass(frozen=True, slots=True)
class ChartSettings:
    """clearance_m: what a boat keeps from shores; nearer water is not reachable. order: of S-44, to compare
    with. level_m: above the datum, below which the volume is.
    """

    corrections: Corrections = field(default_factory=Corrections)
    cleaning: CleaningSettings = field(default_factory=CleaningSettings)
    surface: SurfaceSettings = field(default_factory=SurfaceSettings)
    clearance_m: float = 4.0
    order: str = "1b"
    level_m: float = 0.0


@dataclass(frozen=True, slots=True, eq=False)
class DepthChart:
    """A charted lake.

    unknown: water farther than the surface's gap_m from every accepted sounding; gaps: what of it a boat can
    reach. coverage: share of the reachable water within half a line spacing.
    """

    chart: Chart
    soundings: Soundings
    at: Reduced
    codes: Codes
    surface: Surface
    crossings: Crossings
    unknown: BaseGeometry
    gaps: BaseGeometry
    coverage: float
    settings: ChartSettings

    @property
    def accepted(self) -> Flags:
        """Which soundings the chart is made of."""
        flags: Flags = self.codes == 0
        return flags

    def below(self, level_m: float) -> tuple[float, float]:
        """Area (m²) and volume (m³) of the surveyed water below a level above the datum."""
        depth = self.surface.depth_m[np.isfinite(self.surface.depth_m)] + level_m
        return self._cell_m2 * float((depth > 0.0).sum()), self._cell_m2 * float(depth[depth > 0.0].sum())

    @property
    def _cell_m2(self) -> float:
        """The water's area for each of its cells: those that the shore cuts are in by their middle."""
        if self.chart.is_open:
            return self.surface.grid.cell_m**2
        return float(self.chart.water.area / self.surface.grid.is_water.sum())

    def hypsography(self) -> tuple[Floats, Floats]:
        """Depths from 0 to the deepest, and the area (m²) at least as deep."""
        depths = np.linspace(0.0, float(np.nanmax(self.surface.depth_m)), HYPSOGRAPHY + 1)
        return depths, np.array([self.below(-depth)[0] for depth in depths])

    def figures(self) -> Mapping[str, Any]:
        """All figures, as chart.json has them; SI units, shares from 0 to 1; None: not measured."""
        surface, known = self.surface, np.isfinite(self.surface.depth_m)
        area, volume = self.below(self.settings.level_m)
        depth, band = surface.depth_m[known], surface.band_m[known]
        difference = np.abs(self.crossings.difference_m)
        allowed = tvu_m(self.settings.order, depth)
        within = {order: self.crossings.within(order) for order in ORDERS}
        levels, areas = self.hypsography()
        return {
            "name": self.chart.name,
            "logs": list(self.soundings.names),
            "soundings": counts(self.codes),
            "sound_m_s": round(self.at.sound_m_s, 2),
            "sound_source": self.at.sound_source,
            "line_spacing_m": round(surface.spacing_m, 2),
            "cell_m": surface.grid.cell_m,
            "sounding_noise_m": round(surface.white_m, 4),
            "line_error_m": _number(surface.line_m),
            "level_m": self.settings.level_m,
            "area_m2": round(area, 1),
            "volume_m3": round(volume, 1),
            "volume_m3_per_cm": round(0.01 * area, 1),
            "mean_depth_m": _number(volume / area) if area else None,
            "max_depth_m": _number(float(depth.max()) + self.settings.level_m),
            "surveyed_share": _number(float(known.sum() / surface.grid.is_water.sum())),
            "band_median_m": _number(_quantile(band, 0.5)),
            "band_95_m": _number(_quantile(band, 0.95)),
            "coverage": _number(self.coverage),
            "gap_distance_m": round(surface.gap_m, 2),
            "gaps": int(shapely.get_num_geometries(self.gaps)),
            "gaps_m2": round(float(self.gaps.area), 1),
            "crossings": len(difference),
            "crossings_median_m": _number(_quantile(difference, 0.5)),
            "crossings_95_m": _number(_quantile(difference, CONFIDENCE)),
            "within_order": {order: _number(share) for order, share in within.items()},
            "order": self.settings.order,
            "meets_order": len(difference) >= LEAST and within[self.settings.order] >= CONFIDENCE,
            "cells_within_order": _number(float(np.mean(band * CONFIDENCE_SD / BAND_SD <= allowed))),
            "hypsography": [
                {"depth_m": round(a, 3), "area_m2": round(b, 1)} for a, b in zip(levels, areas, strict=True)
            ],
        }


def charted(chart: Chart, soundings: Soundings, settings: ChartSettings) -> DepthChart:
    """Reduce, clean and interpolate. Raises UsageError: the soundings make no chart."""
    at = reduced(soundings, chart.frame.origin, settings.corrections)
    codes = cleaned(soundings, at, None if chart.is_open else chart.water, settings.cleaning)
    own = codes == 0
    if not own.any():
        told = ", ".join(f"{count} {reason}" for reason, count in counts(codes).items() if count)
        raise UsageError(f"no sounding can be charted ({told}): give the map of the lake, look at the logs")
    east, north, depth = at.east_m[own], at.north_m[own], at.depth_m[own]
    crossed = crossings(east, north, depth, soundings.unix_s[own])
    line_m = crossed.line_sd_m(white_noise_m(depth))
    known_m = soundings.position_sd_m[own & np.isfinite(soundings.position_sd_m)]
    position_sd_m = float(np.median(known_m)) if len(known_m) else 0.0
    beam_rad = settings.corrections.beam_rad
    surface = interpolated(chart, east, north, depth, line_m, settings.surface, beam_rad, position_sd_m)
    water = sounded_water(chart, np.column_stack((east, north)), surface.gap_m)
    reachable = chart.navigable.intersection(water).buffer(-settings.clearance_m)
    unknown = water.difference(_swath(east, north, surface.gap_m))
    parts = shapely.get_parts(unknown.intersection(reachable).simplify(0.25 * surface.grid.cell_m))
    gaps = shapely.MultiPolygon(
        [part for part in parts if part.area > surface.spacing_m * surface.grid.cell_m]
    )
    covered = reachable.intersection(_swath(east, north, 0.5 * surface.spacing_m)).area
    coverage = float(covered / reachable.area) if reachable.area else float("nan")
    return DepthChart(chart, soundings, at, codes, surface, crossed, unknown, gaps, coverage, settings)


def _swath(east_m: Floats, north_m: Floats, radius_m: float) -> BaseGeometry:
    """What lies within a radius of the track through soundings; not between those that are far apart."""
    keep = thinned(along_track_m(east_m, north_m), _TRACK_STEP_M)
    place = np.column_stack((east_m, north_m))[keep]
    piece = np.cumsum(np.hypot(*np.diff(place, axis=0, prepend=place[:1]).T) > GAP_M)
    piece = piece * len(keep) + np.arange(len(keep)) // _LINE_POINTS
    _, number, count = np.unique(piece, return_inverse=True, return_counts=True)
    lines = count[number] > 1
    _, number = np.unique(number[lines], return_inverse=True)
    return shapely.union_all(shapely.buffer(shapely.linestrings(place[lines], indices=number), radius_m))


def _quantile(values: Floats, share: float) -> float:
    return float(np.quantile(values, share)) if len(values) else float("nan")


def _number(value: float) -> float | None:
    """Rounded to a tenth of a millimetre or per mille; None of NaN, which JSON does not have."""
    return round(value, 4) if np.isfinite(value) else None
