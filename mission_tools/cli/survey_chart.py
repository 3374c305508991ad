"""`boat-survey chart`: a depth chart from the soundings of logs."""

import math
from pathlib import Path
from typing import Annotated, Literal

from companion.cli.command_line import Option, echo
from companion.cli.interrupts import importing
from companion.cli.output_file import write_text
from mission_tools.cli.survey_export import Logs
from mission_tools.errors import UsageError


def chart(
    log: Logs,
    map_source: Annotated[str, Option("--map", metavar="SOURCE", help="scenario or map of the lake")],
    out: Annotated[Path, Option("--out", "-o", metavar="DIR", help="folder for all files")],
    water_level: Annotated[float, Option(metavar="M", help="surface above the map's shore line, then")] = 0.0,
    level: Annotated[float, Option(metavar="M", help="volume below this, above the shore line")] = 0.0,
    cell: Annotated[float | None, Option(metavar="M", least=0.05, help="of the grid [spacing ÷ 5]")] = None,
    spacing: Annotated[float | None, Option(metavar="M", least=0.5, help="of the lines [measured]")] = None,
    gap: Annotated[float | None, Option(metavar="M", least=0.1, help="unsurveyed beyond [¾ spacing]")] = None,
    clearance: Annotated[float | None, Option(metavar="M", least=0.0, help="of the boat [the map's]")] = None,
    sound_speed: Annotated[float | None, Option(metavar="M_S", least=1300, most=1700, help="mean")] = None,
    temperature: Annotated[float | None, Option(metavar="C", least=0, most=40, help="of the water")] = None,
    salinity: Annotated[float, Option(metavar="PSU", least=0.0, most=45.0, help="of sea water")] = 0.0,
    beam: Annotated[float, Option(metavar="DEG", least=0.0, most=90.0, help="full width of the cone")] = 25.0,
    lever: Annotated[str, Option(metavar="F,S", help="of the transducer beyond the log's, metres")] = "0,0",
    latency: Annotated[float, Option(metavar="S", help="of the sounder beyond the log's")] = 0.0,
    quality: Annotated[float, Option(metavar="SHARE", least=0.0, most=1.0, help="least, of an echo")] = 0.5,
    order: Annotated[Literal["special", "1a", "1b", "2"], Option(help="of IHO S-44")] = "1b",
    no_shore: Annotated[bool, Option(help="walls: the depth is not 0 at the shore line")] = False,
    force: Annotated[bool, Option(help="write into a folder of other files")] = False,
) -> None:
    """Make a depth chart with its uncertainty from the soundings of logs.

    Soundings are reduced to the datum, cleaned and interpolated; each rejected one has a reason.
    The folder gets chart.html, chart.png, depth.tif, chart.gpkg, contours, gaps.geojson, lake.geojson,
    depth.xyz and chart.json: docs/survey.md explains them. Exit code 2 if the soundings make no chart.

    Example:  boat-survey chart 00012.bin --map pond.geojson --out out/chart --temperature 16
    """
    with importing():
        from mission_tools.bathymetry.chart_page import chart_page  # noqa: PLC0415 - matplotlib, GDAL
        from mission_tools.bathymetry.cleaning import CleaningSettings  # noqa: PLC0415
        from mission_tools.bathymetry.depth_chart import ChartSettings, charted  # noqa: PLC0415
        from mission_tools.bathymetry.from_log import read_logs, soundings_of  # noqa: PLC0415
        from mission_tools.bathymetry.picture import draw_depths  # noqa: PLC0415
        from mission_tools.bathymetry.products import write_products  # noqa: PLC0415
        from mission_tools.bathymetry.reduction import Corrections  # noqa: PLC0415
        from mission_tools.bathymetry.surface import SurfaceSettings  # noqa: PLC0415
        from mission_tools.drawing.draw import save_figure  # noqa: PLC0415
        from mission_tools.maps import load_source  # noqa: PLC0415

    if not force and out.is_dir() and any(out.iterdir()) and not (out / "chart.json").is_file():
        raise UsageError(f"--out {out}: holds other files: choose another folder, or add --force")
    ahead, right = _pair(lever)
    source = load_source(map_source)
    wanted = clearance if clearance is not None else source.route.clearance_m
    logs = read_logs(log)
    for note in (note for one in logs for note in one.notes):
        echo(f"note: {note}", is_error=True)
    settings = ChartSettings(
        Corrections(
            water_level, sound_speed, temperature, salinity, math.radians(beam), ahead, right, latency
        ),
        CleaningSettings(least_quality=quality),
        SurfaceSettings(cell, spacing, gap, has_shore=not no_shore),
        4.0 if wanted is None else wanted,
        order,
        level,
    )
    made = charted(source.chart, soundings_of(logs), settings)
    figures = write_products(made, out)
    picture = draw_depths(made)
    save_figure(out / "chart.png", picture)
    write_text(out / "chart.html", chart_page(made, figures, picture))
    for reason, count in figures["soundings"].items():
        echo(f"{count:9,} {reason}")
    echo(
        f"{source.chart.name}: {figures['area_m2']:,.0f} m², {figures['volume_m3']:,.0f} m³, mean "
        f"{figures['mean_depth_m'] or 0.0:.2f} m, deepest {figures['max_depth_m']:.2f} m, "
        f"± {figures['band_median_m']:.2f} m (90 %), {100 * (figures['coverage'] or 0.0):.1f} % covered"
    )
    echo(f"saved in {out}: see chart.html")


def _pair(text: str) -> tuple[float, float]:
    try:
        ahead, right = (float(part) for part in text.split(","))
    except ValueError:
        raise UsageError(f"--lever {text}: expected FORWARD,STARBOARD in metres, such as 0.4,-0.1") from None
    return ahead, right
