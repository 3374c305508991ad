# %% [markdown]
# # Replay a log through the filter
#
# Reads fixes, heading readings and motor commands from a log of the boat, feeds them to a new estimator, and
# draws estimates and innovations. Log every tick for that: `LOG_FILE_RATEMAX = 50`. A run of the emulator:
#
#     boat-sitl sail open --course zigzag --set vehicle.log.motion_hz=50 --log out/zigzag.bin
#
# Then run the cells, or `python examples/replay_log.py out/zigzag.bin`. Change a setting of the estimator
# below and see what it would have done on the same voyage.

# %%
import sys
from pathlib import Path

import matplotlib.pyplot as plt
import msgspec
import numpy as np

from companion.estimation.estimator import Estimator
from sitl.run.recording.log_replay import read_log

LOG = Path(sys.argv[1] if sys.argv[1:] and sys.argv[1].endswith(".bin") else "out/zigzag.bin")
PICTURE = LOG.with_suffix(".png")

# %%
run = read_log(LOG)
setting = msgspec.structs.replace(run.config.estimation)  # for example gnss_timeout_s=1.0
estimator = Estimator(run.config.speed, setting, run.config.drive, run.config.handling)

SENSORS = ("position_north", "position_east", "velocity_north", "velocity_east", "compass")
estimates: list[tuple[float, float, float, float]] = []  # time, north, east, current
logged: list[tuple[float, float, float]] = []
innovations: dict[str, list[tuple[float, float]]] = {name: [] for name in SENSORS}

for tick, nav in run.estimates(estimator):
    if nav is None or estimator.frame is None:
        continue
    current_m_s = float(np.hypot(nav.current_north_m_s, nav.current_east_m_s))
    estimates.append((tick.now_s, nav.north_m, nav.east_m, current_m_s))
    if tick.logged is not None:
        logged.append((tick.now_s, *tick.logged[:2]))
    report = estimator.report
    for name in SENSORS if report is not None else ():
        one = getattr(report, name)
        if one.time_s >= 0.0 and (not innovations[name] or innovations[name][-1][0] < one.time_s):
            innovations[name].append((one.time_s, one.value / one.variance**0.5))

# %% [markdown]
# 95 % of the innovations of a consistent filter lie within ±1.96 of their standard deviations, and their mean
# square (NIS) is 1.

# %%
for name, values in innovations.items():
    if values:
        nu = np.array(values)[:, 1]
        print(f"{name}: NIS {np.mean(nu**2):.2f}, {100 * np.mean(np.abs(nu) < 1.96):.0f} % within ±1.96 σ")

# %%
figure, (track, time) = plt.subplots(2, 1, figsize=(10, 10), height_ratios=(2, 1), layout="constrained")
times, north_m, east_m, current = np.array(estimates).T
_, logged_north_m, logged_east_m = np.array(logged).T
track.plot(logged_east_m, logged_north_m, color="#98b3c6", linewidth=3.0, label="as logged")
track.plot(east_m, north_m, color="#b5651d", linewidth=1.0, label="replayed")
track.set(xlabel="east, m", ylabel="north, m", aspect="equal")
track.legend()
for name in ("velocity_north", "velocity_east"):
    time.plot(*np.array(innovations[name] or [(0.0, 0.0)]).T, ".", ms=2.5, label=name.replace("_", " "))
time.axhspan(-1.96, 1.96, color="#dcebdc", zorder=0)
time.set(xlabel="time since boot, s", ylabel="innovation, σ", ylim=(-6.0, 6.0))
time.legend(ncols=2)
figure.savefig(PICTURE)
