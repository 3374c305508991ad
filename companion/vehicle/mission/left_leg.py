"""A leg of a mission that was interrupted, and where the boat comes back to it."""

from typing import NamedTuple

from companion.core.geo import LatLon, Line, LocalFrame, Point


class LeftLeg(NamedTuple):
    """place: where the boat comes back to the leg; None: it joins the line."""

    start: LatLon
    place: LatLon | None

    @classmethod
    def at(cls, line: Line, here: Point, frame: LocalFrame) -> "LeftLeg":
        """Left where a boat that is here lies abeam of its line, on the leg."""
        share = line.along_and_cross_track_m(here)[0] / max(line.length_m, 1e-9)
        place = line.start.towards(line.end, min(max(share, 0.0), 1.0))
        return cls(frame.to_global(line.start), frame.to_global(place))
