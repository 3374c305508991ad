"""Jump point search in C; jump_points.py, its twin, explains each step."""

import threading

from cpython.mem cimport PyMem_Calloc, PyMem_Free, PyMem_Malloc
from libc.stdint cimport int32_t, uint8_t, uint32_t, uint64_t
from libc.stdlib cimport abs, free, realloc
from libc.string cimport memcpy, memset

cdef extern from *:
    """
    #define first_bit(word) __builtin_ctzll(word)
    #define last_bit(word) (63 - __builtin_clzll(word))
    #define prefetch(place) __builtin_prefetch(place)
    """
    int first_bit(uint64_t word) nogil
    int last_bit(uint64_t word) nogil
    void prefetch(const void *place) nogil

cdef enum:
    EAST
    WEST
    SOUTH
    NORTH
    STRAIGHT = 1_000_000_000
    DIAGONAL = 1_414_213_562
    EPOCH_SHIFT = 54
    EPOCHS = 1023
    BUCKET_SHIFT = 28
    KEPT_ENTRIES = 1 << 16
    MOST_KNOWN = 1 << 15  # with more corners, successors are found again quicker than read from memory
    KEPT_POOL = 1 << 23

cdef uint64_t ALL = ~<uint64_t>0
cdef uint64_t COST_MASK = ALL >> 10
cdef uint32_t MASK = ((<uint32_t>1) << 30) - 1
cdef uint32_t NONE = ~<uint32_t>0
cdef size_t NOWHERE = ~<size_t>0


cdef struct Reached:  # a jump point as the end of a jump
    uint32_t cell
    uint32_t corner  # and direction of arrival


cdef struct Open:  # an entry of the open list
    uint64_t total  # F
    Reached reached
    uint32_t later  # the entry below it in the same bucket


cdef struct Buckets:  # a ring of stacks of open entries, by F
    Open *entries
    uint32_t size, room
    uint32_t spare  # the first entry that is free again
    uint32_t *tops  # by bucket; valid where its bit of used is set
    uint64_t *used
    uint32_t ring  # number of buckets less one: a power of two less one
    uint64_t at, highest  # bucket that is taken from, and the highest pushed to; not wrapped


cdef int push(Buckets *open_list, uint64_t total, Reached reached) except -1 nogil:
    cdef uint64_t bucket = total >> BUCKET_SHIFT
    cdef uint32_t slot = bucket & open_list.ring, entry = open_list.spare
    cdef Open *entries
    if entry != NONE:
        open_list.spare = open_list.entries[entry].later
    else:
        if open_list.size == open_list.room:
            entries = <Open *>realloc(open_list.entries, (2 * <size_t>open_list.room + 64) * sizeof(Open))
            if entries == NULL:
                with gil:
                    raise MemoryError
            open_list.entries, open_list.room = entries, 2 * open_list.room + 64
        entry = open_list.size
        open_list.size += 1
    open_list.entries[entry].total = total
    open_list.entries[entry].reached = reached
    if open_list.used[slot >> 6] >> (slot & 63) & 1:
        open_list.entries[entry].later = open_list.tops[slot]
    else:
        open_list.entries[entry].later = NONE
        open_list.used[slot >> 6] |= <uint64_t>1 << (slot & 63)
    open_list.tops[slot] = entry
    if bucket > open_list.highest:
        open_list.highest = bucket
    return 0


cdef inline bint pop(Buckets *open_list, uint64_t *total, Reached *reached) noexcept nogil:
    """The newest entry of the lowest bucket; false where there is none."""
    cdef uint32_t slot = open_list.at & open_list.ring, entry
    cdef uint64_t bits = open_list.used[slot >> 6] >> (slot & 63)
    while bits == 0:
        open_list.at = (open_list.at | 63) + 1
        if open_list.at > open_list.highest:
            return False
        slot = open_list.at & open_list.ring
        bits = open_list.used[slot >> 6]
    open_list.at += first_bit(bits)
    slot = open_list.at & open_list.ring
    entry = open_list.tops[slot]
    total[0] = open_list.entries[entry].total
    reached[0] = open_list.entries[entry].reached
    open_list.tops[slot] = open_list.entries[entry].later
    if open_list.tops[slot] == NONE:
        open_list.used[slot >> 6] &= ~(<uint64_t>1 << (slot & 63))
    open_list.entries[entry].later = open_list.spare
    open_list.spare = entry
    return True


cdef inline uint32_t count_bits(uint64_t word) noexcept nogil:
    """Without the instruction, which not every x86-64 has (Warren, Hacker's Delight, section 5-1)."""
    word -= word >> 1 & <uint64_t>0x5555555555555555
    word = (word & <uint64_t>0x3333333333333333) + (word >> 2 & <uint64_t>0x3333333333333333)
    return (((word + (word >> 4)) & <uint64_t>0x0F0F0F0F0F0F0F0F) * <uint64_t>0x0101010101010101) >> 56


cdef inline bint bit(const uint64_t *line, int32_t at) noexcept nogil:
    return line[at >> 6] >> (at & 63) & 1


cdef inline int32_t scan_up(const uint64_t *stops, int32_t at) noexcept nogil:
    """The next stop in rising order."""
    cdef int32_t next_bit = at + 1, word = next_bit >> 6
    cdef uint64_t bits = stops[word] & (ALL << (next_bit & 63))
    while bits == 0:
        word += 1
        bits = stops[word]
    return (word << 6) + first_bit(bits)


cdef inline int32_t scan_down(const uint64_t *stops, int32_t at) noexcept nogil:
    """The next stop in falling order."""
    cdef int32_t next_bit = at - 1, word = next_bit >> 6
    cdef uint64_t bits = stops[word] & (ALL >> (63 - (next_bit & 63)))
    while bits == 0:
        word -= 1
        bits = stops[word]
    return (word << 6) + last_bit(bits)


cdef void pack(const uint8_t *cells, int width, int height, uint64_t *rows, int words) noexcept nogil:
    """One bit a cell, with a border of blocked ones."""
    cdef int x, y, at
    cdef uint64_t *row
    cdef uint64_t eight
    for y in range(height):
        row = rows + <size_t>(y + 1) * words
        x = 0
        while x + 8 <= width:
            memcpy(&eight, cells, 8)
            eight |= eight >> 4  # any set bit of a byte into its lowest
            eight |= eight >> 2
            eight |= eight >> 1
            eight = ((eight & <uint64_t>0x0101010101010101) * <uint64_t>0x0102040810204080) >> 56
            at = x + 1
            row[at >> 6] |= eight << (at & 63)
            if (at & 63) > 56:
                row[(at >> 6) + 1] |= eight >> (64 - (at & 63))
            cells += 8
            x += 8
        while x < width:
            if cells[0]:
                row[(x + 1) >> 6] |= <uint64_t>1 << ((x + 1) & 63)
            cells += 1
            x += 1


cdef void transpose(
    const uint64_t *rows, int height, int words, uint64_t *columns, int width, int column_words
) noexcept nogil:
    """Bit (x, y) to bit (y, x), in blocks of 64 × 64 (Warren, Hacker's Delight, section 7-3)."""
    cdef uint64_t block[64]
    cdef uint64_t mask, swap
    cdef int left, top, i, k
    for top in range(column_words):
        for left in range(words):
            for i in range(64):
                block[i] = rows[<size_t>(64 * top + i) * words + left] if 64 * top + i < height else 0
            i, mask = 32, ALL >> 32
            while i:
                k = 0
                while k < 64:
                    swap = (block[k] >> i ^ block[k + i]) & mask
                    block[k] ^= swap << i
                    block[k + i] ^= swap
                    k = (k + i + 1) & ~i
                i >>= 1
                mask ^= mask << i
            for i in range(64):
                if 64 * left + i < width:
                    columns[<size_t>(64 * left + i) * column_words + top] = block[i]


cdef inline uint64_t lower(const uint64_t *line, int word) noexcept nogil:
    """A word whose bits are each cell's lower neighbour."""
    return line[word] << 1 | (line[word - 1] >> 63 if word else 0)


cdef inline uint64_t upper(const uint64_t *line, int word, int words) noexcept nogil:
    """A word whose bits are each cell's upper neighbour."""
    return line[word] >> 1 | (line[word + 1] << 63 if word + 1 < words else 0)


cdef void mark_stops(
    const uint64_t *lines, int count, int words, uint64_t *rising, uint64_t *falling
) noexcept nogil:
    """Where a scan along a line ends: at blocked cells, and where a wall beside the line ends."""
    cdef int line, word
    cdef size_t at
    cdef const uint64_t *here
    cdef const uint64_t *beside
    cdef uint64_t up, down
    for line in range(count):
        here = lines + <size_t>line * words
        for word in range(words):
            up = down = 0
            if line:
                beside = here - words
                up = beside[word] & ~lower(beside, word)
                down = beside[word] & ~upper(beside, word, words)
            if line + 1 < count:
                beside = here + words
                up |= beside[word] & ~lower(beside, word)
                down |= beside[word] & ~upper(beside, word, words)
            at = <size_t>line * words + word
            rising[at] = ~here[word] | up
            falling[at] = ~here[word] | down


cdef class Searcher:
    """A grid map as rows of bits, and shortest paths on it."""

    cdef int32_t width, height, row_words, column_words
    cdef int32_t y_shift, x_mask  # a cell is y << y_shift | x, border included
    cdef uint64_t *rows
    cdef uint64_t *columns
    cdef uint64_t *stops[4]  # by direction
    cdef uint64_t *corners  # cells that may be jump points, as rows
    cdef uint32_t *ranks  # corners before each word
    cdef uint64_t *costs  # by corner: epoch and G
    cdef uint32_t *parents  # by corner: direction of arrival and cell of the parent
    cdef uint32_t corner_count
    cdef uint64_t epoch
    cdef object lock
    # Successors, found once
    cdef uint32_t *known  # by corner and direction: where its successors begin in the pool; 0: not found yet
    cdef Reached *pool  # lists, each after an entry with its length as cell
    cdef size_t pool_size, pool_room
    cdef uint32_t listed
    # Of the search that runs:
    cdef Buckets open_list
    cdef int32_t goal_x, goal_y
    cdef uint64_t goal_cost
    cdef uint32_t goal_parent, expanded

    def __cinit__(self, const uint8_t[::1] cells not None, int width, int height):
        self.width, self.height = width, height
        self.row_words = (width + 2 + 63) >> 6
        self.column_words = (height + 2 + 63) >> 6
        self.lock = threading.Lock()
        while 1 << self.y_shift < width + 2:
            self.y_shift += 1
        self.x_mask = (1 << self.y_shift) - 1
        cdef size_t by_rows = <size_t>self.row_words * (height + 2)
        cdef size_t by_columns = <size_t>self.column_words * (width + 2)
        self.rows = <uint64_t *>claim(by_rows, 8)
        self.columns = <uint64_t *>claim(by_columns, 8)
        self.stops[EAST] = <uint64_t *>claim(by_rows, 8)
        self.stops[WEST] = <uint64_t *>claim(by_rows, 8)
        self.stops[SOUTH] = <uint64_t *>claim(by_columns, 8)
        self.stops[NORTH] = <uint64_t *>claim(by_columns, 8)
        self.corners = <uint64_t *>claim(by_rows, 8)
        self.ranks = <uint32_t *>claim(by_rows, 4)
        with nogil:
            pack(&cells[0], width, height, self.rows, self.row_words)
            transpose(self.rows, height + 2, self.row_words, self.columns, width + 2, self.column_words)
            mark_stops(self.rows, height + 2, self.row_words, self.stops[EAST], self.stops[WEST])
            mark_stops(self.columns, width + 2, self.column_words, self.stops[SOUTH], self.stops[NORTH])
            self.mark_corners()
        # No jump raises F by more than twice the longest diagonal and the longest straight scan together.
        cdef uint64_t spread = 2 * (<uint64_t>min(width, height) * DIAGONAL + <uint64_t>max(width, height) * STRAIGHT)
        self.open_list.ring = 63
        while self.open_list.ring < (spread >> BUCKET_SHIFT) + 2:
            self.open_list.ring = 2 * self.open_list.ring + 1
        self.open_list.tops = <uint32_t *>claim(self.open_list.ring + 1, 4)
        self.open_list.used = <uint64_t *>claim((self.open_list.ring + 1) >> 6, 8)
        self.costs = <uint64_t *>claim(self.corner_count + 1, 8)
        self.parents = <uint32_t *>claim(self.corner_count + 1, 4)
        if self.corner_count <= MOST_KNOWN:
            self.known = <uint32_t *>claim(4 * <size_t>self.corner_count + 1, 4)
        self.pool_size = 1

    def __dealloc__(self):
        cdef int direction
        PyMem_Free(self.rows)
        PyMem_Free(self.columns)
        for direction in range(4):
            PyMem_Free(self.stops[direction])
        PyMem_Free(self.corners)
        PyMem_Free(self.ranks)
        PyMem_Free(self.costs)
        PyMem_Free(self.parents)
        PyMem_Free(self.known)
        free(self.pool)
        PyMem_Free(self.open_list.tops)
        PyMem_Free(self.open_list.used)
        free(self.open_list.entries)

    cdef void mark_corners(self) noexcept nogil:
        """Free cells that a scan in any direction stops at, and how many lie before each word."""
        cdef int y, word, words = self.row_words
        cdef const uint64_t *row
        cdef const uint64_t *above
        cdef const uint64_t *below
        cdef uint64_t west, east, found
        cdef size_t at
        cdef uint32_t count = 0
        for y in range(self.height + 2):
            row = self.rows + <size_t>y * words
            for word in range(words):
                at = <size_t>y * words + word
                found = 0
                if 0 < y <= self.height:
                    above, below = row - words, row + words
                    west, east = lower(row, word), upper(row, word, words)
                    found = self.stops[EAST][at] | self.stops[WEST][at]
                    found |= west & ~(lower(above, word) & lower(below, word))
                    found |= east & ~(upper(above, word, words) & upper(below, word, words))
                    found &= row[word]
                self.corners[at] = found
                self.ranks[at] = count
                count += count_bits(found)
        self.corner_count = count

    cdef inline uint32_t corner_at(self, int32_t x, int32_t y) noexcept nogil:
        cdef size_t at = <size_t>y * self.row_words + (x >> 6)
        cdef uint64_t mask = <uint64_t>1 << (x & 63)
        if self.corners[at] & mask == 0:
            return NONE
        return self.ranks[at] + count_bits(self.corners[at] & (mask - 1))

    cdef inline uint64_t distance(self, int32_t from_x, int32_t from_y, int32_t to_x, int32_t to_y) noexcept nogil:
        cdef uint64_t across = abs(to_x - from_x), along = abs(to_y - from_y)
        if across < along:
            return (along - across) * STRAIGHT + across * DIAGONAL
        return (across - along) * STRAIGHT + along * DIAGONAL

    cdef inline bint is_open(self, int32_t x, int32_t y, int32_t step_x, int32_t step_y) noexcept nogil:
        """Whether a diagonal step from a cell is allowed."""
        cdef const uint64_t *row = self.rows + <size_t>y * self.row_words
        cdef const uint64_t *next_row = row + <ptrdiff_t>step_y * self.row_words
        return bit(row, x + step_x) and bit(next_row, x) and bit(next_row, x + step_x)

    cdef inline int32_t jump(self, int direction, int32_t x, int32_t y) noexcept nogil:
        """The coordinate of the first stop of a straight scan from a cell."""
        if direction == EAST:
            return scan_up(self.stops[EAST] + <size_t>y * self.row_words, x)
        if direction == WEST:
            return scan_down(self.stops[WEST] + <size_t>y * self.row_words, x)
        if direction == SOUTH:
            return scan_up(self.stops[SOUTH] + <size_t>x * self.column_words, y)
        return scan_down(self.stops[NORTH] + <size_t>x * self.column_words, y)

    cdef int list_straight(self, int direction, int32_t x, int32_t y) except -1 nogil:
        """Add the jump point at the end of a scan, if it does not end at a blocked cell."""
        cdef uint32_t corner
        cdef Reached *pool
        if direction <= WEST:
            x = self.jump(direction, x, y)
        else:
            y = self.jump(direction, x, y)
        corner = self.corner_at(x, y)
        if corner == NONE:
            return 0
        self.listed += 1
        self.make_room()
        self.pool[self.pool_size + self.listed].cell = y << self.y_shift | x
        self.pool[self.pool_size + self.listed].corner = <uint32_t>direction << 30 | corner
        return 0

    cdef inline int make_room(self) except -1 nogil:
        cdef Reached *pool
        if self.pool_size + self.listed >= self.pool_room:
            pool = <Reached *>realloc(self.pool, (2 * self.pool_room + 1024) * sizeof(Reached))
            if pool == NULL:
                with gil:
                    raise MemoryError
            self.pool, self.pool_room = pool, 2 * self.pool_room + 1024
        return 0

    cdef int list_diagonal(self, int across, int along, int32_t x, int32_t y) except -1 nogil:
        """Step by step as far as no corner is cut, with both straight scans at each step."""
        cdef int32_t step_x = 1 if across == EAST else -1, step_y = 1 if along == SOUTH else -1
        while self.is_open(x, y, step_x, step_y):
            x += step_x
            y += step_y
            self.list_straight(across, x, y)
            self.list_straight(along, x, y)
        return 0

    cdef inline bint turns(self, int direction, int side, int32_t x, int32_t y) noexcept nogil:
        """Whether a wall beside a jump point that was reached in a direction ends on this side."""
        cdef int32_t beside_x = x, beside_y = y
        if side == EAST:
            beside_x += 1
        elif side == WEST:
            beside_x -= 1
        elif side == SOUTH:
            beside_y += 1
        else:
            beside_y -= 1
        if not bit(self.rows + <size_t>beside_y * self.row_words, beside_x):
            return False
        if direction == EAST:
            beside_x -= 1
        elif direction == WEST:
            beside_x += 1
        elif direction == SOUTH:
            beside_y -= 1
        else:
            beside_y += 1
        return not bit(self.rows + <size_t>beside_y * self.row_words, beside_x)

    cdef inline size_t successors(self, uint32_t corner, int direction, int32_t x, int32_t y) except 0 nogil:
        """Where the successors of a jump point stand in the pool."""
        cdef size_t place = 4 * <size_t>corner + direction, at
        cdef int side, first = SOUTH if direction <= WEST else EAST
        if self.known != NULL and self.known[place]:
            return self.known[place]
        self.listed = 0
        self.list_straight(direction, x, y)
        for side in range(first, first + 2):
            if self.turns(direction, side, x, y):
                self.list_straight(side, x, y)
                if direction <= WEST:
                    self.list_diagonal(direction, side, x, y)
                else:
                    self.list_diagonal(side, direction, x, y)
        return self.listed_at(place if self.known != NULL else NOWHERE)

    cdef size_t listed_at(self, size_t place) except 0 nogil:
        """Close a list of successors, and keep it while there is room."""
        cdef size_t at = self.pool_size
        self.make_room()
        self.pool[at].cell = self.listed
        if place != NOWHERE and at + self.listed < KEPT_POOL:
            self.known[place] = at
            self.pool_size += self.listed + 1
        return at

    cdef bint sees_goal(self, int32_t x, int32_t y, int direction) noexcept nogil:
        """Whether the goal lies on the way to a successor: diagonally and then straight on, or a part of it.

        direction: of arrival, or -1 at the start.
        """
        cdef int32_t across = self.goal_x - x, along = self.goal_y - y, step_x = sign(across), step_y = sign(along)
        cdef int32_t diagonal = min(abs(across), abs(along)), k, stop
        cdef int ahead_x = EAST if across > 0 else WEST, ahead_y = SOUTH if along > 0 else NORTH
        if direction >= 0:
            if direction <= WEST:
                if across and ahead_x != direction:
                    return False
                if along and not self.turns(direction, ahead_y, x, y):
                    return False
            else:
                if along and ahead_y != direction:
                    return False
                if across and not self.turns(direction, ahead_x, x, y):
                    return False
        for k in range(diagonal):
            if not self.is_open(x, y, step_x, step_y):
                return False
            x += step_x
            y += step_y
        if x != self.goal_x:
            stop = self.jump(ahead_x, x, y)
            return stop >= self.goal_x if across > 0 else stop <= self.goal_x
        if y != self.goal_y:
            stop = self.jump(ahead_y, x, y)
            return stop >= self.goal_y if along > 0 else stop <= self.goal_y
        return True

    cdef int expand(self, uint32_t cell, uint64_t cost, size_t at) except -1 nogil:
        """Lower G of the successors that are reached more cheaply, and put them on the open list."""
        cdef const Reached *reached
        cdef uint32_t corner
        cdef int32_t x = cell & self.x_mask, y = cell >> self.y_shift, to_x, to_y
        cdef uint64_t tentative, total
        cdef size_t k
        for k in range(at + 1, at + 1 + self.pool[at].cell):
            prefetch(&self.costs[self.pool[k].corner & MASK])
        for k in range(at + 1, at + 1 + self.pool[at].cell):
            reached = &self.pool[k]
            corner = reached.corner & MASK
            to_x, to_y = reached.cell & self.x_mask, reached.cell >> self.y_shift
            tentative = cost + self.distance(x, y, to_x, to_y)
            if (self.epoch << EPOCH_SHIFT | tentative) >= self.costs[corner]:
                continue
            total = tentative + self.distance(to_x, to_y, self.goal_x, self.goal_y)
            if total >= self.goal_cost:
                continue
            self.costs[corner] = self.epoch << EPOCH_SHIFT | tentative
            self.parents[corner] = (reached.corner & ~MASK) | cell
            push(&self.open_list, total, reached[0])
        return 0

    cdef inline void reach_goal(self, uint32_t cell, int direction, uint64_t cost) noexcept nogil:
        cdef int32_t x = cell & self.x_mask, y = cell >> self.y_shift
        cdef uint64_t tentative = cost + self.distance(x, y, self.goal_x, self.goal_y)
        if tentative < self.goal_cost and self.sees_goal(x, y, direction):
            self.goal_cost = tentative
            self.goal_parent = cell

    cdef int search(self, int32_t x, int32_t y) except -1 nogil:
        cdef uint32_t corner = self.corner_at(x, y), start = y << self.y_shift | x
        cdef int direction
        cdef uint64_t total, cost
        cdef Reached reached
        cdef Buckets *open_list = &self.open_list
        if self.epoch == 0:  # a later epoch is lower, so that any cost of an earlier one is higher
            memset(self.costs, 0xFF, <size_t>self.corner_count * 8)
            self.epoch = EPOCHS
        self.epoch -= 1
        self.goal_cost = COST_MASK
        self.expanded = 1
        open_list.size, open_list.spare = 0, NONE
        open_list.at = open_list.highest = self.distance(x, y, self.goal_x, self.goal_y) >> BUCKET_SHIFT
        if corner != NONE:
            self.costs[corner] = self.epoch << EPOCH_SHIFT
        self.reach_goal(start, -1, 0)
        self.listed = 0
        for direction in range(4):
            self.list_straight(direction, x, y)
        for direction in range(4):
            self.list_diagonal(WEST if direction & 1 else EAST, NORTH if direction & 2 else SOUTH, x, y)
        self.expand(start, 0, self.listed_at(NOWHERE))
        while pop(open_list, &total, &reached):
            if total >= self.goal_cost:
                if total >> BUCKET_SHIFT > self.goal_cost >> BUCKET_SHIFT:
                    break
                continue
            x, y = reached.cell & self.x_mask, reached.cell >> self.y_shift
            corner = reached.corner & MASK
            cost = total - self.distance(x, y, self.goal_x, self.goal_y)
            if self.costs[corner] != (self.epoch << EPOCH_SHIFT | cost):
                continue  # stale
            self.expanded += 1
            direction = reached.corner >> 30
            self.reach_goal(reached.cell, direction, cost)
            self.expand(reached.cell, cost, self.successors(corner, direction, x, y))
        while open_list.at <= open_list.highest:
            open_list.used[(open_list.at & open_list.ring) >> 6] = 0
            open_list.at += 64
        open_list.used[(open_list.highest & open_list.ring) >> 6] = 0
        return self.goal_cost != COST_MASK

    def shortest(self, int start, int goal):
        """See jump_points.Searcher.shortest."""
        cdef int32_t from_x = start % self.width + 1, from_y = start // self.width + 1
        cdef int found
        with self.lock:
            self.goal_x, self.goal_y = goal % self.width + 1, goal // self.width + 1
            with nogil:
                found = self.search(from_x, from_y)
            if self.open_list.room > KEPT_ENTRIES:
                free(self.open_list.entries)
                self.open_list.entries, self.open_list.room = NULL, 0
            if not found:
                return None, 0, self.expanded
            return self.walk_back(from_x, from_y), self.goal_cost, self.expanded

    cdef list walk_back(self, int32_t from_x, int32_t from_y):
        """The cells where the path turns, from start to goal, both included."""
        cdef int32_t x = self.goal_x, y = self.goal_y
        cdef uint32_t before = self.goal_parent
        cdef int32_t across, along, diagonal
        cdef int32_t heading, last = 0  # 3 × step in x + step in y; 0: none
        cdef list turns = [self.outer(x, y)]
        while True:
            across, along = (before & self.x_mask) - x, (before >> self.y_shift) - y
            diagonal = min(abs(across), abs(along))
            if abs(across) != abs(along):  # the straight part, which is the later one
                heading = sign(across) * 3 if abs(across) > abs(along) else sign(along)
                if last and heading != last:
                    turns.append(self.outer(x, y))
                last = heading
                x += across - sign(across) * diagonal
                y += along - sign(along) * diagonal
            if diagonal:
                heading = sign(across) * 3 + sign(along)
                if last and heading != last:
                    turns.append(self.outer(x, y))
                last = heading
                x += sign(across) * diagonal
                y += sign(along) * diagonal
            if x == from_x and y == from_y:
                break
            before = self.parents[self.corner_at(x, y)] & MASK
        turns.append(self.outer(x, y))
        turns.reverse()
        return turns

    cdef inline int32_t outer(self, int32_t x, int32_t y):
        """The number of a cell for the caller, whose map has no border."""
        return (y - 1) * self.width + x - 1


cdef inline int32_t sign(int32_t value) noexcept nogil:
    return (value > 0) - (value < 0)


cdef void *claim(size_t count, size_t size) except NULL:
    cdef void *memory = PyMem_Calloc(count, size)
    if memory == NULL:
        raise MemoryError
    return memory
