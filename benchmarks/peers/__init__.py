"""Planners to compare with, from the related work of the paper that this project implements.

    python -m benchmarks peers

Each is a function of a `Sea`, start, goal, seed and deadline (interface.py). They are tuned in good faith on
the pool and the lake scenario, take no short cut of ours, and give the same path for the same seed.
"""

from collections.abc import Callable
from typing import Final

from benchmarks.peers.ants import ant_colony
from benchmarks.peers.grid_searches import dijkstra, theta_star
from benchmarks.peers.interface import Deadline, Path, Sea
from benchmarks.peers.roadmap import prm
from benchmarks.peers.rrt_star import rrt_star
from companion.core.geo import Point

PEERS: Final[dict[str, Callable[[Sea, Point, Point, int, Deadline], Path]]] = {
    "Dijkstra": dijkstra,
    "Theta*": theta_star,
    "PRM": prm,
    "RRT*": rrt_star,
    "ACO": ant_colony,
}
