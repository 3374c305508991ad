"""What does a planner's process cost from start to end, in CPU seconds and memory?"""

import os
import statistics
import subprocess
import sys
from pathlib import Path

from benchmarks.measure import Row, alone

_ROUNDS = 5
_SHORES = Path("tests/data/shores")
_SQUAM = ["--start-at", "43.7340,-71.5450", "--goal", "43.7640,-71.5250"]
_RUN = "import runpy, sys; sys.argv = sys.argv[1:]; runpy.run_module(sys.argv[0], run_name='__main__')"
_JOBS = {
    "mission-plan --help": (_RUN, "mission_tools.cli.plan", "--help"),
    "mission-plan, the mill pond": (_RUN, "mission_tools.cli.plan", "lake"),
    "mission-plan, Squam Lake (1,330 vertices)": (
        _RUN,
        "mission_tools.cli.plan",
        str(_SHORES / "lake_squam_nh.geojson"),
        *_SQUAM,
    ),
    "python -c 'import numpy, shapely'": ("import numpy, shapely",),
}
# The peak is the process's own: that of wait4() has the memory of the process it was forked from
_SAY_PEAK = """
import atexit, sys
@atexit.register
def say():
    status = open("/proc/self/status").read().split()
    sys.stderr.write(status[status.index("VmHWM:") + 1])
"""


def _cost(code: str, *arguments: str) -> tuple[float, float]:
    """CPU seconds and peak MB of one process."""
    command = [sys.executable, "-c", _SAY_PEAK + code, *arguments]
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True) as process:
        assert process.stderr is not None
        said = process.stderr.read()
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode != 0:
        raise RuntimeError(f"{' '.join(arguments)}: exit code {process.returncode}: {said}")
    return used.ru_utime + used.ru_stime, int(said) / 1024.0


def rows() -> list[Row]:
    """CPU time and memory of whole processes, in turn."""
    jobs = {
        name: arguments
        for name, arguments in _JOBS.items()
        if all(Path(word).exists() for word in arguments if word.endswith(".geojson"))
    }
    found: dict[str, list[tuple[float, float]]] = {name: [] for name in jobs}
    for _ in range(_ROUNDS):
        for name, arguments in jobs.items():
            found[name].append(_cost(*arguments))
    return [
        alone(
            name,
            "CPU s",
            "less",
            [seconds for seconds, _ in costs],
            f"peak {statistics.median(peak for _, peak in costs):.0f} MB",
        )
        for name, costs in found.items()
    ]
