"""The kernels of planning, in C where there is a compiler; the rest is in pyproject.toml.

A kernel that cannot be built is skipped: its twin in Python takes its place (companion/planning/kernels.py).
A new `_NAME.pyx` in their folders is built without being listed here.
With MAVBOAT_PURE=1 nothing is compiled, and the wheel is for every machine (`make wheel`).
"""

import os
from pathlib import Path

from Cython.Build import cythonize
from setuptools import Extension, setup

PACKAGES = (Path("companion/planning"),)
# A module with C types in a .pxd beside it is its own twin; a .pyx has a twin of another name.
SOURCES = {
    path.with_suffix(""): path if path.suffix == ".pyx" else path.with_name(f"{path.stem[1:]}.py")
    for package in PACKAGES
    for path in sorted(package.glob("_*.p[xy][dx]"))
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
