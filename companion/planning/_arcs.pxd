# C types of arcs.py, which is compiled as `_arcs`.
cimport cython
from libc cimport math
from companion.planning._segments cimport Segments

cdef double GRAZE_M, ROUNDING_M, CONE_TOLERANCE, ARC_STEP_RAD, BURIED_STEP_RAD
cdef long long UNKNOWN, CLEAR, BLOCKED

cpdef more_doubles(double[::1] before)

cpdef more_integers(long long[::1] before)


cdef class Arcs:
    cdef Segments segments
    cdef double[::1] limit, limit2
    cdef double reach
    cdef double[::1] x, y, a_x, a_y, b_x, b_y, width
    cdef public double[::1] radius
    cdef long long[::1] following, corner, alone
    cdef readonly long long count

    @cython.locals(s=Segments, d_x=double, d_y=double, e_x=double, e_y=double, d=double, e=double, turn=double, i=cython.longlong, width=double, pieces=cython.longlong, first=cython.longlong, last=cython.longlong, a_x=double, a_y=double, angle=double)
    cdef _add_arc(self, long long k, long long after, double side)

    @cython.locals(s=Segments, sagitta=double, px=double, py=double, qx=double, qy=double)
    cdef bint _is_buried(self, long long i, double low, double high) noexcept

    @cython.locals(i=cython.longlong, a=double, b=double, a_dot=double, b_dot=double, at=double)
    cdef double position(self, long long node, double m_x, double m_y) noexcept

    @cython.locals(i=cython.longlong)
    cpdef double point_x(self, long long node, double at, double radius) noexcept

    @cython.locals(i=cython.longlong)
    cpdef double point_y(self, long long node, double at, double radius) noexcept

    @cython.locals(i=cython.longlong, step=double, radius=double, x=double, y=double, n=cython.longlong, next_x=double, next_y=double)
    cpdef bint is_walk_clear(self, long long node, double low, double high, long long legs) noexcept

    cdef bint may_walk(self, long long node, double low, double high) noexcept

    @cython.locals(within=double, k=cython.longlong, is_alone=bint)
    cdef bint _is_alone(self, long long i) noexcept
