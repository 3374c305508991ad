"""From SOURCE to a mission: a mission file, or a route planned on a map."""

from dataclasses import replace
from pathlib import Path

from companion.core.geo import LatLon, LocalFrame
from mission_tools.assembly.areas import NO_AREAS, Areas
from mission_tools.assembly.check import check_mission, in_the_way
from mission_tools.assembly.map_source import MapSource, within
from mission_tools.assembly.plan_options import PlanOptions, flags
from mission_tools.assembly.planned_mission import PlannedMission
from mission_tools.errors import UsageError
from mission_tools.maps import build_chart, load_source
from mission_tools.mission.mission import Mission
from mission_tools.mission.plan_file import MISSION_SUFFIXES, load_mission
from mission_tools.mission.route import with_speed

NO_MAP = "none"
_OF_FILES = (
    "speed_m_s",
    "boat",
    "current",
    "wind",
    "depart",
    "split",
    "is_route_file",
    "check_on",
    "start_at",
)


def open_source(text: str, options: PlanOptions, areas: Areas = NO_AREAS) -> "MissionFile | MapSource":
    """Find out what SOURCE is. areas: fence and rally points that go with it; a route keeps inside the fence.
    Raises UsageError: wishes that do not go with it. PlanFileError, MapError: it cannot be used.
    """
    path = Path(text)
    options.check_split(is_finished=options.is_route_file or path.suffix.lower() in MISSION_SUFFIXES)
    if options.is_route_file:
        from mission_tools.files.drawn import load_drawn  # noqa: PLC0415 - seldom needed

        mission, notes = load_drawn(path)
        return MissionFile(path, mission, options, areas, notes)
    if path.suffix.lower() in MISSION_SUFFIXES:
        return MissionFile(path, load_mission(path), options, areas)
    if options.check_on is not None:
        raise UsageError(f"--check-on: only for a finished mission; a route on {text} keeps off its shores")
    source = load_source(text, lines_are_outlines=options.is_outline)
    if options.case is not None:
        source = source.with_case(options.case)
    return MapSource(text, source, options, areas)


class MissionFile:
    """A mission that is read from a file and needs no route planned."""

    wants_position = needs_position = False

    def __init__(
        self,
        path: Path,
        mission: Mission,
        options: PlanOptions,
        areas: Areas = NO_AREAS,
        notes: tuple[str, ...] = (),
    ) -> None:
        names = [name for name in options.given() if name not in _OF_FILES]
        if names:
            flagged = ", ".join(flags(names))
            raise UsageError(f"{path} is a mission already: {flagged} would plan one; leave that out")
        self._name = path.name
        self._mission = with_speed(areas.over(mission), options.speed_m_s)
        self._areas = areas
        self._notes = notes
        self._is_checked = options.check_on is not None
        self._water = None if options.check_on in (None, NO_MAP) else load_source(options.check_on).chart
        self._start = options.start_at

    def prepare(self, here: LatLon | None = None) -> PlannedMission:
        """The mission as it was read; without a map to check it on, on a chart without shores.

        Notes say what is odd in it (if that was asked for), and where it leaves a given fence.
        """
        mission, notes = self._mission, [*self._notes, *self._areas.notes]
        origin = next(iter(mission.places), mission.home or here or LatLon(0.0, 0.0))
        chart = build_chart(self._name, LocalFrame(origin), None, ())
        if mission.home is None and self._start is not None and chart.reaches(self._start):
            mission = replace(mission, home=self._start)
        if self._water is not None and all(map(self._water.reaches, mission.places)):
            chart = self._water
        elif self._water is not None:
            notes.append(f"leads to places that are nowhere near {self._water.name}: not checked on that map")
        chart = within(chart, self._areas)
        if self._is_checked:
            notes += map(str, check_mission(replace(mission, home=mission.home or origin), chart))
        elif not chart.is_open or chart.features:
            notes += map(str, in_the_way(mission, chart, 0.0))
        return PlannedMission(self._name, mission, chart, notes=tuple(notes))
