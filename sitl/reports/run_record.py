"""A run on disk: one .npz file with the numbers of every tick, and the rest as JSON in it."""

import dataclasses
import json
import zipfile
import zlib
from pathlib import Path
from typing import Any, Self

import msgspec
import numpy as np
import shapely
from numpy.typing import NDArray

from companion.cli.output_file import output_file
from companion.core.errors import ConfigError
from companion.core.geo import LatLon, LocalFrame, Point
from mission_tools.maps.chart import Area, Chart, Feature, build_chart
from sitl.run.mission_run import MissionRun, Result
from sitl.run.recording.estimate_recorder import Estimate
from sitl.run.timeline import Event
from sitl.world.truth import Truth

_SETTINGS = ("environment", "faults", "movers", "hull", "thrusters", "battery", "sensors", "vehicle")
Numbers = NDArray[np.float64]


@dataclasses.dataclass(frozen=True, slots=True)
class RunRecord:
    """The data of a run for reports. truth and estimates: columns by name, by tick and by tenth of a second.

    echoes: shape (n, 3), time, north and east. planned: the mission's points.
    """

    result: dict[str, Any]
    settings: dict[str, Any]
    chart: Chart
    clearance_m: float
    planned: tuple[Point, ...]
    events: tuple[Event, ...]
    truth: dict[str, Numbers]
    legs: NDArray[np.int64]
    estimates: dict[str, Numbers]
    echoes: Numbers

    @classmethod
    def of(cls, mission_run: MissionRun, result: Result) -> Self:
        """The record of a run that has ended."""
        scenario = mission_run.scenario
        return cls(
            result=dataclasses.asdict(result),
            settings={
                name: msgspec.json.decode(msgspec.json.encode(getattr(scenario, name))) for name in _SETTINGS
            },
            chart=scenario.chart,
            clearance_m=scenario.route.clearance_m or 0.0,
            planned=tuple(mission_run.planned),
            events=tuple(mission_run.timeline.events),
            truth=_columns(mission_run.recorder.rows, Truth._fields),
            legs=mission_run.recorder.legs,
            estimates=_columns(mission_run.estimates.rows, Estimate._fields),
            echoes=mission_run.estimates.echoes,
        )

    @property
    def track(self) -> list[Point]:
        """Where the boat was, tick by tick."""
        columns = zip(self.truth["north_m"].tolist(), self.truth["east_m"].tolist(), strict=True)
        return [Point(north_m, east_m) for north_m, east_m in columns]

    def save(self, path: Path) -> None:
        """Write the file. Raises OutputError: it cannot be written."""
        rest = {
            "result": self.result,
            "settings": self.settings,
            "chart": _chart_tree(self.chart),
            "clearance_m": self.clearance_m,
            "planned": self.planned,
            "events": self.events,
            "truth": list(self.truth),
            "estimates": list(self.estimates),
        }
        with output_file(path) as aside, aside.open("wb") as file:  # a file: numpy would add a suffix
            np.savez_compressed(
                file,
                allow_pickle=False,
                rest=np.frombuffer(json.dumps(rest).encode(), dtype=np.uint8),
                truth=np.column_stack(list(self.truth.values())),
                legs=self.legs,
                estimates=np.column_stack(list(self.estimates.values())),
                echoes=self.echoes,
            )


def load_record(path: Path) -> RunRecord:
    """Read a run. Raises ConfigError: it cannot be read, or is not the record of a run."""
    expected = "the record of a run, as boat-sitl sail --record writes it"
    try:
        with path.open("rb") as opened, np.load(opened, allow_pickle=False) as file:
            arrays = {name: file[name] for name in file.files}
        return _record(json.loads(arrays.pop("rest").tobytes()), arrays)
    except FileNotFoundError:
        raise ConfigError(f"{path}: no such file: expected {expected}") from None
    except (OSError, ValueError, KeyError, TypeError, EOFError, zipfile.BadZipFile, zlib.error) as error:
        raise ConfigError(f"{path}: not {expected}: {error}") from None


def _record(rest: dict[str, Any], arrays: dict[str, NDArray[Any]]) -> RunRecord:
    return RunRecord(
        result=rest["result"],
        settings=rest["settings"],
        chart=_chart(rest["chart"]),
        clearance_m=rest["clearance_m"],
        planned=tuple(Point(*at) for at in rest["planned"]),
        events=tuple(Event(*event) for event in rest["events"]),
        truth=_columns(arrays["truth"], rest["truth"]),
        legs=arrays["legs"],
        estimates=_columns(arrays["estimates"], rest["estimates"]),
        echoes=arrays["echoes"],
    )


def _columns(rows: Numbers, names: "tuple[str, ...] | list[str]") -> dict[str, Numbers]:
    return {name: np.ascontiguousarray(rows[:, index]) for index, name in enumerate(names)}


def _chart_tree(chart: Chart) -> dict[str, Any]:
    return {
        "name": chart.name,
        "origin": list(dataclasses.astuple(chart.frame.origin)),
        "water": None if chart.is_open else shapely.to_wkt(chart.water, rounding_precision=4),
        "features": [
            (feature.name, feature.kind, shapely.to_wkt(feature.shape, rounding_precision=4))
            for feature in chart.features
        ],
    }


def _chart(tree: dict[str, Any]) -> Chart:
    water: Area | None = None if tree["water"] is None else shapely.from_wkt(tree["water"])
    features = [Feature(name, kind, shapely.from_wkt(shape)) for name, kind, shape in tree["features"]]
    return build_chart(tree["name"], LocalFrame(LatLon(*tree["origin"])), water, features)
