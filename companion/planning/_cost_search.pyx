"""A* with real costs in C; cost_search.py, its twin, explains each step."""

from cpython.mem cimport PyMem_Calloc, PyMem_Free, PyMem_Malloc
from libc.math cimport INFINITY
from libc.stdint cimport int32_t, uint8_t, uint16_t, uint32_t, uint64_t
from libc.stdlib cimport free, realloc

cdef extern from *:
    """
    #define first_bit(word) __builtin_ctzll(word)
    """
    int first_bit(uint64_t word) nogil

cdef enum:
    BLOCKED = 0xFFFF
    MOST_FACETS = 8

cdef uint32_t NONE = ~<uint32_t>0
cdef int32_t *STEP_X = [1, 1, 0, -1, -1, -1, 0, 1]
cdef int32_t *STEP_Y = [0, 1, 1, 1, 0, -1, -1, -1]


cdef struct Open:
    double total  # F
    double cost  # G
    uint32_t cell
    uint32_t later  # the entry below it in the same bucket


cdef class Search:
    cdef int32_t stride, goal_x, goal_y
    cdef size_t size
    cdef uint16_t *classes  # by cell, border included; BLOCKED on land
    cdef double *costs  # G by cell; valid where arrivals is not 0
    cdef uint8_t *arrivals  # by cell: direction of arrival, from 1; 0: not reached
    cdef double *half  # half the cost of a step by class and direction
    cdef double facets[2 * MOST_FACETS]
    cdef int facet_count
    cdef Open *entries
    cdef uint32_t entry_count, room, spare
    cdef uint32_t *tops
    cdef uint64_t *used
    cdef uint64_t ring, at, highest
    cdef double per_width
    cdef uint32_t expanded

    def __cinit__(
        self,
        const uint8_t[::1] cells not None,
        int width,
        int height,
        const uint16_t[::1] classes not None,
        const double[::1] table not None,
        list facets not None,
        double bucket_width,
        int ring,
    ):
        cdef int x, y, k
        cdef size_t at = 0, inner
        self.stride = width + 2
        self.size = <size_t>(width + 2) * (height + 2)
        self.classes = <uint16_t *>claim(self.size, 2)
        self.costs = <double *>PyMem_Malloc(self.size * 8)
        self.arrivals = <uint8_t *>claim(self.size, 1)
        self.half = <double *>claim(table.shape[0], 8)
        self.tops = <uint32_t *>claim(ring, 4)
        self.used = <uint64_t *>claim((ring + 63) >> 6, 8)
        if self.costs == NULL:
            raise MemoryError
        for k in range(table.shape[0]):
            self.half[k] = 0.5 * table[k]
        for k, (normal_x, normal_y) in enumerate(facets):
            self.facets[2 * k], self.facets[2 * k + 1] = normal_x, normal_y
        self.facet_count = len(facets)
        self.per_width = 1.0 / bucket_width
        self.ring = ring - 1
        self.spare = NONE
        for k in range(self.stride):
            self.classes[k] = self.classes[self.size - 1 - k] = BLOCKED
        with nogil:
            for y in range(height):
                inner = <size_t>(y + 1) * self.stride + 1
                self.classes[inner - 1] = self.classes[inner + width] = BLOCKED
                for x in range(width):
                    self.classes[inner + x] = classes[at] if cells[at] else BLOCKED
                    at += 1

    def __dealloc__(self):
        PyMem_Free(self.classes)
        PyMem_Free(self.costs)
        PyMem_Free(self.arrivals)
        PyMem_Free(self.half)
        PyMem_Free(self.tops)
        PyMem_Free(self.used)
        free(self.entries)

    cdef inline double estimate(self, int32_t x, int32_t y) noexcept nogil:
        cdef double best = 0.0, ahead
        cdef double across = self.goal_x - x, along = self.goal_y - y
        cdef int k
        for k in range(self.facet_count):
            ahead = self.facets[2 * k] * across + self.facets[2 * k + 1] * along
            if ahead > best:
                best = ahead
        return best

    cdef int push(self, double total, double cost, uint32_t cell) except -1 nogil:
        cdef uint64_t bucket = <uint64_t>(total * self.per_width)
        cdef uint32_t entry = self.spare
        cdef uint64_t slot
        cdef Open *entries
        if bucket < self.at:
            bucket = self.at
        slot = bucket & self.ring
        if entry != NONE:
            self.spare = self.entries[entry].later
        else:
            if self.entry_count == self.room:
                entries = <Open *>realloc(self.entries, (2 * <size_t>self.room + 64) * sizeof(Open))
                if entries == NULL:
                    with gil:
                        raise MemoryError
                self.entries, self.room = entries, 2 * self.room + 64
            entry = self.entry_count
            self.entry_count += 1
        self.entries[entry].total, self.entries[entry].cost, self.entries[entry].cell = total, cost, cell
        if self.used[slot >> 6] >> (slot & 63) & 1:
            self.entries[entry].later = self.tops[slot]
        else:
            self.entries[entry].later = NONE
            self.used[slot >> 6] |= <uint64_t>1 << (slot & 63)
        self.tops[slot] = entry
        if bucket > self.highest:
            self.highest = bucket
        return 0

    cdef inline bint pop(self, double *total, double *cost, uint32_t *cell) noexcept nogil:
        cdef uint64_t slot = self.at & self.ring
        cdef uint64_t bits = self.used[slot >> 6] >> (slot & 63)
        cdef uint32_t entry
        while bits == 0:
            self.at = (self.at | 63) + 1
            if self.at > self.highest:
                return False
            bits = self.used[(self.at & self.ring) >> 6]
        self.at += first_bit(bits)
        slot = self.at & self.ring
        entry = self.tops[slot]
        total[0], cost[0], cell[0] = self.entries[entry].total, self.entries[entry].cost, self.entries[entry].cell
        self.tops[slot] = self.entries[entry].later
        if self.tops[slot] == NONE:
            self.used[slot >> 6] &= ~(<uint64_t>1 << (slot & 63))
        self.entries[entry].later = self.spare
        self.spare = entry
        return True

    cdef double run(self, uint32_t start, uint32_t goal) except -1.0 nogil:
        cdef double total, cost, step, tentative, best = INFINITY, first_estimate
        cdef uint32_t cell, successor
        cdef int32_t x, y, direction
        cdef size_t class_at, class_to
        first_estimate = self.estimate(start % self.stride, start // self.stride)
        self.at = self.highest = <uint64_t>(first_estimate * self.per_width)
        self.costs[start] = 0.0
        self.arrivals[start] = 9
        self.push(first_estimate, 0.0, start)
        while self.pop(&total, &cost, &cell):
            if total >= best:
                if self.at > <uint64_t>(best * self.per_width):
                    break
                continue
            if cost != self.costs[cell]:
                continue  # stale
            self.expanded += 1
            x, y = cell % self.stride, cell // self.stride
            class_at = 8 * <size_t>self.classes[cell]
            for direction in range(8):
                successor = cell + STEP_Y[direction] * self.stride + STEP_X[direction]
                if self.classes[successor] == BLOCKED:
                    continue
                if direction & 1 and (
                    self.classes[cell + STEP_X[direction]] == BLOCKED
                    or self.classes[cell + STEP_Y[direction] * self.stride] == BLOCKED
                ):
                    continue
                class_to = 8 * <size_t>self.classes[successor]
                tentative = cost + (self.half[class_at + direction] + self.half[class_to + direction])
                if tentative == INFINITY or (
                    self.arrivals[successor] and tentative >= self.costs[successor]
                ):
                    continue
                total = tentative + self.estimate(x + STEP_X[direction], y + STEP_Y[direction])
                if total >= best:
                    continue
                self.costs[successor] = tentative
                self.arrivals[successor] = direction + 1
                if successor == goal:
                    best = tentative
                else:
                    self.push(total, tentative, successor)
        return best

    def cheapest(self, int start_x, int start_y, int goal_x, int goal_y):
        """See cost_search.Search.cheapest."""
        cdef uint32_t start = (start_y + 1) * self.stride + start_x + 1
        cdef uint32_t goal = (goal_y + 1) * self.stride + goal_x + 1, at = goal
        cdef double cost
        cdef int direction, last = -1
        cdef list turns
        self.goal_x, self.goal_y = goal_x + 1, goal_y + 1
        with nogil:
            cost = self.run(start, goal)
        if cost == INFINITY:
            return None, cost, self.expanded
        turns = [goal_y * (self.stride - 2) + goal_x]
        while at != start:
            direction = self.arrivals[at] - 1
            if last not in (-1, direction):
                turns.append((at // self.stride - 1) * (self.stride - 2) + at % self.stride - 1)
            last = direction
            at -= STEP_Y[direction] * self.stride + STEP_X[direction]
        turns.append(start_y * (self.stride - 2) + start_x)
        turns.reverse()
        return turns, cost, self.expanded


cdef void *claim(size_t count, size_t size) except NULL:
    cdef void *memory = PyMem_Calloc(count, size)
    if memory == NULL:
        raise MemoryError
    return memory
