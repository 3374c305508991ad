"""Compile the hot modules in place, or go back to their sources: `python -m sitl.compiled [build | remove]`.

Python then takes the compiled modules without being told. They give the same bytes as their sources, which
stay as they are; but a source that is changed afterwards has no effect until it is compiled again.
"""

import os
import sys

from mypyc.build import mypycify
from setuptools import Distribution

from sitl.compiled.modules import ROOT, remember, remove, sources

# The library with the code of all compiled modules lies inside a package: an installed program finds its
# packages wherever it is started, but nothing beside them.
_GROUP = "companion._compiled"
_HEADERS = "build/companion"  # where mypyc writes a group's headers, which the modules' files ask for by name
_FLAGS = "-ffp-contract=off"  # a fused multiply-add rounds once where Python rounds twice


def main(arguments: list[str]) -> int:
    """The exit code is 1 when something cannot be compiled; then nothing is."""
    os.chdir(ROOT)
    remove()
    if arguments == ["remove"]:
        return 0
    if arguments not in ([], ["build"]):
        sys.stderr.write(f"compiled: {' '.join(arguments)}: expected build or remove\n")
        return 2
    try:
        _build()
    except BaseException:
        remove()
        raise
    remember()
    sys.stdout.write(f"compiled: {len(sources())} modules; changes need make fast again, or make slow\n")
    return 0


def _build() -> None:
    os.environ["CFLAGS"] = f"{os.environ.get('CFLAGS', '')} {_FLAGS}"
    modules = mypycify(
        ["--config-file=pyproject.toml", *sources()], opt_level="1", multi_file=True, group_name=_GROUP
    )
    for module in modules:
        module.include_dirs.append(_HEADERS)
    command = Distribution({"name": "mavboat", "ext_modules": modules}).get_command_obj("build_ext")
    command.inplace = True
    command.ensure_finalized()
    command.run()


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
