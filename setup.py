"""The kernels of planning, in C where there is a compiler; the rest is in pyproject.toml.

A kernel `_NAME` is `NAME.py`, compiled with the C types of `_NAME.pxd` beside it. One that cannot be built is
skipped: its source runs in its place (companion/planning/kernels.py).
With MAVBOAT_PURE=1 nothing is compiled, and the wheel is for every machine (`make wheel`).
"""

import os
from pathlib import Path

from Cython.Build import cythonize
from setuptools import Extension, setup

PACKAGES = (Path("companion/planning"),)
SOURCES = {
    path.with_suffix(""): path.with_name(f"{path.stem[1:]}.py")
    for package in PACKAGES
    for path in sorted(package.glob("_*.pxd"))
}
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
        Extension(".".join(name.parts), [str(path)], extra_compile_args=FLAGS)
        for name, path in SOURCES.items()
    ],
    build_dir="build/cython",
    force=True,  # one kernel contains the C layout of another
    compiler_directives=DIRECTIVES,
)
for kernel in kernels:
    kernel.optional = True  # cythonize drops it

setup(ext_modules=kernels)
