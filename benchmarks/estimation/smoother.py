"""How far off the true legs does the boat sail, and how far off is an optimal smoother of the same fixes?

The smoother is that of Rauch, Tung and Striebel (AIAA Journal 3(8), 1965): of every moment it knows all fixes
of the run, the later ones included, and the emulator's true error model of the receiver, which no boat does.
A boat that steers by it without an error of its own is off its leg by the error of the smoother, except on
the first, which begins where the boat is and does not count. Per axis its states are position, velocity, the
two Gauss-Markov errors of the position and that of the velocity; the boat's acceleration is white noise, of
the density with which the smoother errs least in this very run.
"""

import argparse
import math
import sys
from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from benchmarks.estimation.consistency import RECEIVERS
from companion.core.readings import GnssFix
from sitl.courses.missions import lay_out, wire_items
from sitl.run.mission_run import MissionRun
from sitl.run.recording.recorder import NO_LEG, cross_track_m
from sitl.scenarios.scenario import load_scenario
from sitl.world.sampling import EPOCH_UNIX_S
from sitl.world.sensors.receivers import GnssSettings

Numbers = NDArray[np.float64]
COURSES: Final = ("square", "zigzag")
_ACCELERATIONS: Final = (0.01, 0.03, 0.1)  # densities, m²/s³
_MOTION: Final = 1e3  # variance of the first position and velocity: unknown
_LEAST: Final = 1e-6  # variance that each noise has at least


class RecordedRun(MissionRun):
    """A run whose fixes are kept, since boot, each with the truth of its time."""

    def __init__(self, receiver: str, course: str, seed: int, *settings: str) -> None:
        scenario = load_scenario("open", (f"sensors.gnss.receiver={receiver}", f"seed={seed}", *settings))
        self.fixes: list[GnssFix] = []
        super().__init__(scenario, wire_items(lay_out(course, scenario)))

    def _step(self) -> None:
        super()._step()
        fix = self.lockstep.world.hardware.gnss.read()
        if fix is not None and (not self.fixes or fix is not self.fixes[-1]):
            self.fixes.append(fix)


def smooth(times_s: Numbers, measured: Numbers, receiver: GnssSettings, acceleration: float) -> Numbers:
    """The smoothed positions of one axis. measured: position and velocity at each time."""
    decays_s = np.array([receiver.wander_s, receiver.slow_s, max(receiver.velocity_noise_s, 1e-3)])
    variances = np.array([receiver.wander_m, receiver.slow_m, receiver.velocity_noise_m_s]) ** 2 + _LEAST
    observe = np.array([[1.0, 0.0, 1.0, 1.0, 0.0], [0.0, 1.0, 0.0, 0.0, 1.0]])
    noise = np.diag([receiver.noise_m**2 + _LEAST, _LEAST])
    state = np.array([measured[0, 0], 0.0, 0.0, 0.0, 0.0])
    covariance = np.diag([_MOTION, _MOTION, *variances])
    before: list[tuple[Numbers, Numbers]] = []
    after: list[tuple[Numbers, Numbers]] = []
    steps: list[Numbers] = []
    for index, value in enumerate(measured):
        dt = times_s[index] - times_s[index - 1] if index else 0.0
        keep = np.exp(-dt / decays_s)
        step = np.diag([1.0, 1.0, *keep])
        step[0, 1] = dt
        process = np.diag([0.0, 0.0, *(variances * (1.0 - keep * keep))])
        process[:2, :2] = acceleration * np.array([[dt**3 / 3.0, dt**2 / 2.0], [dt**2 / 2.0, dt]])
        state, covariance = step @ state, step @ covariance @ step.T + process
        before.append((state, covariance))
        steps.append(step)
        gain = covariance @ observe.T @ np.linalg.inv(observe @ covariance @ observe.T + noise)
        state = state + gain @ (value - observe @ state)
        covariance = covariance - gain @ observe @ covariance
        after.append((state, covariance))
    smoothed = [state]
    for (filtered, its), (predicted, later), step in zip(
        after[-2::-1], before[:0:-1], steps[:0:-1], strict=True
    ):
        state = filtered + its @ step.T @ np.linalg.solve(later, state - predicted)
        smoothed.append(state)
    return np.array(smoothed[::-1])[:, 0]


class Figures(NamedTuple):
    """RMS off the true legs, in m: of the boat, of its estimate's error across them, of the smoother's."""

    boat: float
    estimate: float
    smoother: float


def measure(run: RecordedRun) -> Figures:
    """Sail the mission and compare."""
    run.run()
    frame, receiver = run.scenario.frame, run.scenario.sensors.gnss
    times_s = np.array([(fix.unix_time_s or math.nan) - EPOCH_UNIX_S for fix in run.fixes])
    heard = np.array([(*frame.to_local(fix.position), fix.north_m_s, fix.east_m_s) for fix in run.fixes])
    rows, legs = run.recorder.rows, run.recorder.legs
    legs[legs == 0] = NO_LEG
    ticks_s, at = rows[:, 0], rows[:, 1:3]

    def across(places: Sequence[Numbers]) -> Numbers:
        return cross_track_m(np.column_stack(places), legs, run.planned)

    truth = across((at[:, 0], at[:, 1]))
    found = math.inf
    for acceleration in _ACCELERATIONS:
        axes = [smooth(times_s, heard[:, axis::2], receiver, acceleration) for axis in (0, 1)]
        smoothed = across([np.interp(ticks_s, times_s, axis) for axis in axes])
        found = min(found, rms(smoothed - truth))
    estimates = run.estimates.rows
    believed = across([np.interp(ticks_s, estimates[:, 0], estimates[:, axis]) for axis in (1, 2)])
    return Figures(rms(truth), rms(believed - truth), found)


def rms(values: Numbers) -> float:
    """Root of the mean square."""
    return math.sqrt(float(np.mean(values * values)))


def main(arguments: list[str]) -> int:
    """Entry point."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.estimation.smoother", description=__doc__)
    parser.add_argument("--runs", type=int, default=10)
    parser.add_argument("--first-seed", type=int, default=9600)
    parser.add_argument("--receiver", action="append", choices=RECEIVERS, help="[all]")
    parser.add_argument("--course", action="append", choices=COURSES, help="[all]")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="of the scenario")
    chosen = parser.parse_args(arguments)
    write = sys.stdout.write
    write("| receiver | course | boat, m | its estimate, m | smoother, m | boat ÷ smoother |\n")
    write("|---|---|---|---|---|---|\n")
    for receiver in chosen.receiver or RECEIVERS:
        for course in chosen.course or COURSES:
            seeds = range(chosen.first_seed, chosen.first_seed + chosen.runs)
            found = np.array([measure(RecordedRun(receiver, course, seed, *chosen.set)) for seed in seeds])
            boat, estimate, smoother = np.sqrt(np.mean(found * found, axis=0))
            cells = f"{boat:.2f} | {estimate:.2f} | {smoother:.2f} | {boat / smoother:.2f}"
            write(f"| {receiver} | {course} | {cells} |\n")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
