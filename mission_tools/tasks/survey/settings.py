"""What a survey is asked to be."""

import math
from dataclasses import dataclass, field

from companion.core.geo import Point
from mission_tools.costs.boat import Boat
from mission_tools.errors import UsageError
from mission_tools.planning.planner import PlanSettings
from mission_tools.tasks.survey.patterns import PatternName

MOST_OVERLAP = 0.9
BOAT_TURN_RADIUS_M = 0.0
SHORE_PASSES = (6, 3, 0)  # many are shortest for ragged shores, none for straight ones: docs/tasks.md


@dataclass(frozen=True, slots=True)
class SurveySettings:
    """Tracks and how they are sailed.

    Two of footprint_m (the width that the sensor covers, half of it on either side), overlap (the share of a
    footprint that the next one covers again) and spacing_m (between tracks) give the third; spacing_m alone
    is a footprint without overlap. angle_rad: course of the tracks, 0 = north, clockwise; None: the one with
    the fewest turns. plan: clearance and margin, which tracks and transits keep. shore_passes: how often to
    sail along the shores and the area's edge, each pass a spacing inside of the one before, while there is
    water left; 0: tracks only; None: of SHORE_PASSES, but one where angle_rad or lead_m is given.
    cross_spacing_m: between lines across the tracks, for checking; None: no cross lines. turn_radius_m: of
    the boat's turns at its survey speed; 0: it turns on the spot. lead_m: straight on before and after each
    track, for a sensor that is towed. pattern: to sail instead of tracks and passes, from the datum; None:
    the middle of the area. has_gaps: the area is what an earlier survey left out, so each part of it gets
    tracks of its own, one at least, and no passes. is_return: end where the boat started. Raises UsageError:
    values that make no sense, or do not go together.
    """

    spacing_m: float | None = None
    footprint_m: float | None = None
    overlap: float | None = None
    angle_rad: float | None = None
    plan: PlanSettings = field(default_factory=PlanSettings)
    shore_passes: int | None = None
    cross_spacing_m: float | None = None
    turn_radius_m: float = BOAT_TURN_RADIUS_M
    lead_m: float = 0.0
    pattern: PatternName | None = None
    datum: Point | None = None
    has_gaps: bool = False
    is_return: bool = False

    def __post_init__(self) -> None:
        for name in ("spacing_m", "footprint_m", "cross_spacing_m"):
            value = getattr(self, name)
            if value is not None and not 0.0 < value < math.inf:
                said = name.removesuffix("_m").replace("_", " ")
                raise UsageError(f"{said} is {value:g} m: expected more than 0")
        if self.angle_rad is not None and not math.isfinite(self.angle_rad):
            raise UsageError(f"angle is {self.angle_rad}: expected a number")
        if self.overlap is not None and not 0.0 <= self.overlap <= MOST_OVERLAP:
            raise UsageError(f"overlap is {self.overlap:g}: expected a share from 0 to {MOST_OVERLAP:g}")
        if (self.shore_passes or 0) < 0:
            raise UsageError(f"shore passes are {self.shore_passes}: expected 0 or more")
        if not 0.0 <= self.turn_radius_m < math.inf:
            raise UsageError(f"turn radius is {self.turn_radius_m:g} m: expected 0 or more")
        if not 0.0 <= self.lead_m < math.inf:
            raise UsageError(f"lead is {self.lead_m:g} m: expected 0 or more")
        if self.spacing_m is None and self.footprint_m is None:
            raise UsageError("a survey needs the spacing of its tracks, or the footprint of its sensor")
        if None not in (self.spacing_m, self.footprint_m, self.overlap):
            raise UsageError("spacing, footprint and overlap: any two give the third; leave one out")
        if self.track_spacing_m > self.swath_m:
            raise UsageError(
                f"tracks {self.track_spacing_m:g} m apart leave gaps: the footprint is {self.swath_m:g} m"
            )

    @property
    def track_spacing_m(self) -> float:
        """The largest distance between neighbouring tracks."""
        if self.spacing_m is not None:
            return self.spacing_m
        return self.swath_m * (1.0 - (self.overlap or 0.0))

    @property
    def pass_choices(self) -> tuple[int, ...]:
        """How often the shores may be passed at most: the shortest survey is taken."""
        if self.shore_passes is not None or self.pattern or self.has_gaps:
            return (self.shore_passes or 0,)
        return SHORE_PASSES if self.angle_rad is None and not self.lead_m else (1,)

    @property
    def swath_m(self) -> float:
        """The width that one track covers."""
        if self.footprint_m is not None:
            return self.footprint_m
        assert self.spacing_m is not None  # noqa: S101  checked when made
        return self.spacing_m / (1.0 - (self.overlap or 0.0))

    @property
    def gap_m(self) -> float:
        """The longest gap in a line across which the swaths of its ends meet half a spacing to the side."""
        return math.sqrt(self.swath_m**2 - self.track_spacing_m**2)


def turn_radius_m(boat: Boat, speed_m_s: float) -> float:
    """The tightest turn at a speed: of the boat's rudder, turn rate, and acceleration allowed in corners.

    0 for a boat that turns on the spot: a turn of any radius is a longer way, and no track gets better by it.
    """
    if boat.least_radius_m == 0.0:
        return 0.0
    return max(
        boat.least_radius_m,
        speed_m_s / boat.turn_rate_rad_s,
        speed_m_s * speed_m_s / boat.corner_accel_m_s2,
    )
