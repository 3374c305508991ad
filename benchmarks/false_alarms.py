"""Does a healthy boat raise alarms? Simulated hours among false echoes, a tide and gusts.

    python -m benchmarks.false_alarms 24 --seed 1

There is no obstacle and no fault. The boat sails between places of open water, and keeps station in between.
Every message that is no answer to a command is printed with its time and the current; the last line counts
them. The exit code is 1 if there are any.
"""

import argparse
import math
import sys
import time
from collections import Counter
from collections.abc import Iterator
from typing import NamedTuple

from companion.boat import TICK_S
from companion.core.geo import Point
from companion.core.units import deg_to_e7
from companion.mavlink.dialect import dialect
from mission_tools.station.wire import command_long
from sitl.run.lockstep import Lockstep
from sitl.run.station_commands import StationCommands
from sitl.scenarios.scenario import load_scenario

WATER = (
    "environment.tide={speed_m_s=0.5, to_deg=60.0}",  # to and fro in 12.4 h
    "environment.wind_m_s=5", "environment.gust_m_s=8", "environment.wind_from_deg=90",
    "battery.capacity_mah=1e8", "vehicle.battery.capacity_mah=1e8",
)  # fmt: skip
EXPECTED = ("Armed", "Disarmed", "Mode ", "GUIDED: arrived", "LOITER", "Home ", "Ready")
_GUIDED, _LOITER = 15, 5
_TARGET_S = 60.0  # between two places, of which every _STAYS-th is a station
_STAYS = 8
_CIRCLE_M = 60.0


class Alarm(NamedTuple):
    """A message that no command explains."""

    time_s: float
    text: str
    mode: str
    current_m_s: float


def alarms(hours: float, seed: int, *settings: str) -> Iterator[Alarm | float]:
    """Alarms as they occur, and the time after each simulated hour."""
    scenario = load_scenario("open", (*WATER, *settings, f"seed={seed}"))
    lockstep = Lockstep(scenario)
    orders = StationCommands(lockstep, lockstep.step)
    orders.until_armable()
    orders.arm()
    station, began = lockstep.station, len(lockstep.station.texts)
    target = 0
    for tick in range(round(hours * 3600.0 / TICK_S)):
        if tick % round(_TARGET_S / TICK_S) == 0:
            target += 1
            if target % _STAYS == 0:
                station.send(command_long(station.boat, dialect.MAV_CMD_DO_SET_MODE, 1.0, _LOITER))
            else:
                _send_to(lockstep, _place(scenario.start, target))
        lockstep.step()
        for text in station.texts[began:]:
            if not text.startswith(EXPECTED):
                truth = lockstep.world.truth
                current_m_s = math.hypot(truth.current_north_m_s, truth.current_east_m_s)
                yield Alarm(lockstep.time_s, text, lockstep.boat.vehicle.mode.name, current_m_s)
        began = len(station.texts)
        if (tick + 1) % round(3600.0 / TICK_S) == 0:
            yield lockstep.time_s
    lockstep.close()


def _place(start: Point, target: int) -> Point:
    return start.moved(2.4 * target, _CIRCLE_M)


def _send_to(lockstep: Lockstep, at: Point) -> None:
    station, place = lockstep.station, lockstep.world.scenario.frame.to_global(at)
    x, y = deg_to_e7(place.lat_deg), deg_to_e7(place.lon_deg)
    station.send(command_long(station.boat, dialect.MAV_CMD_DO_SET_MODE, 1.0, _GUIDED))
    number = dialect.MAV_CMD_DO_REPOSITION
    station.send(
        dialect.MAVLink_command_int_message(*station.boat, 3, number, 0, 0, -1.0, 1.0, 0.0, 0.0, x, y, 0.0)
    )


def main() -> int:
    """The exit code."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.false_alarms")
    parser.add_argument("hours", type=float, nargs="?", default=24.0)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="of the scenario")
    chosen = parser.parse_args()
    began_s, found = time.monotonic(), Counter[str]()
    for item in alarms(chosen.hours, chosen.seed, *chosen.set):
        if isinstance(item, Alarm):
            found[item.text] += 1
            hours = item.time_s / 3600.0
            line = f"{hours:7.3f} h  {item.mode:8} current {item.current_m_s:.2f} m/s  {item.text}"
        else:
            line = f"{item / 3600.0:7.1f} h simulated in {time.monotonic() - began_s:.0f} s"
        sys.stdout.write(line + "\n")
        sys.stdout.flush()
    counts = ", ".join(f"{number} × {text}" for text, number in found.most_common()) or "none"
    sys.stdout.write(f"alarms in {chosen.hours:g} h: {counts}\n")
    return int(bool(found))


if __name__ == "__main__":
    sys.exit(main())
