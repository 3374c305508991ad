"""RRT* by OMPL: S. Karaman and E. Frazzoli, *Sampling-based Algorithms for Optimal Motion Planning* (IJRR
2011).

OMPL is in the extra `bench`. It stops after a number of iterations, not by the clock, so that a seed fixes
the path. Legs are tested exactly, not by samples on them.
"""

from typing import Any

from benchmarks.peers.interface import Deadline, NoPath, Path, Sea
from companion.cli.program_end import how_to_install
from companion.core.geo import Point

ITERATIONS = 4000


def rrt_star(sea: Sea, start: Point, goal: Point, seed: int, deadline: Deadline, effort: float) -> Path:
    """OMPL's RRT* with its own settings."""
    try:
        from ompl import base, geometric, util  # noqa: PLC0415  an optional peer
    except ImportError as error:
        raise NoPath(f"OMPL is not installed: {how_to_install('bench')}") from error

    class ExactLegs(base.MotionValidator):  # type: ignore[misc]
        """Whether a leg keeps the clearance."""

        def checkMotion(self, a: Any, b: Any, _last: Any = None) -> bool:  # noqa: ANN401, N802  (OMPL's)
            return sea.is_clear(Point(a[0], a[1]), Point(b[0], b[1]))

    util.setLogLevel(util.LOG_NONE)
    util.RNG.setSeed(seed + 1)  # 0 is none
    west, south, east, north = sea.bounds
    space, bounds = base.RealVectorStateSpace(2), base.RealVectorBounds(2)
    for axis, (low, high) in enumerate(((south, north), (west, east))):
        bounds.setLow(axis, low)
        bounds.setHigh(axis, high)
    space.setBounds(bounds)
    information = base.SpaceInformation(space)
    information.setStateValidityChecker(lambda state: sea.is_free(Point(state[0], state[1])))
    legs = ExactLegs(information)
    information.setMotionValidator(legs)
    information.setup()
    problem = base.ProblemDefinition(information)
    ends = [space.allocState(), space.allocState()]
    for state, point in zip(ends, (start, goal), strict=True):
        state[0], state[1] = point
    problem.setStartAndGoalStates(*ends)
    tree = geometric.RRTstar(information)
    tree.setProblemDefinition(problem)
    tree.setup()
    iterations, most, is_late = 0, round(effort * ITERATIONS), False

    def is_over() -> bool:
        nonlocal iterations, is_late
        iterations += 1
        is_late = is_late or deadline.is_over
        return iterations > most or is_late

    tree.solve(base.PlannerTerminationCondition(is_over))
    if is_late:
        raise NoPath("out of time")
    if not problem.hasExactSolution():
        raise NoPath(f"no path after {most} iterations")
    path = problem.getSolutionPath()
    states = [path.getState(n) for n in range(path.getStateCount())]
    return (start, *(Point(state[0], state[1]) for state in states[1:-1]), goal)
