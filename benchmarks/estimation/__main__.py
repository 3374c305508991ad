"""Record what the estimator is given in runs, replay estimators of several checkouts on it, and judge one by
NEES and NIS: record, compare, consistency."""

import argparse
import sys
from pathlib import Path

from benchmarks.estimation import compare, consistency
from benchmarks.estimation.cases import courses, faults, record_all
from benchmarks.estimation.picture import draw_nees


def main(arguments: list[str]) -> int:
    """Entry point."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.estimation", description=__doc__)
    commands = parser.add_subparsers(required=True, dest="command")
    record = commands.add_parser("record", help="sail every case and keep what the estimator was given")
    record.add_argument("folder", type=Path)
    record.add_argument("seeds", type=int, nargs="*", default=[1])
    comparing = commands.add_parser("compare", help="replay recordings and print a table of errors")
    comparing.add_argument("recordings", type=Path, nargs="+", help="files, or folders of .npz files")
    comparing.add_argument("--of", type=Path, nargs="+", default=[Path.cwd()], help="checkouts [this one]")
    consistent = commands.add_parser("consistency", help="average NEES and NIS over random runs")
    consistent.add_argument("--runs", type=int, default=200)
    consistent.add_argument("--first-seed", type=int, default=1)
    consistent.add_argument(
        "--png", type=Path, help="draw the NEES over time with the receiver that errs as stated"
    )
    consistent.add_argument("--of", type=Path, default=Path.cwd(), help="checkout [this one]")
    chosen = parser.parse_args(arguments)
    if chosen.command == "record":
        for seed in chosen.seeds:
            record_all(courses(range(seed, seed + 1)), chosen.folder / "courses")
            record_all(faults(range(seed, seed + 1)), chosen.folder / "faults")
        return 0
    if chosen.command == "consistency":
        seeds = range(chosen.first_seed, chosen.first_seed + chosen.runs)
        found = {
            f"{hull} hull, receiver {receiver}": consistency.campaign(
                seeds, hull, receiver, chosen.of.resolve()
            )
            for receiver in ("stated", "standard")
            for hull in ("known", "other")
        }
        print(consistency.table(found))  # noqa: T201
        if chosen.png is not None:
            stated = {title: nees for title, (nees, _) in found.items() if title.endswith("stated")}
            draw_nees(stated, chosen.png)
        return 0
    paths = [
        path for one in chosen.recordings for path in (sorted(one.rglob("*.npz")) if one.is_dir() else [one])
    ]
    checkouts = [one.resolve() for one in chosen.of]
    for number, checkout in enumerate(checkouts):
        print(f"{number}: {checkout}")  # noqa: T201
    print(compare.table(compare.compare([path.resolve() for path in paths], checkouts)))  # noqa: T201
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
