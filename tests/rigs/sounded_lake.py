"""A lake with a known bottom and the soundings of a survey over it, without errors of our own programs."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import shapely
from numpy.typing import NDArray

from companion.core.geo import LatLon, LocalFrame
from mission_tools.bathymetry.soundings import Floats, Soundings
from mission_tools.maps.chart import Chart, Feature, build_chart

ORIGIN = LatLon(50.0, -1.2)
DEGREE_M = 111_200.0  # near enough to make positions, which pyproj then reads (`places`)
Bottom = Callable[[Floats, Floats], Floats]


def lake(width_m: float = 200.0, height_m: float = 160.0) -> Chart:
    """An ellipse."""
    turn = np.linspace(0.0, 2.0 * np.pi, 160, endpoint=False)
    ring = np.column_stack((0.5 * width_m * np.cos(turn), 0.5 * height_m * np.sin(turn)))
    water = shapely.Polygon(ring)
    return build_chart("Test lake", LocalFrame(ORIGIN), water, [Feature("Test lake", "water", water)])


def bowl(chart: Chart, seed: int, deepest_m: float = 5.0) -> Bottom:
    """Zero at the shore, with six holes and humps 12 to 30 m wide."""
    rng = np.random.default_rng(seed)
    west, south, east, north = chart.water.bounds
    half_e, half_n = 0.5 * (east - west), 0.5 * (north - south)
    holes = np.column_stack(
        (
            rng.uniform(-0.6, 0.6, 6) * half_e,
            rng.uniform(-0.6, 0.6, 6) * half_n,
            rng.uniform(12, 30, 6),
            rng.uniform(-1.0, 1.5, 6),
        )
    )

    def depth(e: Floats, n: Floats) -> Floats:
        inside = np.clip(1.0 - (e / half_e) ** 2 - (n / half_n) ** 2, 0.0, None)
        total = deepest_m * inside
        for at_e, at_n, wide, deep in holes:
            total = total + deep * inside * np.exp(-0.5 * ((e - at_e) ** 2 + (n - at_n) ** 2) / wide**2)
        return np.asarray(total)

    return depth


def fractal(chart: Chart, seed: int, hurst: float = 0.8, rough_m: float = 0.8) -> Bottom:
    """Spectral noise of a Hurst exponent in a bowl; `rough_m` is its standard deviation in the middle."""
    rng = np.random.default_rng(seed)
    west, south, east, north = chart.water.bounds
    size, step = 512, max(east - west, north - south) / 480
    f = np.hypot(*np.meshgrid(np.fft.fftfreq(size), np.fft.fftfreq(size)))
    f[0, 0] = np.inf
    field = np.fft.ifft2(np.fft.fft2(rng.normal(size=(size, size))) * f ** -(hurst + 1.0)).real
    field *= rough_m / field.std()
    base = bowl(chart, seed)

    def depth(e: Floats, n: Floats) -> Floats:
        x, y = (e - west) / step, (n - south) / step
        i, j = np.clip(x.astype(int), 0, size - 2), np.clip(y.astype(int), 0, size - 2)
        a, b = x - i, y - j
        value = (
            field[j, i] * (1 - a) * (1 - b)
            + field[j, i + 1] * a * (1 - b)
            + field[j + 1, i] * (1 - a) * b
            + field[j + 1, i + 1] * a * b
        )
        d = base(e, n)
        return np.asarray(np.maximum(d + value * np.clip(d, 0.0, 2.0) / 2.0, 0.05 * d))

    return depth


def track(chart: Chart, spacing_m: float, step_m: float, cross_m: float = 60.0) -> NDArray[np.float64]:
    """Lines to and fro, lines across, and a way along the shore, (n, 2), 3 m off the shore."""
    west, south, east, north = chart.water.bounds
    clear = chart.water.buffer(-3.0)
    lines = []
    for n, y in enumerate(np.arange(south + 0.5 * spacing_m, north, spacing_m)):
        ends = [(west, y), (east, y)] if n % 2 == 0 else [(east, y), (west, y)]
        lines.append(shapely.LineString(ends).intersection(clear))
    lines += [
        shapely.LineString([(x, south), (x, north)]).intersection(clear)
        for x in np.arange(west + 0.5 * cross_m, east, cross_m)
    ]
    lines.append(clear.exterior)
    at = [
        shapely.get_coordinates(shapely.line_interpolate_point(line, np.arange(0.0, line.length, step_m)))
        for line in lines
        if not line.is_empty
    ]
    return np.concatenate(at)


def soundings(
    chart: Chart,
    bottom: Bottom,
    seed: int,
    *,
    spacing_m: float = 8.0,
    step_m: float = 0.5,
    noise_m: float = 0.04,
) -> Soundings:
    """A survey at 1 m/s, or a step a second: noise, a little of it by lines; no wrong echo."""
    rng = np.random.default_rng(seed)
    place = track(chart, spacing_m, step_m)
    place = place + rng.normal(0.0, 0.05, place.shape)
    depth = bottom(place[:, 0], place[:, 1])
    depth = depth + rng.normal(0.0, noise_m, len(depth))
    return of_places(place, depth, step_m)


def of_places(place: NDArray[np.float64], depth_m: Floats, step_m: float = 0.5) -> Soundings:
    """Soundings of a transducer at the surface at places of the frame, a step a step/1 m/s."""
    frame = LocalFrame(ORIGIN)
    origin_lat, n = frame.origin.lat_deg, len(place)
    import pyproj  # noqa: PLC0415

    to_degrees = pyproj.Transformer.from_crs(
        f"+proj=tmerc +lat_0={origin_lat} +lon_0={frame.origin.lon_deg} +ellps=WGS84",
        "EPSG:4326",
        always_xy=True,
    )
    lon, lat = to_degrees.transform(place[:, 0], place[:, 1])
    steps = np.hypot(*np.diff(place, axis=0, prepend=place[:1]).T)
    heading = np.arctan2(*np.diff(place, axis=0, append=place[-1:]).T)
    nan = np.full(n, np.nan)
    return Soundings(
        1.7e9 + np.cumsum(np.maximum(steps, step_m)), np.asarray(lat), np.asarray(lon), np.full(n, 0.05),
        heading, np.zeros(n), np.zeros(n), np.ones(n), depth_m, np.full(n, 0.95), nan,
        np.zeros(n, dtype=np.int64), names=("test",),
    )  # fmt: skip


def with_values(s: Soundings, rows: NDArray[np.intp] | slice, **values: object) -> Soundings:
    """The soundings with other values in some rows."""
    changed = {}
    for name, value in values.items():
        column = getattr(s, name).copy()
        column[rows] = value
        changed[name] = column
    return replace(s, **changed)
