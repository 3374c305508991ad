"""Fuzz every target for a while, one process each: `python -m fuzz [--seconds 60] [TARGET …]`.

`python -m fuzz --keep` folds what a run has found worth keeping into the committed corpus.
"""

import argparse
import subprocess
import sys
from pathlib import Path

import atheris

from fuzz import corpus

OUT = Path("out/fuzz")
_HANG_S = 5


def main(arguments: list[str]) -> int:
    """Run; the exit code is 1 when a target found something."""
    parser = argparse.ArgumentParser(prog="fuzz", description=__doc__)
    parser.add_argument("targets", nargs="*", help="which; all without a name")
    parser.add_argument("--seconds", type=int, default=60, help="for each target")
    parser.add_argument("--keep", action="store_true", help="fold finds into tests/vectors/fuzz")
    parser.add_argument("--inside", action="store_true", help=argparse.SUPPRESS)
    chosen = parser.parse_args(arguments)
    if chosen.inside:
        _fuzz(chosen.targets[0], chosen.seconds)
    with atheris.instrument_imports(include=["companion", "mission_tools"]):
        from fuzz.targets import TARGETS  # noqa: PLC0415
    names = chosen.targets or list(TARGETS)
    if unknown := [name for name in names if name not in TARGETS]:
        sys.stderr.write(f"fuzz: no {', '.join(unknown)}; there are {', '.join(TARGETS)}\n")
        return 2
    if chosen.keep:
        for name in names:
            found = [path.read_bytes() for path in (OUT / name).glob("*")]
            corpus.save(name, [*corpus.load(name), *found])
        return 0
    command = [sys.executable, "-m", "fuzz", "--inside", "--seconds", str(chosen.seconds)]
    ends = {name: subprocess.run([*command, name], check=False).returncode for name in names}
    for name, code in ends.items():
        sys.stdout.write(f"fuzz: {name}: {'nothing found' if code == 0 else f'FOUND SOMETHING ({code})'}\n")
    return int(any(ends.values()))


def _fuzz(name: str, seconds: int) -> None:
    """Fuzz one target in this process. Does not return."""
    with atheris.instrument_imports(include=["companion", "mission_tools"]):
        from fuzz.targets import TARGETS  # noqa: PLC0415
    folder = OUT / name
    folder.mkdir(parents=True, exist_ok=True)
    for number, data in enumerate(corpus.load(name)):
        (folder / f"seed-{number:04d}").write_bytes(data)
    atheris.Setup(
        [
            "fuzz",
            f"-max_total_time={seconds}",
            f"-timeout={_HANG_S}",
            "-max_len=2048",
            "-print_final_stats=1",
            "-verbosity=0",
            f"-artifact_prefix={OUT}/crash-{name}-",
            str(folder),
        ],
        TARGETS[name],
    )
    atheris.Fuzz()


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
