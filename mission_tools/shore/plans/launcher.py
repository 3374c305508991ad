"""A process of the server: sets its own limits, then becomes mission-plan or boat-survey.

    python -m mission_tools.shore.plans.launcher PARENT PROGRAM ARGUMENT…

PARENT: process id of the server; the program ends with it. PROGRAM: a name of PROGRAMS.
"""

import ctypes
import os
import resource
import runpy
import signal
import sys
from typing import Final, NamedTuple


class Program(NamedTuple):
    """memory_bytes: of address space, most of which numpy's and scipy's libraries reserve and never touch."""

    module: str
    memory_bytes: int
    file_bytes: int
    time_s: int


PLANNER: Final = "mission-plan"
SURVEY: Final = "boat-survey"
PROGRAMS: Final = {
    # A survey of the mill pond takes 0.4 GB of address space; 5000 items take 2 MB as .plan
    PLANNER: Program("mission_tools.cli.plan", 1_500_000_000, 16_000_000, 60),
    # A chart of 210,000 soundings takes 11 s of a core and 490 MB; the logs of 480 s, 0.8 GB of address space
    SURVEY: Program("mission_tools.cli.survey", 2_000_000_000, 200_000_000, 300),
}
NICE: Final = 10
_PR_SET_PDEATHSIG: Final = 1  # prctl(2)


def confine(parent: int, program: Program) -> None:
    """Limit this process, and end it with its parent."""
    ctypes.CDLL(None).prctl(_PR_SET_PDEATHSIG, signal.SIGKILL)
    if os.getppid() != parent:  # it has ended already
        sys.exit(1)
    os.nice(NICE)
    for limit, most in (
        (resource.RLIMIT_AS, program.memory_bytes),
        (resource.RLIMIT_FSIZE, program.file_bytes),
        (resource.RLIMIT_CPU, program.time_s),
        (resource.RLIMIT_CORE, 0),
    ):
        resource.setrlimit(limit, (most, most))


def main(arguments: list[str]) -> None:
    """Confine this process and run the program."""
    program = PROGRAMS[arguments[1]]
    confine(int(arguments[0]), program)
    sys.argv = arguments[1:]
    runpy.run_module(program.module, run_name="__main__", alter_sys=True)


if __name__ == "__main__":
    main(sys.argv[1:])
