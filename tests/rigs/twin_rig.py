"""A voyage of the emulator's own hull, drive and windage, without the boat's program."""

from collections.abc import Callable

import numpy as np

from companion.core.units import clamp
from sitl.twin.voyage import Floats, Voyage
from sitl.world.drive.thruster import Thrusters
from sitl.world.hull import Hull
from sitl.world.scenario import Scenario
from sitl.world.windage import Windage

OPEN_V, PACK_OHM = 12.2, 0.05
FIX_S = 0.2


def run_world(
    boat: Scenario,
    commands: Floats,
    step_s: float,
    wind_m_s: tuple[float, float] | Floats = (0.0, 0.0),
    helm: Callable[[float, float], float] | None = None,
) -> Floats:
    """Surge, sway, turn rate, motors' current and heading before each step, and the commands held over it,
    shape (steps, 7). commands: left and right, shape (steps, 2); wind_m_s: north and east, or these by step;
    the water is still. helm: what heading and turn rate add to the left command and take from the right one.
    """
    hull, drive = Hull(boat.hull), Thrusters(boat.thrusters)
    windage = Windage(boat.hull.windage, boat.hull.length_m)
    volts = supply = OPEN_V - PACK_OHM * boat.battery.idle_a
    rows = []
    winds = np.broadcast_to(wind_m_s, commands.shape).tolist()
    for (left, right), (wind_north, wind_east) in zip(commands.tolist(), winds, strict=True):
        turn = 0.0 if helm is None else helm(hull.heading_rad, hull.yaw_rate_rad_s)
        left, right = clamp(left + turn, -1.0, 1.0), clamp(right - turn, -1.0, 1.0)  # noqa: PLW2901
        moving = hull.surge_m_s, hull.sway_m_s, hull.yaw_rate_rad_s, drive.current_a, hull.heading_rad
        rows.append((*moving, left, right))
        ahead_n, yaw_nm = drive.step(left, right, supply, hull.surge_m_s, hull.yaw_rate_rad_s, step_s)
        before, volts = volts, OPEN_V - PACK_OHM * (drive.current_a + boat.battery.idle_a)
        supply = 0.5 * (before + volts)
        north, east = wind_north - hull.water_north_m_s, wind_east - hull.water_east_m_s
        x, y, n = windage.force(north * hull.cos + east * hull.sin, east * hull.cos - north * hull.sin)
        hull.step(ahead_n + x, y, yaw_nm + n, 0.0, 0.0, step_s)
    return np.array(rows)


def measured_voyage(boat: Scenario, commands: Floats, step_s: float, seed: int) -> Voyage:
    """The same as measured: a receiver of 0.05 m/s, a gyro of 0.1°/s, 0.3 m/s of current north-east."""
    rows, noise = run_world(boat, commands, step_s), np.random.default_rng(seed).normal
    surge, sway, rate, amps, heading = rows.T[:5]
    every = round(FIX_S / step_s)
    times_s = 5.0 + step_s * np.arange(len(rows))
    north, east = (
        surge * np.cos(heading) - sway * np.sin(heading),
        surge * np.sin(heading) + sway * np.cos(heading),
    )
    track = [north + 0.2, east + 0.2, 0.0 * north, 0.0 * east]
    fixes = np.column_stack([times_s, *track])[::every]
    fixes[:, 1:3] += noise(0.0, 0.05, (len(fixes), 2))
    drawn = amps + boat.battery.idle_a + noise(0.0, 0.05, len(amps))
    pack = np.column_stack([times_s, OPEN_V - PACK_OHM * drawn, drawn])[:: round(1.0 / step_s)]
    return Voyage(
        5.0, step_s, commands[:, 0], commands[:, 1], np.full(len(rows), OPEN_V), heading,
        rate + noise(0.0, 0.002, len(rows)), fixes, pack, PACK_OHM, {},
    )  # fmt: skip
