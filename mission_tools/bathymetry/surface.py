"""The bottom as a grid: depth, its 90 % band, and where nothing is known."""

from dataclasses import dataclass
from typing import Final

import numpy as np
import shapely
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt
from scipy.spatial import cKDTree

from mission_tools.bathymetry import kriging
from mission_tools.bathymetry.blocks import line_spacing_m, means, white_noise_m
from mission_tools.bathymetry.kriging import BAND_SD, NEIGHBOURS, Calibration, Covariance, Data
from mission_tools.bathymetry.soundings import Floats
from mission_tools.errors import UsageError
from mission_tools.geojson import SOLID
from mission_tools.maps.chart import Chart

GAP_SHARE: Final = 0.75  # of the line spacing: between half (covered) and a whole one (a line is missing)
BLOCK_SHARE: Final = 0.25  # of the line spacing: forty blocks then reach over five lines
CELL_SHARE: Final = 0.2
TILE: Final = 4  # cells a side that share their neighbours
SHORE_SD_M: Final = 0.1  # of the depth at the shore line: a metre of the map on a slope of one in ten
MOST_CELLS: Final = 4_000_000


@dataclass(frozen=True, slots=True, eq=False)
class Surface:
    """Arrays of shape (rows, columns), north up: row 0 is the northernmost.

    west_m, north_m: of the grid's corner; cell_m: side of a cell. is_water: by the cell's middle. depth_m,
    band_m: below the datum and half of the 90 % band, NaN where not surveyed. away_m: distance to the nearest
    accepted sounding. white_m, line_m: standard deviation of a sounding's own noise, and of what a line
    errs as a whole (NaN: no crossings).
    """

    west_m: float
    north_m: float
    cell_m: float
    is_water: NDArray[np.bool_]
    depth_m: Floats
    band_m: Floats
    away_m: Floats
    spacing_m: float
    gap_m: float
    white_m: float
    line_m: float
    model: Covariance
    scale: float

    @property
    def middles(self) -> tuple[Floats, Floats]:
        """East of the columns and north of the rows."""
        rows, columns = self.depth_m.shape
        east = self.west_m + self.cell_m * np.arange(0.5, columns)
        return east, self.north_m - self.cell_m * np.arange(0.5, rows)


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
    chart: Chart, east_m: Floats, north_m: Floats, depth_m: Floats, line_m: float, settings: SurfaceSettings
) -> Surface:
    """The surface from accepted soundings in the order of their times. Raises UsageError: too few of them, or
    too many cells.
    """
    spacing = settings.spacing_m or line_spacing_m(east_m, north_m)
    if len(depth_m) < NEIGHBOURS or not np.isfinite(spacing):
        raise UsageError(
            f"{len(depth_m)} accepted soundings on lines without neighbours: expected at least {NEIGHBOURS} "
            "on two lines; see the reasons of those rejected, or give --spacing"
        )
    cell = settings.cell_m or max(round(CELL_SHARE * spacing, 1), 0.1)
    gap = settings.gap_m or GAP_SHARE * spacing
    grid = _Grid.over(chart, east_m, north_m, cell, gap)
    white = white_noise_m(depth_m)
    block = BLOCK_SHARE * spacing
    blocks, _ = means(east_m, north_m, depth_m, block, depth_m)
    own = Data(blocks.place, blocks.depth_m, white**2 / blocks.count + np.nan_to_num(line_m) ** 2)
    shore = _shore_points(chart, 0.5 * spacing) if settings.has_shore else np.empty((0, 2))
    zero = np.zeros(len(shore))
    data = Data(
        np.concatenate((own.place, shore)),
        np.concatenate((own.depth_m, zero)),
        np.concatenate((own.noise_m2, zero + SHORE_SD_M**2)),
    )
    away = _away(grid, east_m, north_m)
    known = grid.is_water & (away <= gap)
    if not known.any():
        raise UsageError(
            f"{chart.name}: no sounding lies on its water; expected the map of the surveyed lake"
        )
    rng = np.random.default_rng(settings.seed)
    place, line_sd = np.column_stack((east_m, north_m)), float(np.nan_to_num(line_m))
    held = []
    for count, radius in ((kriging.CHOSEN_ON, 0.5 * cell), (kriging.SCALED_ON, 0.25 * cell)):
        chosen = rng.choice(len(place), min(count, len(place)), replace=False)
        one = _held_out(place, depth_m, radius, white, line_sd, chosen)
        apart = np.maximum(rng.choice(away[known], len(chosen)), block)  # its own block always is left out
        held.append(kriging.HeldOut(one, apart))
    model = kriging.fitted(data, held[0], spacing, kriging.semivariance_m2(own, spacing))
    calibration = Calibration(data, model, held[1])
    depth, band = _filled(data, model, calibration, grid, known)
    return Surface(
        grid.west_m,
        grid.north_m,
        cell,
        grid.is_water,
        depth,
        band,
        away,
        spacing,
        gap,
        white,
        line_m,
        model,
        calibration.scale,
    )


@dataclass(frozen=True, slots=True, eq=False)
class _Grid:
    west_m: float
    north_m: float
    cell_m: float
    is_water: NDArray[np.bool_]

    @classmethod
    def over(cls, chart: Chart, east_m: Floats, north_m: Floats, cell_m: float, margin_m: float) -> "_Grid":
        """Over the water, of the sea only where it was sounded; sides are whole numbers of tiles."""
        bounds = (east_m.min(), north_m.min(), east_m.max(), north_m.max())
        area = shapely.box(*bounds).buffer(margin_m)
        water = chart.water.intersection(area) if chart.is_open else chart.water
        if water.is_empty:
            raise UsageError(
                f"{chart.name}: no sounding lies on its water; expected the map of the surveyed lake"
            )
        west, south, east, north = water.bounds
        side = cell_m * TILE
        columns, rows = int(np.ceil((east - west) / side)) * TILE, int(np.ceil((north - south) / side)) * TILE
        if columns * rows > MOST_CELLS:
            raise UsageError(
                f"--cell {cell_m:g}: {columns * rows} cells, at most {MOST_CELLS}; take a larger cell"
            )
        x = west + cell_m * (np.arange(columns) + 0.5)
        y = north - cell_m * (np.arange(rows) + 0.5)
        shapely.prepare(water)
        return cls(west, north, cell_m, shapely.contains_xy(water, *np.meshgrid(x, y)))

    def groups(self, chosen: NDArray[np.bool_]) -> tuple[NDArray[np.intp], Floats]:
        """The tiles with a chosen cell: indices (g, TILE²) of their cells, middles (g, TILE², 2)."""
        rows, columns = chosen.shape
        index = np.arange(rows * columns).reshape(rows // TILE, TILE, columns // TILE, TILE)
        tiles = index.swapaxes(1, 2).reshape(-1, TILE * TILE)
        tiles = tiles[chosen.ravel()[tiles].any(axis=1)]
        row, column = np.divmod(tiles, columns)
        east = self.west_m + self.cell_m * (column + 0.5)
        return tiles, np.stack((east, self.north_m - self.cell_m * (row + 0.5)), axis=-1)


def _filled(
    data: Data, model: Covariance, calibration: Calibration, grid: _Grid, known: NDArray[np.bool_]
) -> tuple[Floats, Floats]:
    tiles, middles = grid.groups(known)
    _, near = cKDTree(data.place).query(middles.mean(axis=1), k=min(NEIGHBOURS, len(data.place)))
    found, variance = kriging.predict(data, model, middles, near)
    variance *= calibration.factor(middles.mean(axis=1))[:, None]
    depth, band = np.full(known.size, np.nan), np.full(known.size, np.nan)
    depth[tiles], band[tiles] = found, BAND_SD * np.sqrt(variance)
    unknown = ~known.ravel()
    depth[unknown] = band[unknown] = np.nan
    return depth.reshape(known.shape), band.reshape(known.shape)


def _away(grid: _Grid, east_m: Floats, north_m: Floats) -> Floats:
    """Distance of each cell to the nearest one with a sounding, metres."""
    rows, columns = grid.is_water.shape
    row = np.floor((grid.north_m - north_m) / grid.cell_m).astype(np.intp)
    column = np.floor((east_m - grid.west_m) / grid.cell_m).astype(np.intp)
    on = (row >= 0) & (row < rows) & (column >= 0) & (column < columns)
    empty = np.ones((rows, columns), dtype=bool)
    empty[row[on], column[on]] = False
    if not on.any():
        return np.full(empty.shape, np.inf)
    found: Floats = grid.cell_m * distance_transform_edt(empty)
    return found


def _shore_points(chart: Chart, step_m: float) -> Floats:
    """Places along the shore, (n, 2). Piers, rafts and obstacles stand in water: the depth there is not 0."""
    if chart.is_open:
        return np.empty((0, 2))
    built = [
        feature.shape for feature in chart.features if feature.kind in SOLID and feature.kind != "island"
    ]
    shore = chart.water.boundary.difference(shapely.union_all(built).buffer(0.5))
    lines = [line for line in shapely.get_parts(shore) if line.length > 0.0]
    at = [line.interpolate(np.arange(0.0, line.length, step_m)) for line in lines]
    return shapely.get_coordinates(np.concatenate(at)) if at else np.empty((0, 2))


def _held_out(
    place: Floats, depth_m: Floats, radius_m: float, white_m: float, line_m: float, chosen: NDArray[np.intp]
) -> Data:
    """Means of the soundings within a radius of some of them."""
    groups = cKDTree(place).query_ball_point(place[chosen], radius_m)
    count = np.array([len(group) for group in groups], dtype=np.float64)
    middle = np.array([place[group].mean(axis=0) for group in groups])
    depth = np.array([depth_m[group].mean() for group in groups])
    return Data(middle, depth, white_m**2 / count + line_m**2)
