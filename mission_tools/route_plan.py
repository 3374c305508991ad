"""A planned route, as Python programs and notebooks see it."""

import io
import math
from dataclasses import dataclass
from itertools import pairwise
from os import PathLike, fspath
from pathlib import Path
from typing import TYPE_CHECKING

from companion.core.geo import LatLon, bearing_rad, distance_m
from mission_tools.assembly.planned_mission import PlannedMission
from mission_tools.job.planned import check_outputs, save
from mission_tools.mission.mission import Mission
from mission_tools.wording import distance

if TYPE_CHECKING:
    from mission_tools.contract.budget import Budget


@dataclass(frozen=True, slots=True)
class RouteLeg:
    """A straight leg. course_deg: clockwise from true north, 0 to 360. clearance_m: to the nearest shore or
    obstacle, infinite in open water. hold_s: how long the boat holds at its end.
    """

    start: LatLon
    end: LatLon
    length_m: float
    course_deg: float
    clearance_m: float
    hold_s: float = 0.0


@dataclass(frozen=True, slots=True)
class RoutePlan:
    """A route on a map; in a notebook it shows itself as a picture.

    planned: the same as the rest of the package has it.
    """

    planned: PlannedMission

    @property
    def mission(self) -> Mission:
        """The mission that a vehicle would be given: items, home, fence and rally points."""
        return self.planned.mission

    @property
    def points(self) -> tuple[LatLon, ...]:
        """The route, start and goal included."""
        home, places = self.mission.home, self.mission.places
        return places if home is None else (home, *places)

    @property
    def length_m(self) -> float:
        """Of the whole route."""
        return sum(leg.length_m for leg in self.legs)

    @property
    def min_clearance_m(self) -> float:
        """Smallest distance from the route to a shore or obstacle; infinite in open water."""
        return min((leg.clearance_m for leg in self.legs), default=math.inf)

    @property
    def hold_s(self) -> float:
        """Time that the boat holds at its stations, in all."""
        return sum(leg.hold_s for leg in self.legs)

    @property
    def notes(self) -> tuple[str, ...]:
        """What a person should know about the route."""
        return self.planned.notes

    @property
    def legs(self) -> tuple[RouteLeg, ...]:
        """The legs in the order of sailing."""
        chart, points = self.planned.chart, self.planned.points
        holds_s = [item.hold_s for item in self.mission.items if item.place is not None]
        return tuple(
            RouteLeg(
                start,
                end,
                distance_m(a, b),
                math.degrees(bearing_rad(a, b)) % 360.0,
                chart.leg_clearance_m(a, b),
                hold_s,
            )
            for (start, end), (a, b), hold_s in zip(
                pairwise(self.points), pairwise(points), holds_s[-len(points) + 1 :], strict=True
            )
        )

    def save(self, path: str | PathLike[str], *, force: bool = False) -> Path:
        """Write the mission, or a picture of it; the suffix chooses the format. Returns the path.

        force: replace a file that this program did not write. Raises PlanFileError, UsageError: no such
        format, or it cannot hold the mission. OutputError: the file cannot be written.
        """
        file = Path(path)
        check_outputs(file, None, (), force=force)
        save(self.mission, file, self.planned)
        return file

    def budget(
        self, boat: str | PathLike[str], current: str | None = None, wind: str | None = None
    ) -> "Budget":
        """Time in s and charge in mAh, out and home. boat: its TOML, or an emulated boat's name.

        current: speed and direction it flows to, as "0.5,90", or a file (see `mission-plan --help`). wind:
        mean speed and where it comes from, as "6@270". Raises ConfigError, UsageError, MapError: boat,
        current or wind. NoRoute: a leg that cannot be sailed against them.
        """
        from mission_tools.contract.budget import planned_budget  # noqa: PLC0415 - seldom needed
        from mission_tools.costs.boat import load_boat  # noqa: PLC0415

        return planned_budget(self.planned, load_boat(fspath(boat), wind), current)

    def with_contract(self, boat: str | PathLike[str] | None = None) -> "RoutePlan":
        """The same route with a fence and rally points from its map, within what the boat holds. Raises
        NoRoute: no fence holds this route.
        """
        from mission_tools.contract.water_contract import with_contract  # noqa: PLC0415 - as above
        from mission_tools.costs.boat import load_boat  # noqa: PLC0415

        return RoutePlan(with_contract(self.planned, load_boat(None if boat is None else fspath(boat))))

    def __str__(self) -> str:
        near_m = self.min_clearance_m
        said = f"{self.planned.name}: {distance(self.length_m)} in {len(self.legs)} legs"
        return said + (f", never nearer than {distance(near_m)} to anything" if near_m < math.inf else "")

    def _repr_png_(self) -> bytes:
        return picture(self.planned)


def picture(planned: PlannedMission) -> bytes:
    """The picture of a mission on its map, as PNG."""
    from mission_tools.drawing.preview import figure_of  # noqa: PLC0415 - matplotlib takes a second to import

    written = io.BytesIO()
    figure_of(planned).savefig(written, format="png")
    return written.getvalue()
