"""The planner's process: sets its own limits, then becomes mission-plan.

    python -m mission_tools.shore.plans.launcher PARENT ARGUMENT…

PARENT: process id of the server; the planner ends with it.
"""

import ctypes
import os
import resource
import runpy
import signal
import sys
from typing import Final

PLANNER: Final = "mission_tools.cli.plan"
MEMORY_BYTES: Final = 1_500_000_000
"""Of address space, most of which numpy's and scipy's libraries reserve and never touch: a survey of the mill
pond takes 100 MB of memory and 0.4 GB of address space."""
FILE_BYTES: Final = 16_000_000  # 5000 items take 2 MB as .plan
CPU_S: Final = 60
NICE: Final = 10
_PR_SET_PDEATHSIG: Final = 1  # prctl(2)


def confine(parent: int) -> None:
    """Limit this process, and end it with its parent."""
    ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != parent:  # it has ended already
        sys.exit(1)
    os.nice(NICE)
    for limit, most in (
        (resource.RLIMIT_AS, MEMORY_BYTES),
        (resource.RLIMIT_FSIZE, FILE_BYTES),
        (resource.RLIMIT_CPU, CPU_S),
        (resource.RLIMIT_CORE, 0),
    ):
        resource.setrlimit(limit, (most, most))


def main(arguments: list[str]) -> None:
    """Confine this process and run the planner."""
    confine(int(arguments[0]))
    sys.argv = ["mission-plan", *arguments[1:]]
    runpy.run_module(PLANNER, run_name="__main__", alter_sys=True)


if __name__ == "__main__":
    main(sys.argv[1:])
