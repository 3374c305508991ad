"""Local occupancy grid.

A sparse occupancy grid (A. Elfes, *Using Occupancy Grids for Mobile Robot Perception and Navigation*, IEEE
Computer 22(6), 1989), with small whole numbers in place of log odds. An echo adds 1 to the evidence of each
cell on the arc across the beam at its range; a beam that reaches beyond a cell subtracts from it. One
observation makes a cell suspect; a second one, of the cell or a neighbour, makes it solid, so a single false
echo does not. A suspect is forgotten after two sweeps; what is solid stays until a beam sees through it. Free
water is not stored. A beam visits the cells of the blocks near it: a spatial hash of two levels.

What comes close was first seen farther off. Within SPRAY_M an echo where nothing was seen before is most
likely spray or a crest, and adds only UNSEEN.
"""

import math
from typing import Final, NamedTuple

from companion.core.geo import Point, distance_m
from companion.planning.segments import point_distance2

SOLID: Final = 1.6  # evidence: two echoes, and no look that met nothing
SUSPECT: Final = 0.6  # one echo, likewise
# Three echoes: what is remembered for the voyage. Of 6,000 false echoes a day one in 130 has another one at
# its place (`track.py`): 46 pairs a day, but three of them only once in three days
LASTING: Final = 2.6
MAX_EVIDENCE: Final = 4.0  # two beams through a cell refute a moving obstacle that has left it
# A beam through a cell removes 1, one without any echo half: a smooth wall at an angle returns none.
SILENCE: Final = 0.5
CORE: Final = 0.7  # of the beam width, at half power: beyond it an echo is weak
# A cone of 15° from 15 cm above the water meets the surface here: closer, waves and spray are in the beam
SPRAY_M: Final = 1.1
# ln(0.9 / 0.2) / ln(0.9 / 0.005): a thing against spray in one ping of five, as share of a thing against a
# false echo in one of 200
UNSEEN: Final = 0.3
SEEN: Final = 1.0  # evidence from which an echo comes from what was seen before: one farther echo
SWEEP_S: Final = 1.5  # a full sweep of 24 pings takes 1.4 s: what is real is seen again within it
MAX_CELLS: Final = 1200  # 240 m of shore in cells of 0.2 m
_BLOCK: Final = 5  # cells a side; 4 to 8 take the same time in a canal


Key = tuple[int, int]


class Beam(NamedTuple):
    """One ping: position, bearing from north, beam width and range.

    range_m: to the nearest echo, infinite without one within reach_m. blind_m: nothing closer is seen.
    """

    time_s: float
    at: Point
    bearing_rad: float
    width_rad: float
    range_m: float
    reach_m: float
    blind_m: float = 0.0

    @property
    def is_echo(self) -> bool:
        """Whether there is an echo within reach."""
        return self.range_m <= self.reach_m

    @property
    def echo(self) -> Point:
        """Where the echo comes from, if there is one."""
        return self.at.moved(self.bearing_rad, self.range_m)


class Cell:
    """A square of water. seen_s: when a beam last met it or saw through it; solid_s: solid since."""

    __slots__ = ("at", "evidence", "seen_s", "solid_s")

    def __init__(self, at: Point) -> None:
        self.at = at
        self.evidence, self.seen_s, self.solid_s = 0.0, -math.inf, math.inf


class Occupancy:
    """The cells with evidence, at most MAX_CELLS."""

    def __init__(self, cell_m: float) -> None:
        self.cell_m = cell_m
        self._cells: dict[Key, Cell] = {}  # the oldest first
        self._blocks: dict[Key, list[Cell]] = {}

    def __len__(self) -> int:
        """Number of cells."""
        return len(self._cells)

    @property
    def has_solid(self) -> bool:
        """Whether anything is solid."""
        return any(cell.evidence >= SOLID for cell in self._cells.values())

    def clear(self) -> None:
        """Remove all cells."""
        self._cells.clear()
        self._blocks.clear()

    def add(self, beam: Beam) -> bool:
        """Add a ping. Returns whether its echo is believed: it is not spray."""
        if self._cells:
            self._clear_beam(beam)
        return not beam.is_echo or self._mark(beam)

    def evidence_at(self, point: Point) -> float | None:
        """The evidence at a place, negative if it was seen through; None: never observed."""
        cell = self._cells.get(self._key(point))
        return None if cell is None else cell.evidence

    def obstacles(self, least: float = SOLID) -> list[Point]:
        """The centres of the cells with at least this evidence."""
        return [cell.at for cell in self._cells.values() if cell.evidence >= least]

    def likely(self, apart_m: float) -> list[Point]:
        """Where something is solid, the centres of all cells with an echo; in open water those that have
        another echo within apart_m.

        False echoes are independent. With one in 200 pings and five pings until an echo is confirmed or
        refuted, one in 50 has another near; two echoes of one thing nearly always come together.
        """
        known = [cell for cell in self._cells.values() if cell.evidence >= SUSPECT]
        if self.has_solid:
            return [cell.at for cell in known]
        return [
            cell.at
            for cell in known
            if any(one.seen_s != cell.seen_s and distance_m(one.at, cell.at) < apart_m for one in known)
        ]

    def has_suspect_of(self, beam: Beam) -> bool:
        """Whether a cell is known from this ping alone and not observed since."""
        return any(
            cell.seen_s == beam.time_s and SUSPECT <= cell.evidence < SOLID for cell in self._cells.values()
        )

    def standing(self, now_s: float) -> list[Point]:
        """Centres of the cells that have been solid for two sweeps. What moves at 0.2 m/s has left them."""
        since_s = now_s - 2.0 * SWEEP_S
        return [cell.at for cell in self._cells.values() if cell.evidence >= SOLID and cell.solid_s < since_s]

    def is_near(self, at: Point, reach_m: float) -> bool:
        """Whether any cell is within reach_m, north-south and east-west, of a place."""
        return any(_is_within(cell.at, at, reach_m) for cell in self._cells.values())

    def forget(self, at: Point, reach_m: float, now_s: float) -> None:
        """Remove old suspects, and what is farther than reach_m from a place."""
        self._cells = {
            key: cell
            for key, cell in self._cells.items()
            if _is_within(cell.at, at, reach_m)
            and (cell.evidence >= SOLID or now_s - cell.seen_s <= 2.0 * SWEEP_S)
        }
        self._blocks = {}
        for key, cell in self._cells.items():
            self._block(key).append(cell)

    def clear_way(self, start: Point, end: Point, within_m: float, now_s: float) -> None:
        """Refute what is within a distance of the way of something that moves: it was that."""
        for cell in self._cells.values():
            if point_distance2(*cell.at, *start, *end) < within_m * within_m:
                cell.evidence, cell.seen_s = min(cell.evidence, -SILENCE), now_s

    def seen_since(self, since_s: float) -> list[Cell]:
        """The cells that a beam met, or saw through, after this time."""
        return [cell for cell in self._cells.values() if cell.seen_s > since_s]

    def restore(self, at: Point, now_s: float) -> None:
        """Make a cell solid that was observed long ago."""
        cell = self._cell(self._key(at))
        cell.evidence, cell.seen_s, cell.solid_s = max(cell.evidence, 2.0), now_s, -math.inf

    def _cell(self, key: Key) -> Cell:
        """A new cell, or the known one. The oldest goes where there is no room."""
        cell = self._cells.get(key)
        if cell is None:
            if len(self._cells) >= MAX_CELLS:
                oldest = next(iter(self._cells))
                self._block(oldest).remove(self._cells.pop(oldest))
            side = self.cell_m
            cell = self._cells[key] = Cell(Point((key[0] + 0.5) * side, (key[1] + 0.5) * side))
            self._block(key).append(cell)
        return cell

    def _block(self, key: Key) -> list[Cell]:
        """The block of a cell."""
        return self._blocks.setdefault((key[0] // _BLOCK, key[1] // _BLOCK), [])

    def _within(self, beam: Beam, length_m: float, half_m: float) -> list[Cell]:
        """The cells of all blocks in the box around the beam's first metres, half_m to either side."""
        end, side_m = beam.at.moved(beam.bearing_rad, length_m), _BLOCK * self.cell_m
        rows, columns = (
            range(math.floor((min(ends) - half_m) / side_m), math.floor((max(ends) + half_m) / side_m) + 1)
            for ends in zip(beam.at, end, strict=True)
        )
        return [
            cell
            for (row, column), cells in self._blocks.items()
            if row in rows and column in columns
            for cell in cells
        ]

    def _key(self, point: Point) -> Key:
        return math.floor(point.north_m / self.cell_m), math.floor(point.east_m / self.cell_m)

    def _clear_beam(self, beam: Beam) -> None:
        """Reduce the evidence of the cells in the core of the beam, well before the echo; of a silent one,
        in its whole width: the cores of a sweep of 15° steps leave gaps, where false echoes would never be
        refuted. What the ranger is blind to stays as it was.

        Where no cell is solid, a cell counts as inside if a corner is: a single echo marks every cell
        that its arc touches, and a second look at the same place must clear them all. Beside solid cells it
        may be the edge of an obstacle.
        """
        clear_m = min(beam.range_m, beam.reach_m) - self.cell_m
        if clear_m <= 0.0:
            return
        taken = 1.0 if beam.is_echo else SILENCE
        ahead_n, ahead_e = math.cos(beam.bearing_rad), math.sin(beam.bearing_rad)
        sine = math.sin(0.5 * (CORE if beam.is_echo else 1.0) * beam.width_rad)
        slack_m = 0.0 if self.has_solid else math.sqrt(0.5) * self.cell_m
        north_m, east_m = beam.at
        for cell in self._within(beam, clear_m, sine * clear_m + slack_m):
            cell_n, cell_e = cell.at
            north, east = cell_n - north_m, cell_e - east_m
            along = north * ahead_n + east * ahead_e
            if 0.0 < along < clear_m:
                distance = math.sqrt(north * north + east * east)
                across = abs(north * ahead_e - east * ahead_n)
                if beam.blind_m <= distance < clear_m and across < sine * distance + slack_m:
                    cell.evidence = max(cell.evidence - taken, -1.0)
                    cell.seen_s = beam.time_s

    def _mark(self, beam: Beam) -> bool:
        """Add 1 to the evidence of each cell on the arc, UNSEEN for what may be spray. Whether it is not."""
        width_rad = CORE * beam.width_rad
        across = max(1, math.ceil(beam.range_m * width_rad / self.cell_m))
        bearings = (beam.bearing_rad + width_rad * (step / across - 0.5) for step in range(across + 1))
        keys = dict.fromkeys(self._key(beam.at.moved(bearing, beam.range_m)) for bearing in bearings)
        earlier = {key: self._earlier_evidence(key, beam.time_s) for key in keys}
        is_known = beam.range_m > SPRAY_M or max(earlier.values()) >= SEEN
        for key, evidence in earlier.items():
            cell = self._cell(key)
            if cell.seen_s == beam.time_s and cell.evidence > 0.0:
                continue  # marked already, by another beam of the same moment
            if cell.evidence < SOLID:
                cell.solid_s = beam.time_s
            cell.evidence = min(evidence + (1.0 if is_known else UNSEEN), MAX_EVIDENCE)
            cell.seen_s = beam.time_s
        return is_known

    def _earlier_evidence(self, key: Key, now_s: float) -> float:
        """Evidence of earlier pings for a cell or, as ranges and positions are noisy, a neighbour."""
        best, (row, column) = 0.0, key
        for near_row in (row - 1, row, row + 1):
            for near_column in (column - 1, column, column + 1):
                cell = self._cells.get((near_row, near_column))
                if cell is not None and cell.seen_s != now_s:
                    best = max(best, cell.evidence)
        return best


def _is_within(at: Point, centre: Point, reach_m: float) -> bool:
    return abs(at.north_m - centre.north_m) <= reach_m and abs(at.east_m - centre.east_m) <= reach_m
