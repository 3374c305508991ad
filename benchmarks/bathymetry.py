"""Interpolation of 200,000 soundings on a lake of 20 ha by four methods: error, band, time, memory.

    PYTHONPATH=tests/rigs python -m benchmarks.bathymetry

Each method is a process of its own. Peers: pip install verde pykrige.
"""

import json
import math
import resource
import subprocess
import sys
import time
from collections.abc import Callable
from importlib.util import find_spec

import numpy as np
from scipy.interpolate import RBFInterpolator
from sounded_lake import ORIGIN, Bottom, bowl, fractal, lake, soundings

from benchmarks.measure import table
from mission_tools.bathymetry.blocks import means
from mission_tools.bathymetry.kriging import BAND_SD
from mission_tools.bathymetry.reduction import BEAM_DEG, Corrections, reduced
from mission_tools.bathymetry.soundings import Floats
from mission_tools.bathymetry.surface import SurfaceSettings, interpolated

NOISE_M, SPACING_M, CELL_M, SEED = 0.04, 10.0, 2.0, 61
BOTTOMS: dict[str, Callable[..., Bottom]] = {"smooth": bowl, "fractal": fractal}
Found = tuple[Floats, Floats | None, Floats, Floats]  # depth, half of the 90 % band, east, north
Method = Callable[[Floats, Floats, Floats], Found]
CHART = lake(580.0, 440.0)


def _cells() -> tuple[Floats, Floats]:
    east, north = np.meshgrid(np.arange(-289.0, 290.0, CELL_M), np.arange(-219.0, 220.0, CELL_M))
    inside = (east / 285.0) ** 2 + (north / 215.0) ** 2 < 1.0
    return east[inside], north[inside]


def ours(east: Floats, north: Floats, depth: Floats) -> Found:
    """Local ordinary kriging with the calibrated band."""
    beam_rad, settings = math.radians(BEAM_DEG), SurfaceSettings(cell_m=CELL_M)
    found = interpolated(CHART, east, north, depth, np.nan, settings, beam_rad)
    known = np.isfinite(found.depth_m)
    x, y = np.meshgrid(*found.grid.middles)
    return found.depth_m[known], found.band_m[known], x[known], y[known]


def scipy_rbf(east: Floats, north: Floats, depth: Floats) -> Found:
    """Thin plate spline through the 40 nearest block means."""
    blocks, _ = means(east, north, depth, 0.25 * SPACING_M, depth)
    x, y = _cells()
    spline = RBFInterpolator(blocks.place, blocks.depth_m, neighbors=40, smoothing=NOISE_M**2)
    return spline(np.column_stack((x, y))), None, x, y


def verde_spline(east: Floats, north: Floats, depth: Floats) -> Found:
    """Verde's biharmonic spline; its matrix is dense, so the block means are of half a spacing."""
    import verde  # noqa: PLC0415

    blocks, _ = means(east, north, depth, 0.5 * SPACING_M, depth)
    x, y = _cells()
    spline = verde.Spline(damping=1e-6).fit(tuple(blocks.place.T), blocks.depth_m)
    return spline.predict((x, y)), None, x, y


def pykrige_local(east: Floats, north: Floats, depth: Floats) -> Found:
    """PyKrige's ordinary kriging from 40 nearest block means, variogram fitted by itself."""
    from pykrige.ok import OrdinaryKriging  # noqa: PLC0415

    blocks, _ = means(east, north, depth, 0.5 * SPACING_M, depth)
    x, y = _cells()
    model = OrdinaryKriging(*blocks.place.T, blocks.depth_m, variogram_model="power")
    found, variance = model.execute("points", x, y, backend="loop", n_closest_points=40)
    return np.asarray(found), BAND_SD * np.sqrt(np.maximum(np.asarray(variance), 0.0)), x, y


METHODS: dict[str, Method] = {
    "local kriging, calibrated": ours,
    "scipy RBFInterpolator": scipy_rbf,
    "verde Spline": verde_spline,
    "PyKrige OrdinaryKriging": pykrige_local,
}


def measured(kind: str, name: str) -> dict[str, float]:
    """One method on one bottom, in this process."""
    bottom = BOTTOMS[kind](CHART, SEED)
    s = soundings(CHART, bottom, SEED, spacing_m=SPACING_M, step_m=0.115, noise_m=NOISE_M)
    at = reduced(s, ORIGIN, Corrections())
    own = at.depth_m > 0.0
    before = time.process_time()
    depth, band, east, north = METHODS[name](at.east_m[own], at.north_m[own], at.depth_m[own])
    seconds = time.process_time() - before
    error = np.abs(depth - bottom(east, north))
    inside = float(np.mean(error <= band)) if band is not None else float("nan")
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0
    return {"rms": float(np.sqrt(np.mean(error**2))), "inside": inside, "s": seconds, "mb": memory}


def main() -> None:
    """Run each method as a process and print the table."""
    if len(sys.argv) == 3:
        sys.stdout.write(json.dumps(measured(*sys.argv[1:])))
        return
    rows = []
    for kind in BOTTOMS:
        for name in METHODS:
            if any(peer in name.lower() and find_spec(peer) is None for peer in ("verde", "pykrige")):
                sys.stderr.write(f"{name}: skipped, not installed\n")
                continue
            command = [sys.executable, "-m", "benchmarks.bathymetry", kind, name]
            ran = subprocess.run(command, capture_output=True, check=True)
            one = json.loads(ran.stdout)
            share = "none" if np.isnan(one["inside"]) else f"{100 * one['inside']:.1f} %"
            rows.append(
                (kind, name, f"{100 * one['rms']:.1f} cm", share, f"{one['s']:.1f} s", f"{one['mb']:.0f} MB")
            )
    head = ("bottom", "method", "RMS error", "inside the 90 % band", "CPU time", "memory")
    sys.stdout.write(table(head, rows))


if __name__ == "__main__":
    main()
