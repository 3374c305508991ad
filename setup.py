"""The planning kernels, in C where there is a compiler; everything else is in pyproject.toml.

A kernel that cannot be built is skipped: its twin in Python takes its place (companion/planning/kernels.py).
A new `companion/planning/_NAME.pyx` is built without being listed here.
With MAVBOAT_PURE=1 nothing is compiled, and the wheel is for every machine (`make wheel`).
"""

import os
from pathlib import Path

from Cython.Build import cythonize
from setuptools import Extension, setup

PACKAGE = Path("companion/planning")
# A module with C types in a .pxd beside it is its own twin; a .pyx has a twin of another name.
SOURCES = {path.stem: PACKAGE / f"{path.stem[1:]}.py" for path in sorted(PACKAGE.glob("_*.pxd"))}
SOURCES |= {path.stem: path for path in sorted(PACKAGE.glob("_*.pyx"))}
# A fused multiply-add rounds once where Python rounds twice
FLAGS = ["-O2", "-ffp-contract=off"]

DIRECTIVES = {
    "language_level": "3",
    "annotation_typing": False,  # the C types are in the .pxd
    "boundscheck": False,
    "wraparound": False,
    "cdivision": True,
    "initializedcheck": False,
}

kernels = cythonize(  # type: ignore[no-untyped-call, unused-ignore]
    []
    if os.environ.get("MAVBOAT_PURE")
    else [
        Extension(f"companion.planning.{name}", [str(path)], extra_compile_args=FLAGS)
        for name, path in SOURCES.items()
    ],
    build_dir="build/cython",
    force=True,  # one kernel contains the C layout of another
    compiler_directives=DIRECTIVES,
)
for kernel in kernels:
    kernel.optional = True  # cythonize drops it

setup(ext_modules=kernels)
