"""Planners to compare with, from the related work of the paper that this project implements.

    python -m benchmarks peers

Each is a function of a `Sea`, start, goal, seed and time budget (interface.py); PEERS names them. They are
tuned in good faith on the pool and the lake scenario, take no short cut of ours, and give the same path for
the same seed.
"""

from collections.abc import Callable
from importlib import import_module
from typing import Final

from benchmarks.peers.interface import Planner

_PLACES: Final = {
    "Dijkstra": ("grid_searches", "dijkstra"),
    "Theta*": ("grid_searches", "theta_star"),
    "pruning and cubic spline": ("spline", "pruned_spline"),
    "PRM": ("roadmap", "prm"),
    "belief roadmap": ("belief_roadmap", "belief_roadmap"),
    "RRT*": ("rrt_star", "rrt_star"),
    "GA": ("genetic", "genetic"),
    "ACO": ("ants", "ant_colony"),
    "improved ACO": ("ants", "improved_ant_colony"),
    "potential field and ACO": ("potential_field", "field_and_ants"),
}
PEERS: Final = tuple(_PLACES)


def planner(name: str) -> Planner:
    """A planner by its name in PEERS; its module is imported here.

    Raises:
        KeyError: no such planner.
    """
    module, function = _PLACES[name]
    found: Callable[..., object] = getattr(import_module(f"{__name__}.{module}"), function)
    return found  # type: ignore[return-value]
