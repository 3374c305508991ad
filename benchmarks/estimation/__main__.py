"""Judge the estimator by NEES and NIS, averaged over random runs."""

import argparse
import sys
from pathlib import Path

from benchmarks.estimation import consistency
from benchmarks.estimation.picture import draw_nees


def main(arguments: list[str]) -> int:
    """Entry point."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.estimation", description=__doc__)
    parser.add_argument("--runs", type=int, default=200)
    parser.add_argument("--first-seed", type=int, default=1)
    parser.add_argument("--png", type=Path, help="draw the NEES over time")
    chosen = parser.parse_args(arguments)
    seeds = range(chosen.first_seed, chosen.first_seed + chosen.runs)
    found = {
        f"{hull} hull, receiver {receiver}": consistency.campaign(seeds, hull, receiver)
        for receiver in consistency.RECEIVERS
        for hull in ("known", "other")
    }
    print(consistency.table(found))  # noqa: T201
    if chosen.png is not None:
        alone = {title: nees for title, (nees, _) in found.items() if title.endswith("standalone")}
        draw_nees(alone, chosen.png)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
