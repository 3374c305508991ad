"""Local occupancy grid with evidence that decays.

A sparse occupancy grid (A. Elfes, *Using Occupancy Grids for Mobile Robot Perception and Navigation*, IEEE
Computer 22(6), 1989), with small whole numbers in place of log odds. An echo adds 1 to the evidence of each
cell on the arc across the beam at its range; a beam that reaches beyond a cell subtracts from it. One
observation makes a cell suspect; a second one, of the cell or a neighbour, makes it solid, so a single echo
of spray does not. Evidence decays with time: cells that were seen more often are kept for longer. Free water
is not stored.
"""

import math

from companion.core.geo import Point

SOLID = 1.5  # evidence, after decay
SUSPECT = 0.5
_MAX_EVIDENCE = 4.0
_DOUBTS = -1.0  # lowest evidence of a cell that was seen through
_THROUGH = 1.0  # evidence that an echo from beyond removes,
_SILENCE = 0.5  # and a beam without an echo: a smooth wall at an angle returns none
_CORE = 0.7  # of the beam width: its edges are weak
_SECOND_LOOK_S = 3.0  # a real obstacle is seen again in the next sweep or two
MAX_CELLS = 600


class Cell:
    """A square of water. evidence: as of seen_s."""

    __slots__ = ("east_m", "evidence", "north_m", "seen_s")

    def __init__(self, north_m: float, east_m: float, looks: float, seen_s: float) -> None:
        self.north_m = north_m
        self.east_m = east_m
        self.evidence = looks
        self.seen_s = seen_s


class Beam:
    """One ping: position, bearing from north, beam width and range.

    range_m: to the nearest echo, infinite without one within reach_m. blind_m: nothing closer is seen.
    """

    __slots__ = ("bearing_rad", "blind_m", "east_m", "north_m", "range_m", "reach_m", "time_s", "width_rad")

    def __init__(
        self,
        time_s: float,
        at: Point,
        bearing_rad: float,
        width_rad: float,
        range_m: float,
        reach_m: float,
        blind_m: float = 0.0,
    ) -> None:
        self.time_s = time_s
        self.north_m, self.east_m = at
        self.bearing_rad = bearing_rad
        self.width_rad = width_rad
        self.range_m = range_m
        self.reach_m = reach_m
        self.blind_m = blind_m

    @property
    def is_echo(self) -> bool:
        """Whether there is an echo within reach."""
        return self.range_m <= self.reach_m

    @property
    def echo(self) -> Point:
        """Where the echo comes from, if there is one."""
        return Point(
            self.north_m + self.range_m * math.cos(self.bearing_rad),
            self.east_m + self.range_m * math.sin(self.bearing_rad),
        )


class Occupancy:
    """The cells with evidence, at most MAX_CELLS; `version` changes with them."""

    def __init__(self, cell_m: float, memory_s: float) -> None:
        """memory_s: how long a cell with full evidence stays solid out of sight."""
        self.cell_m = cell_m
        self.version = 0
        self._fade_s = memory_s / (_MAX_EVIDENCE - SOLID)  # in which the evidence decays by 1
        self._cells: dict[tuple[int, int], Cell] = {}

    def __len__(self) -> int:
        """Number of cells."""
        return len(self._cells)

    def clear(self) -> None:
        """Remove all cells."""
        self._cells.clear()
        self.version += 1

    def add(self, beam: Beam) -> None:
        """Add a ping."""
        if self._cells:
            self._clear_beam(beam)
        if beam.range_m <= beam.reach_m:
            self._mark(beam)

    def evidence_at(self, point: Point, now_s: float) -> float | None:
        """The evidence at a place, negative if it was seen through; None: never observed."""
        cell = self._cells.get(
            (math.floor(point.north_m / self.cell_m), math.floor(point.east_m / self.cell_m))
        )
        return None if cell is None else self._decayed(cell, now_s)

    def obstacles(self, now_s: float, least: float = SOLID) -> list[Point]:
        """The centres of the cells with at least this evidence."""
        if not self._cells:
            return []
        fade_s = self._fade_s
        return [
            Point(cell.north_m, cell.east_m)
            for cell in self._cells.values()
            if cell.evidence - (now_s - cell.seen_s) / fade_s >= least
        ]

    def has_suspect_of(self, beam: Beam) -> bool:
        """Whether a cell is known from this ping alone and not observed since."""
        return any(
            cell.seen_s == beam.time_s and SUSPECT <= cell.evidence < SOLID for cell in self._cells.values()
        )

    def is_near(self, at: Point, reach_m: float) -> bool:
        """Whether any cell is within reach_m, north-south and east-west, of a place."""
        north_m, east_m = at
        for cell in self._cells.values():
            if abs(cell.north_m - north_m) < reach_m and abs(cell.east_m - east_m) < reach_m:
                return True
        return False

    def forget(self, at: Point, reach_m: float, now_s: float) -> None:
        """Remove decayed cells, and those farther than reach_m from a place."""
        expired = [
            key
            for key, cell in self._cells.items()
            if abs(cell.north_m - at.north_m) > reach_m
            or abs(cell.east_m - at.east_m) > reach_m
            or abs(cell.evidence) <= (now_s - cell.seen_s) / self._fade_s
            or (cell.evidence < SOLID and now_s - cell.seen_s > _SECOND_LOOK_S)
        ]
        for key in expired:
            del self._cells[key]
        self.version += bool(expired)

    def _decayed(self, cell: Cell, now_s: float) -> float:
        leaked = (now_s - cell.seen_s) / self._fade_s
        return max(cell.evidence - leaked, 0.0) if cell.evidence > 0.0 else min(cell.evidence + leaked, 0.0)

    def _clear_beam(self, beam: Beam) -> None:
        """Reduce the evidence of the cells in the core of the beam, well before the echo. What the ranger is
        blind to stays as it was.

        Where no cell is solid, a cell counts as in the core if a corner is: a single echo marks every cell
        that its arc touches, and a second look at the same place must clear them all. Beside solid cells it
        may be the edge of an obstacle.
        """
        is_echo = beam.range_m <= beam.reach_m
        clear_m = (beam.range_m if is_echo else beam.reach_m) - self.cell_m
        if clear_m <= 0.0:
            return
        taken = _THROUGH if is_echo else _SILENCE
        ahead_n, ahead_e = math.cos(beam.bearing_rad), math.sin(beam.bearing_rad)
        edge = math.cos(0.5 * _CORE * beam.width_rad)
        sine = math.sin(0.5 * _CORE * beam.width_rad)
        beside_m = math.sqrt(0.5) * self.cell_m
        is_open = all(cell.evidence < SOLID for cell in self._cells.values())
        for cell in self._cells.values():
            north, east = cell.north_m - beam.north_m, cell.east_m - beam.east_m
            along = north * ahead_n + east * ahead_e
            if 0.0 < along < clear_m:
                distance = math.sqrt(north * north + east * east)
                across = abs(north * ahead_e - east * ahead_n)
                is_single = is_open and across < sine * distance + beside_m
                is_through = is_single or along > edge * distance
                if beam.blind_m <= distance < clear_m and is_through:
                    cell.evidence = max(self._decayed(cell, beam.time_s) - taken, _DOUBTS)
                    cell.seen_s = beam.time_s
                    self.version += 1

    def _mark(self, beam: Beam) -> None:
        """Add 1 to the evidence of each cell on the arc."""
        cells, side = self._cells, self.cell_m
        width_rad = _CORE * beam.width_rad
        across = max(1, math.ceil(beam.range_m * width_rad / side))
        for step in range(across + 1):
            bearing = beam.bearing_rad + width_rad * (step / across - 0.5)
            row = math.floor((beam.north_m + beam.range_m * math.cos(bearing)) / side)
            column = math.floor((beam.east_m + beam.range_m * math.sin(bearing)) / side)
            cell = cells.get((row, column))
            if cell is not None and cell.seen_s == beam.time_s and cell.evidence > 0.0:
                continue  # marked already
            looks = min(self._earlier_evidence(row, column, beam.time_s) + 1.0, _MAX_EVIDENCE)
            if cell is None:
                if len(cells) >= MAX_CELLS:
                    del cells[next(iter(cells))]
                centre_n, centre_e = (row + 0.5) * side, (column + 0.5) * side
                cells[row, column] = Cell(centre_n, centre_e, looks, beam.time_s)
            else:
                cell.evidence, cell.seen_s = looks, beam.time_s
        self.version += 1

    def _earlier_evidence(self, row: int, column: int, now_s: float) -> float:
        """Evidence of earlier pings for a cell or, as ranges and positions are noisy, a neighbour."""
        best = 0.0
        for near_row in (row - 1, row, row + 1):
            for near_column in (column - 1, column, column + 1):
                cell = self._cells.get((near_row, near_column))
                if cell is not None and cell.seen_s != now_s:
                    best = max(best, self._decayed(cell, now_s))
        return best
