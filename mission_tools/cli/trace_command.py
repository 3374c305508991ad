"""The command mission-trace."""

import sys
from argparse import Namespace
from pathlib import Path

from companion.cli.interrupts import importing
from companion.cli.parser import Parser, number
from companion.core.geo import LatLon
from mission_tools.cli.arguments import position, print_json, run_parsed, with_places
from mission_tools.cli.options import add_force
from mission_tools.errors import UsageError
from mission_tools.overwrite_guard import check_replaceable

PROGRAM = "mission-trace"
EXAMPLES = f"""
Turn an aerial photograph into a map of its water: name one or more places on the water, look at the preview,
and plan on the map.

PHOTO is a .jpg or .png with a world file beside it (.jgw, .pgw), or a GeoTIFF. Water of another colour, such
as a shaded bay, needs a --seed of its own; land that is taken for water needs a --land.

Examples:

    {PROGRAM} pond.jpg --seed 29.4082,-82.1698 --out pond.geojson --preview pond_traced.png

    {PROGRAM} pond.tif --seed 29.4082,-82.1698 --land 29.4079,-82.1695 --fill 2 --out pond.geojson

Exit codes: 0 done, 2 wrong usage or input.
"""


def _parser() -> Parser:
    parser = Parser(PROGRAM, EXAMPLES, "PHOTO", is_required=True)
    add = parser.add_argument_group("water").add_argument
    add("--seed", action="append", default=[], metavar="LAT,LON", help="a place on the water")
    add("--land", action="append", default=[], metavar="LAT,LON", help="a place whose like is land")
    add("--fill", type=number, default=0.0, metavar="M2", help="fill holes up to this [0]")
    add("--inset", type=number, default=1.0, metavar="PX", help="draw the outline into the water by this [1]")
    add("--threshold", type=number, metavar="SD", help="standard deviations a colour may be off [chosen]")
    files = parser.add_argument_group("files")
    files.add_argument("--out", type=Path, metavar="FILE", help="write the map: .geojson")
    files.add_argument("--preview", type=Path, metavar="FILE", help="draw the outline on the photo: .png")
    add_force(files)
    parser.add_common()
    return parser


def _trace(given: Namespace) -> None:
    photo, out, preview = Path(given.source), given.out, given.preview
    _check(photo, out, preview, force=given.force)
    seeds, land = _places("--seed", given.seed), _places("--land", given.land)
    if not seeds:
        raise UsageError("no --seed: name a place on the water, such as --seed 29.4082,-82.1698")
    with importing():
        from mission_tools.tracing.photo import TraceSettings, trace_photo  # noqa: PLC0415 - scipy, Pillow

    traced = trace_photo(photo, seeds, land, TraceSettings(given.threshold, given.fill, given.inset))
    chart = traced.chart()
    if out is not None:
        traced.save(out)
    if preview is not None:
        traced.preview(preview)
    area_m2 = float(chart.water.area)
    if given.as_json:
        files = {"saved": out and str(out), "preview": preview and str(preview)}
        tree = {"ok": True, "exit_code": 0, "area_m2": area_m2, "notes": list(traced.notes), **files}
        print_json(tree)
        return
    lines = [f"{photo}: {area_m2:.0f} m² of water", *(f"note: {note}" for note in traced.notes)]
    lines += [f"{verb} {path}" for verb, path in (("saved", out), ("drew", preview)) if path is not None]
    sys.stdout.write("\n".join(lines) + "\n")


def _check(photo: Path, out: Path | None, preview: Path | None, *, force: bool) -> None:
    """See early that files can be written and nothing is overwritten. Raises UsageError: names the file."""
    if out is not None and out.suffix.lower() not in (".geojson", ".json"):
        raise UsageError(f"--out {out}: expected a name that ends in .geojson")
    if preview is not None and preview.suffix.lower() != ".png":
        raise UsageError(f"--preview {preview}: expected a name that ends in .png")
    if preview is not None and preview.exists() and photo.exists() and preview.samefile(photo):
        raise UsageError(f"--preview {preview}: would overwrite the photograph; choose another name")
    for option, path in (("--out", out), ("--preview", preview)):
        if path is not None:
            check_replaceable(option, path, force=force)


def _places(option: str, texts: list[str]) -> list[LatLon]:
    found = [position(option, text) for text in texts]
    return [place for place in found if place is not None]


def run_program(arguments: list[str]) -> int:
    """Run the program; returns its exit code."""
    return run_parsed(_parser(), with_places(arguments), _trace)
