# C types of tangents.py, which is compiled as `_tangents`.
cimport cython
from libc cimport math
from companion.planning._arcs cimport Arcs
from companion.planning._view cimport View

cdef double GRAZE_M, SIEVE_M, WIDE_RAD, BESIDE
cdef long long UNKNOWN, MOST_TANGENTS


cdef class Tangents:
    cdef readonly Arcs arcs
    cdef View view
    cdef double[::1] departure, length, arrival, begin_x, begin_y, end_x, end_y
    cdef long long[::1] target, state, fan_first, fan_end
    cdef long long count, forgotten

    @cython.locals(node=cython.longlong)
    cdef void forget(self) noexcept

    cdef long long fan(self, long long node) except -1

    @cython.locals(a=Arcs, i=cython.longlong, half=double, m_x=double, m_y=double, side=double, first=cython.longlong, quarter=cython.longlong, u_x=double, u_y=double)
    cdef long long fan_of(self, long long node, double x, double y) except -1

    @cython.locals(a=Arcs, view=View, n=cython.longlong, block=cython.longlong, j=cython.longlong, dx=double, dy=double, d2=double)
    cdef _collect(self, long long node)

    @cython.locals(arcs=Arcs, reach=double, radius=double, i=cython.longlong, a=double, b=double)
    cdef bint _may_meet(self, long long node, long long j, double dx, double dy) noexcept

    @cython.locals(arcs=Arcs, side=double, radius=double, j=cython.longlong, n=cython.longlong, j_side=double, rho=double, square=double, scale=double, slack=double, length=double, u_x=double, u_y=double, arrival=double, departure=double)
    cdef void _join(self, long long node, double dx, double dy, double d2, long long other) noexcept

    cdef _grow(self)
