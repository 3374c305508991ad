"""The planning kernels, in C where there is a compiler; everything else is in pyproject.toml.

A kernel that cannot be built is skipped: its twin in Python takes its place (companion/planning/kernels.py).
A new `companion/planning/_NAME.pyx` is built without being listed here.
"""

from pathlib import Path

from Cython.Build import cythonize
from setuptools import Extension, setup

PACKAGE = Path("companion/planning")
SOURCES = {"_polygon": PACKAGE / "polygon.py"} | {path.stem: path for path in sorted(PACKAGE.glob("_*.pyx"))}
# A fused multiply-add rounds once where Python rounds twice
FLAGS = ["-O2", "-ffp-contract=off"]

setup(
    ext_modules=cythonize(  # type: ignore[no-untyped-call, unused-ignore]
        [
            Extension(f"companion.planning.{name}", [str(path)], extra_compile_args=FLAGS, optional=True)
            for name, path in SOURCES.items()
        ],
        build_dir="build/cython",
        compiler_directives={
            "language_level": "3",
            "boundscheck": False,
            "wraparound": False,
            "cdivision": True,
            "initializedcheck": False,
        },
    )
)
