"""Planners to compare with, from the related work of the paper that this project implements.

    python -m benchmarks peers

Each is a function of a `Sea`, start, goal, seed, deadline and effort (interface.py). An effort of 1 is the
work that pays on the pool and the lake scenario, 2 is twice the cells, samples, iterations or generations.
They take no short cut of ours, and give the same path for the same seed and effort.
"""

from typing import Final

from benchmarks.peers.ants import ant_colony
from benchmarks.peers.grid_searches import dijkstra, theta_star
from benchmarks.peers.interface import Planner
from benchmarks.peers.roadmap import prm
from benchmarks.peers.rrt_star import rrt_star

PEERS: Final[dict[str, Planner]] = {
    "Dijkstra": dijkstra,
    "Theta*": theta_star,
    "PRM": prm,
    "RRT*": rrt_star,
    "ACO": ant_colony,
}
