"""covariance.py in C."""
cdef enum:
    N = 13
    MOST = 5


cdef class Covariance:
    cdef double p[N][N]
    cdef double cross[MOST][N]
    cdef double precisions[MOST]
    cdef double innovations[MOST]
    cdef int states[N]
    cdef double shares[N]
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

    cpdef mix(self, int state, tuple shares):
        cdef int i
        cdef double row[N]
        self.read(shares)
        self.sum(row)
        row[state] = self.dot(row)
        for i in range(N):
            self.p[state][i] = row[i]
            self.p[i][state] = row[i]

    cdef read(self, tuple shares):
        cdef int i
        self.entries = len(shares)
        for i in range(self.entries):
            state, share = <tuple>shares[i]
            self.states[i] = state
            self.shares[i] = share

    cdef void sum(self, double *total) noexcept:
        cdef int i, k
        for i in range(N):
            total[i] = 0.0
        for k in range(self.entries):
            for i in range(N):
                total[i] += self.shares[k] * self.p[self.states[k]][i]

    cdef double dot(self, double *row) noexcept:
        cdef int k
        cdef double total = 0.0
        for k in range(self.entries):
            total += self.shares[k] * row[self.states[k]]
        return total

    cpdef measure(self, tuple shares, double innovation, double white):
        cdef int i, k
        cdef double weight, variance
        cdef double *cross
        if self.count >= MOST:
            raise IndexError("too many measurements before a commit")
        cross = self.cross[self.count]
        self.read(shares)
        self.sum(cross)
        for k in range(self.count):
            weight = self.precisions[k] * self.dot(self.cross[k])
            innovation -= weight * self.innovations[k]
            for i in range(N):
                cross[i] -= weight * self.cross[k][i]
        variance = white + self.dot(cross)
        self.precisions[self.count] = 1.0 / variance
        self.innovations[self.count] = innovation
        self.count += 1
        return innovation, variance

    cpdef withdraw(self, int count):
        self.count -= count

    cpdef commit(self):
        cdef int i, j, k
        cdef double weight
        cdef double step[N]
        cdef double gain[MOST]
        for i in range(N):
            step[i] = 0.0
        for k in range(self.count):
            weight = self.precisions[k] * self.innovations[k]
            for i in range(N):
                step[i] += weight * self.cross[k][i]
        for i in range(N):
            for k in range(self.count):
                gain[k] = self.precisions[k] * self.cross[k][i]
            for j in range(N):
                for k in range(self.count):
                    self.p[i][j] -= gain[k] * self.cross[k][j]
        for i in range(N):
            if self.p[i][i] < 1e-12:
                self.p[i][i] = 1e-12
        self.count = 0
        return [step[i] for i in range(N)]
