"""What does a planner's process cost from start to end, in CPU seconds?"""

import os
import subprocess
import sys

from benchmarks.measure import Row, of_pairs

_ROUNDS = 5
_PLAN = "from mission_tools.cli.plan import run_program; run_program(['lake'])"
_IMPORTS = "import numpy, shapely"


def rows() -> list[Row]:
    """CPU time of whole processes, in turn."""
    pairs = [(_cpu_s(_PLAN), _cpu_s(_IMPORTS)) for _ in range(_ROUNDS)]
    return [of_pairs("CPU time of mission-plan, the mill pond", "s", pairs, f"`{_IMPORTS}` alone")]


def _cpu_s(code: str) -> float:
    with subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.DEVNULL) as process:
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    assert process.returncode == 0
    return used.ru_utime + used.ru_stime
