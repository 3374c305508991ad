"""covariance.py in C."""
cdef enum:
    N = 13
    MOST = 5
    HEADING = 2
    SURGE = 3
    SWAY = 4
    CURRENT_NORTH = 5
    OFFSET = 8
    GNSS_NORTH = 10
    DELAY = 12


cdef class Covariance:
    cdef double p[N][N]
    cdef double told[MOST + 2][N]
    cdef double shares[MOST + 2]
    cdef double innovations[MOST + 2]
    cdef int states[8]
    cdef double parts[8]
    cdef int count, entries

    def __init__(self, deviations):
        cdef int i, j
        for i in range(N):
            for j in range(N):
                self.p[i][j] = 0.0
        for i, deviation in enumerate(deviations):
            self.p[i][i] = <double>deviation * <double>deviation
        self.count = 0

    @property
    def rows(self):
        return [[self.p[i][j] for j in range(N)] for i in range(N)]

    cpdef double get(self, int state, int other):
        return self.p[state][other]

    cpdef double variance(self, int state):
        return self.p[state][state]

    cpdef add(self, int state, double variance):
        self.p[state][state] += variance

    cpdef raise_to(self, int state, double variance):
        if variance > self.p[state][state]:
            self.p[state][state] = variance

    cpdef reset(self, int state, double variance):
        cdef int i
        for i in range(N):
            self.p[state][i] = 0.0
            self.p[i][state] = 0.0
        self.p[state][state] = variance

    cpdef scale(self, int state, double factor):
        cdef int i
        for i in range(N):
            self.p[state][i] = factor * self.p[state][i]
        self.replace(state, factor * self.p[state][state])

    cpdef combine(self, int state, double factor, int other, double share):
        cdef int i
        for i in range(N):
            self.p[state][i] = factor * self.p[state][i] + share * self.p[other][i]
        self.replace(state, factor * self.p[state][state] + share * self.p[state][other])

    cpdef carry(self, int state, double turn, double ahead, double aside, int current, double dt_s):
        cdef int i
        cdef double *row = self.p[state]
        for i in range(N):
            row[i] = (row[i] + turn * self.p[HEADING][i] + ahead * self.p[SURGE][i] + aside * self.p[SWAY][i]
                      + dt_s * self.p[current][i])
        self.replace(state, row[state] + turn * row[HEADING] + ahead * row[SURGE] + aside * row[SWAY]
                     + dt_s * row[current])

    cdef void replace(self, int state, double variance) noexcept:
        cdef int i
        self.p[state][state] = variance
        for i in range(N):
            self.p[i][state] = self.p[state][i]

    cdef void part(self, int state, double share) noexcept:
        self.states[self.entries] = state
        self.parts[self.entries] = share
        self.entries += 1

    cpdef tell_heading(self, double innovation, double white):
        cdef int i
        for i in range(N):
            self.told[self.count][i] = self.p[HEADING][i] + self.p[OFFSET][i]
        self.entries = 0
        self.part(HEADING, 1.0)
        self.part(OFFSET, 1.0)
        return self.tell(self.count, innovation, white)

    cpdef tell_velocity(self, int slot, double turn, double ahead, double aside, int current, double innovation,
                        double white):
        slot += self.count
        self.moved(slot, turn, ahead, aside, current)
        self.entries = 0
        self.part(HEADING, turn)
        self.part(SURGE, ahead)
        self.part(SWAY, aside)
        self.part(current, 1.0)
        return self.tell(slot, innovation, white)

    cpdef tell_position(self, int slot, double back_s, double way_m_s, double turn, double ahead, double aside,
                        int current, double innovation, double white):
        cdef int i, here = current - CURRENT_NORTH, wander = current - CURRENT_NORTH + GNSS_NORTH
        slot += self.count
        self.moved(slot, turn, ahead, aside, current)
        for i in range(N):
            self.told[slot][i] = (self.p[here][i] + self.p[wander][i] - way_m_s * self.p[DELAY][i]
                                  + back_s * self.told[slot][i])
        self.entries = 0
        self.part(here, 1.0)
        self.part(wander, 1.0)
        self.part(DELAY, -way_m_s)
        self.part(HEADING, back_s * turn)
        self.part(SURGE, back_s * ahead)
        self.part(SWAY, back_s * aside)
        self.part(current, back_s)
        return self.tell(slot, innovation, white)

    cdef void moved(self, int slot, double turn, double ahead, double aside, int current) noexcept:
        cdef int i
        for i in range(N):
            self.told[slot][i] = (turn * self.p[HEADING][i] + ahead * self.p[SURGE][i] + aside * self.p[SWAY][i]
                                  + self.p[current][i])

    cdef tell(self, int slot, double innovation, double white):
        cdef int i, k
        cdef double alike, variance = white
        if slot >= MOST + 2:
            raise IndexError("too many measurements before a commit")
        for k in range(slot):
            alike = 0.0
            for i in range(self.entries):
                alike += self.parts[i] * self.told[k][self.states[i]]
            alike *= self.shares[k]
            innovation -= alike * self.innovations[k]
            for i in range(N):
                self.told[slot][i] -= alike * self.told[k][i]
        for i in range(self.entries):
            variance += self.parts[i] * self.told[slot][self.states[i]]
        self.shares[slot] = 1.0 / variance
        self.innovations[slot] = innovation
        return innovation, variance

    cpdef accept(self, int count):
        self.count += count

    cpdef commit(self):
        cdef int i, j, k
        cdef double weight
        cdef double step[N]
        cdef double gain[MOST + 2]
        for i in range(N):
            step[i] = 0.0
        for k in range(self.count):
            weight = self.shares[k] * self.innovations[k]
            for i in range(N):
                step[i] += weight * self.told[k][i]
        for i in range(N):
            for k in range(self.count):
                gain[k] = self.shares[k] * self.told[k][i]
            for j in range(N):
                for k in range(self.count):
                    self.p[i][j] -= gain[k] * self.told[k][j]
        for i in range(N):
            if self.p[i][i] < 1e-12:
                self.p[i][i] = 1e-12
        self.count = 0
        return [step[i] for i in range(N)]
