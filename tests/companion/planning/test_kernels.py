"""Which implementation is taken, and that a build without a compiler is no failure."""

import subprocess
import sys
from pathlib import Path

import pytest

from companion.planning import kernels

ROOT = Path(kernels.__file__).parents[2]
ASK = "from companion.planning.kernels import load; print(load('_segments', 'segments').__name__)"


def is_built() -> bool:
    return any((ROOT / "companion/planning").glob("_segments.*.so"))


def loaded(**environment: str) -> str:
    done = subprocess.run(
        [sys.executable, "-c", ASK], env=environment, cwd=ROOT, capture_output=True, text=True, check=True
    )
    return done.stdout.strip()


def test_the_compiled_kernel_is_taken_where_it_was_built() -> None:
    if not is_built():
        pytest.skip("the kernels are not built: python setup.py build_ext --inplace")
    assert loaded() == "companion.planning._segments"


def test_the_twin_is_taken_where_the_environment_asks_for_it() -> None:
    assert loaded(MAVBOAT_PURE="1") == "companion.planning.segments"


def test_the_twin_is_taken_where_nothing_was_built() -> None:
    assert kernels.load("_never_built", "segments").__name__ == "companion.planning.segments"
