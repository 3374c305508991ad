"""The bottom as a grid: depth, its 90 % band, and where nothing is known."""

import math
from dataclasses import dataclass
from typing import Final

import numpy as np
import shapely
from scipy.ndimage import distance_transform_edt
from scipy.spatial import cKDTree
from shapely.geometry.base import BaseGeometry

from mission_tools.bathymetry import kriging
from mission_tools.bathymetry.blocks import line_spacing_m, means, white_noise_m
from mission_tools.bathymetry.kriging import (
    BAND_SD,
    NEIGHBOURS,
    Calibration,
    Covariance,
    Data,
    HeldOut,
    Indices,
)
from mission_tools.bathymetry.soundings import Flags, Floats
from mission_tools.errors import UsageError
from mission_tools.geojson import SOLID
from mission_tools.maps.chart import Chart

GAP_SHARE: Final = 0.75  # of the line spacing: between half (covered) and a whole one (a line is missing)
BLOCK_SHARE: Final = 0.25  # of the line spacing: forty blocks then reach over three lines and a half
CELL_SHARE: Final = 0.2
TILE: Final = 4  # cells a side that share their neighbours
SHORE_SD_M: Final = 0.05  # of the depth at the shore line: half a metre of the map on a slope of one in ten
SHORE_DOUBT: Final = 0.5  # standard deviations of the fall to the first line, in what the shore line changes
MOST_CELLS: Final = 4_000_000


@dataclass(frozen=True, slots=True, eq=False)
class Grid:
    """West and north of its corner, side of a cell in metres; row 0 is the northernmost. is_water: of the
    cells' middles, (rows, columns), whole numbers of tiles.
    """

    west_m: float
    north_m: float
    cell_m: float
    is_water: Flags

    @classmethod
    def over(cls, water: BaseGeometry, cell_m: float) -> "Grid":
        """Over all of some water. Raises UsageError: too many cells."""
        west, south, east, north = water.bounds
        columns, rows = (math.ceil(side / cell_m / TILE) * TILE for side in (east - west, north - south))
        if columns * rows > MOST_CELLS:
            raise UsageError(
                f"--cell {cell_m:g}: {columns * rows} cells, at most {MOST_CELLS}: take larger ones"
            )
        shapely.prepare(water)
        grid = cls(west, north, cell_m, np.empty((rows, columns), dtype=bool))
        grid.is_water[:] = shapely.contains_xy(water, *np.meshgrid(*grid.middles))
        return grid

    @property
    def middles(self) -> tuple[Floats, Floats]:
        """East of the columns and north of the rows."""
        rows, columns = self.is_water.shape
        east = self.west_m + self.cell_m * np.arange(0.5, columns)
        return east, self.north_m - self.cell_m * np.arange(0.5, rows)

    def cells(self, east_m: Floats, north_m: Floats) -> tuple[Indices, Indices]:
        """Row and column of places, those outside of the grid at its edge."""
        rows, columns = self.is_water.shape
        row = np.floor((self.north_m - north_m) / self.cell_m).astype(np.intp)
        column = np.floor((east_m - self.west_m) / self.cell_m).astype(np.intp)
        return row.clip(0, rows - 1), column.clip(0, columns - 1)

    def tiles(self, chosen: Flags) -> tuple[Indices, Floats]:
        """The tiles with a chosen cell: indices (g, TILE²) of their cells, middles (g, TILE², 2)."""
        rows, columns = chosen.shape
        index = np.arange(rows * columns).reshape(rows // TILE, TILE, columns // TILE, TILE)
        tiles = index.swapaxes(1, 2).reshape(-1, TILE * TILE)
        tiles = tiles[chosen.ravel()[tiles].any(axis=1)]
        east, north = np.meshgrid(*self.middles)
        return tiles, np.stack((east.ravel()[tiles], north.ravel()[tiles]), axis=-1)


@dataclass(frozen=True, slots=True, eq=False)
class Surface:
    """depth_m, band_m: below the datum and half of the 90 % band, (rows, columns), NaN where not surveyed:
    farther than gap_m from every accepted sounding. white_m, line_m: standard deviation of a sounding's own
    noise, and of what a line errs as a whole (NaN: too few crossings).
    """

    grid: Grid
    depth_m: Floats
    band_m: Floats
    spacing_m: float
    gap_m: float
    white_m: float
    line_m: float


@dataclass(frozen=True, slots=True)
class SurfaceSettings:
    """cell_m, spacing_m, gap_m: None: from the lines. has_shore: the depth is 0 at the map's shore line.
    seed: of the places that are held out.
    """

    cell_m: float | None = None
    spacing_m: float | None = None
    gap_m: float | None = None
    has_shore: bool = True
    seed: int = 0


def interpolated(
    chart: Chart,
    east_m: Floats,
    north_m: Floats,
    depth_m: Floats,
    line_m: float,
    settings: SurfaceSettings,
    beam_rad: float = 0.0,
    position_sd_m: float = 0.0,
) -> Surface:
    """The surface from accepted soundings in the order of their times. beam_rad: full width of the sounder's
    cone; 0: none. position_sd_m: of a sounding's place, per axis. Raises UsageError: too few of them, or too
    many cells.
    """
    spacing = settings.spacing_m or line_spacing_m(east_m, north_m)
    if len(depth_m) < NEIGHBOURS or not np.isfinite(spacing):
        raise UsageError(
            f"{len(depth_m)} accepted soundings on lines without neighbours: expected at least {NEIGHBOURS} "
            "on two lines; see the reasons of those rejected, or give --spacing"
        )
    cell = settings.cell_m or max(round(CELL_SHARE * spacing, 1), 0.1)
    gap, white = settings.gap_m or GAP_SHARE * spacing, white_noise_m(depth_m)
    place, line_m2 = np.column_stack((east_m, north_m)), float(np.nan_to_num(line_m)) ** 2
    grid = Grid.over(sounded_water(chart, place, gap), cell)
    block = BLOCK_SHARE * spacing
    blocks, _ = means(east_m, north_m, depth_m, block, depth_m)
    own = Data(blocks.place, blocks.depth_m, white**2 / blocks.count + line_m2)
    shore = _shore_points(chart, 0.5 * spacing) if settings.has_shore else np.empty((0, 2))
    zero = np.zeros(len(shore))

    def with_shore(own: Data) -> Data:
        return Data(*map(np.concatenate, zip(own, (shore, zero, zero + SHORE_SD_M**2), strict=True)))

    data = with_shore(own)
    empty = np.ones(grid.is_water.shape, dtype=bool)
    empty[grid.cells(east_m, north_m)] = False
    away = cell * distance_transform_edt(empty)
    known = grid.is_water & (away <= gap)
    rng = np.random.default_rng(settings.seed)
    held = []
    for count, radius in ((kriging.CHOSEN_ON, 0.5 * cell), (kriging.SCALED_ON, 0.25 * cell)):
        chosen = rng.choice(len(place), min(count, len(place)), replace=False)
        groups = cKDTree(place).query_ball_point(place[chosen], radius)
        noise = np.array([white**2 / len(group) + line_m2 for group in groups])
        middle = np.array([place[group].mean(axis=0) for group in groups])
        one = Data(middle, np.array([depth_m[group].mean() for group in groups]), noise)
        apart = np.maximum(rng.choice(away[known], len(chosen)), block)  # its own block always is left out
        held.append(HeldOut(one, apart))
    model = kriging.fitted(data, held[0], spacing, kriging.semivariance_m2(own, spacing))
    calibration = Calibration(data, model, held[1])
    if beam_rad:
        sloped, _ = _filled(data, model, calibration, grid, known)
        own = own._replace(depth_m=own.depth_m * below_m_per_m(sloped, grid, own.place, 0.5 * beam_rad))
    depth, band = _filled(with_shore(own), model, calibration, grid, known)
    if len(shore):
        bare, _ = _filled(own, model, calibration, grid, known)
        band = np.hypot(band, SHORE_DOUBT * BAND_SD * np.abs(depth - bare))
    # The depth is that of a place which is off by so much (R. Hare, Int. Hydrographic Review 72, 1995)
    band = np.hypot(band, BAND_SD * position_sd_m * _slopes(depth, grid))
    return Surface(grid, depth, band, spacing, gap, white, line_m)


def below_m_per_m(depth_m: Floats, grid: Grid, place: Floats, half_beam_rad: float) -> Floats:
    """Depth below each place, over the range of the first echo: on a slope that comes from up the slope.

    A plane of slope α is met at a right angle, at D cos α, if that is within the cone, else on its edge.
    """
    slope = _slopes(depth_m, grid)[grid.cells(*place.T)]
    within = 1.0 / np.cos(np.arctan(slope))
    at_edge = math.cos(half_beam_rad) + math.sin(half_beam_rad) * slope
    return np.asarray(np.where(slope <= math.tan(half_beam_rad), within, at_edge))


def _slopes(depth_m: Floats, grid: Grid) -> Floats:
    """The slope at each cell, also at the edge of what is known."""
    _, (row, column) = distance_transform_edt(np.isnan(depth_m), return_indices=True)
    return np.asarray(np.hypot(*np.gradient(depth_m[row, column], grid.cell_m)))


def _filled(
    data: Data, model: Covariance, calibration: Calibration, grid: Grid, known: Flags
) -> tuple[Floats, Floats]:
    tiles, middles = grid.tiles(known)
    _, near = cKDTree(data.place).query(middles.mean(axis=1), k=min(NEIGHBOURS, len(data.place)))
    found, variance = kriging.predict(data, model, middles, near)
    variance *= calibration.factor(middles.mean(axis=1))[:, None]
    depth, band = np.full(known.size, np.nan), np.full(known.size, np.nan)
    depth[tiles], band[tiles] = found, BAND_SD * np.sqrt(variance)
    unknown = ~known.ravel()
    depth[unknown] = band[unknown] = np.nan
    return depth.reshape(known.shape), band.reshape(known.shape)


def sounded_water(chart: Chart, place: Floats, margin_m: float) -> BaseGeometry:
    """The water of a chart; of the sea what is near soundings. Raises UsageError: no sounding lies on it."""
    near = shapely.box(*place.min(axis=0), *place.max(axis=0)).buffer(margin_m)
    if not chart.water.intersects(shapely.multipoints(place[:: max(len(place) // 1000, 1)])):
        raise UsageError(f"{chart.name}: no sounding lies on its water: give the map of the surveyed lake")
    return chart.water.intersection(near) if chart.is_open else chart.water


def _shore_points(chart: Chart, step_m: float) -> Floats:
    """Places along the shore, (n, 2). Piers, rafts and obstacles stand in water: the depth there is not 0."""
    if chart.is_open:
        return np.empty((0, 2))
    built = [one.shape for one in chart.features if one.kind in SOLID and one.kind != "island"]
    shore = chart.water.boundary.difference(shapely.union_all(built).buffer(0.5))
    lines = [line for line in shapely.get_parts(shore) if line.length > 0.0]
    at = [line.interpolate(np.arange(0.0, line.length, step_m)) for line in lines]
    return shapely.get_coordinates(np.concatenate(at)) if at else np.empty((0, 2))
