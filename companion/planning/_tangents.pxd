# C types of tangents.py, which is compiled as `_tangents`.
cimport cython
from libc cimport math
from companion.planning._segments cimport Segments

cdef double GRAZE_M, ROUNDING_M, SIEVE_M, CONE_TOLERANCE, ARC_STEP_RAD, BURIED_STEP_RAD
cdef long long BLOCK, FAN_FIELDS


cdef class Fan:
    cdef double x, y
    cdef long long count
    cdef double[::1] data
    cdef long long[::1] target, state

    @cython.locals(n=cython.longlong)
    cdef fill(self, double[::1] data, long long[::1] target)


cdef class Tangents:
    cdef Segments segments
    cdef double[::1] limit, limit2
    cdef double reach
    cdef double[::1] x, y, a_x, a_y, b_x, b_y, width, scratch_data, mid_x, mid_y, spread
    cdef public double[::1] radius
    cdef long long[::1] scratch_target
    cdef readonly long long count
    cdef long long joined
    cdef list fans

    @cython.locals(i=cython.longlong, block=cython.longlong, middle=cython.longlong, dx=double, dy=double, away=double)
    cdef void _set_blocks(self) noexcept

    @cython.locals(s=Segments, d_x=double, d_y=double, e_x=double, e_y=double, d=double, e=double, turn=double, i=cython.longlong, width=double, pieces=cython.longlong, first=cython.longlong, last=cython.longlong, a_x=double, a_y=double, angle=double)
    cdef _add_arc(self, long long k, long long after, double side)

    @cython.locals(s=Segments, sagitta=double, px=double, py=double, qx=double, qy=double)
    cdef bint _is_buried(self, long long i, double low, double high) noexcept

    @cython.locals(i=cython.longlong, a=double, b=double, a_dot=double, b_dot=double, at=double)
    cdef double position(self, long long node, double m_x, double m_y) noexcept

    @cython.locals(known=Fan)
    cdef Fan fan(self, long long node)

    @cython.locals(radius=double, i=cython.longlong, j=cython.longlong, dx=double, dy=double, d2=double, a=double, b=double, a_x=double, a_y=double, b_x=double, b_y=double, most=double, least=double, block=cython.longlong, high=double, low=double, found=Fan)
    cdef Fan fan_of(self, long long node, double x, double y)

    @cython.locals(side=double, radius=double, j=cython.longlong, n=cython.longlong, j_side=double, rho=double, square=double, scale=double, slack=double, length=double, u_x=double, u_y=double, arrival=double, departure=double)
    cdef void _join(self, long long node, double dx, double dy, double d2, long long other) noexcept

    @cython.locals(i=cython.longlong)
    cpdef double point_x(self, long long node, double at, double radius) noexcept

    @cython.locals(i=cython.longlong)
    cpdef double point_y(self, long long node, double at, double radius) noexcept

    @cython.locals(i=cython.longlong, step=double, radius=double, x=double, y=double, n=cython.longlong, next_x=double, next_y=double)
    cpdef bint is_walk_clear(self, long long node, double low, double high, long long legs) noexcept

    cdef bint may_walk(self, long long node, double low, double high) noexcept
