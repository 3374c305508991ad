"""One run as a page: figures, pictures, what happened when, and the settings it was sailed with."""

import json
from typing import Any

from mission_tools.drawing.report_page import Mark, Page
from sitl.reports.labels import label
from sitl.reports.run_pictures import draw_innovations, draw_panels, draw_sonar_map, draw_track_chart
from sitl.reports.run_record import RunRecord

_TILES = (
    ("time_s", "time", "s"),
    ("path_length_m", "sailed", "m"),
    ("cross_track_rms_m", "cross-track RMS", "m"),
    ("cross_track_max_m", "cross-track, largest", "m"),
    ("min_clearance_m", "nearest to shore", "m"),
    ("groundings", "groundings", ""),
)
_BAD = frozenset(("fault", "touch", "motors"))


def run_page(record: RunRecord) -> str:
    """The page, as HTML."""
    result = record.result
    ended = "completed" if result["completed"] else f"not completed, ends in {result['final_mode']}"
    page = Page(f"{result['scenario']}", f"seed {result['seed']}: mission {ended}")
    page.tiles([(name, _with_unit(result.get(key), unit)) for key, name, unit in _TILES])
    page.heading("Track")
    page.picture(
        draw_track_chart(record),
        "The true track over chart and plan. Red cross: a fault begins. Orange triangle: the boat brakes, "
        "with both motors astern.",
        is_vector=False,
    )
    page.heading("Over time")
    page.picture(
        draw_panels(record),
        "The truth, unless it says otherwise. Shaded: modes; grey lines: waypoints; red: from the begin of a "
        "fault to its end; orange triangles: the boat brakes, with both motors astern.",
    )
    innovations = draw_innovations(record)
    if innovations is not None:
        page.heading("Estimator")
        page.picture(
            innovations,
            "Innovations of the filter in their own standard deviations: 95 % should lie in the band. Red: "
            "rejected by a gate. Below: the probability that a sensor is wrong.",
        )
    sonar = draw_sonar_map(record)
    if sonar is not None:
        page.heading("Sonar")
        page.picture(sonar, "Every echo where the boat took it to be, over the true chart.", is_vector=False)
    page.heading("What happened")
    marks: list[Mark] = ["bad" if event.kind in _BAD else "" for event in record.events]
    rows = [(f"{event.time_s:.1f}", event.kind, event.text) for event in record.events]
    page.table(("time (s)", "what", ""), rows, marks)
    page.heading("Figures")
    page.table(("figure", "value"), [(label(name), _plain(value)) for name, value in result.items()])
    page.heading("Settings")
    for name, tree in record.settings.items():
        page.details(name, json.dumps(tree, indent=2, ensure_ascii=False))
    return page.render()


def _with_unit(value: Any, unit: str) -> str:  # noqa: ANN401 (any figure)
    return "–" if value is None else f"{value:.3g} {unit}".strip()


def _plain(value: Any) -> str:  # noqa: ANN401 (any figure)
    if isinstance(value, bool):
        return "yes" if value else "no"
    return f"{value:.6g}" if isinstance(value, float) else "–" if value is None else str(value)
